# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of an export shares: the folder, its files by content, and what could not be exported."""

import hashlib
import os
import pathlib


class Report:
    """What an export leaves out or approximates, by object, material and node. Repeated lines count once."""

    def __init__(self):
        self.lines = []

    def add(self, message, object_name=None, material=None, node=None):
        """For example: object "Lamp": the spread of an area light is not exported."""
        places = [("object", object_name), ("material", material), ("node", node)]
        place = ", ".join(f'{kind} "{name}"' for kind, name in places if name is not None)
        line = f"{place}: {message}" if place else message
        if line not in self.lines:
            self.lines.append(line)


class Context:
    """One export to a folder.

    folder: where scenes are written. Files beside them are named by their content, so frames share what stays the same.
    depsgraph: of the frame that is exported. texture_size: pixels on a side of a baked texture.
    """

    def __init__(self, folder, depsgraph, texture_size=1024, report=None):
        self.folder = pathlib.Path(folder)
        self.depsgraph = depsgraph
        self.texture_size = texture_size
        self.report = report if report is not None else Report()

    def file(self, subfolder, suffix, key, write):
        """The path, relative to the folder, of the file whose content `key` (bytes) determines. `write(path)` makes it
        where it does not exist yet. A file appears whole or not at all."""
        relative = pathlib.PurePosixPath(subfolder) / (hashlib.sha256(key).hexdigest()[:32] + suffix)
        path = self.folder / relative
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            partial = path.with_name(f"{path.stem}.{os.getpid()}.partial{suffix}")
            write(partial)
            os.replace(partial, path)
        return str(relative)
