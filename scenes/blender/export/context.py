# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of an export shares: the folder, its files by content, and what could not be exported."""

import hashlib
import os
import pathlib
import sys

# Blender tells of changes of these, but geometry and materials do not depend on them.
_WITHOUT_EFFECT = {"SCENE", "COLLECTION", "ACTION", "CAMERA", "LIGHT", "WORLD", "ARMATURE", "LINESTYLE"}
# Objects of these types show nothing.
_UNSEEN = {"LIGHT", "CAMERA", "ARMATURE"}
# Changes of these may change any material.
_OF_MATERIALS = {"NODETREE", "IMAGE", "TEXTURE"}


def own_blender(script):
    """The command that runs a Python file in a Blender of its own, so that the user's stays as it is. Arguments of the
    script follow after "--"."""
    import bpy
    blender = bpy.app.binary_path  # empty where Blender is a module of Python
    return ([blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python", str(script)]
            if blender else [sys.executable, str(script)])


class Stopped(Exception):
    """The user has stopped the export."""


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
    """One export to a folder, of one frame or of several.

    folder: where scenes are written. Files beside them are named by their content, so frames share what stays the same.
    depsgraph: of the frame that is exported. frame_set(frame, subframe) takes it to another time, for motion blur: that
    of a RenderEngine; viewports have none. texture_size: pixels on a side of a baked texture. camera: the
    object to see by, or that of the scene.
    """

    def __init__(self, folder, depsgraph, texture_size=1024, report=None, frame_set=None, camera=None):
        self.folder = pathlib.Path(folder)
        self.depsgraph = depsgraph
        self.texture_size = texture_size
        self.report = report if report is not None else Report()
        self.camera = camera
        self.geometry = {}  # what scene.py knows of geometry, by identity; it stays until something changes it
        self.frame_set = frame_set
        self.is_stopped = lambda: False  # whether the user has had enough

    def go_on(self):
        """Called now and then in an export. Error: Stopped."""
        if self.is_stopped():
            raise Stopped

    def camera_now(self):
        """The evaluated camera, or None."""
        camera = self.camera or self.depsgraph.scene.camera
        return camera.original.evaluated_get(self.depsgraph) if camera is not None else None

    def go_to(self, frame):
        """Takes the depsgraph to a time in frames. Returns the names of objects whose geometry changes."""
        whole = int(frame // 1)
        self.frame_set(whole, frame - whole)
        return self.note_updates()

    def note_updates(self):
        """Forgets the geometry and materials that Blender has changed since the last time. Returns the names of objects
        with other geometry."""
        changed, kinds, objects = set(), set(), set()
        for update in self.depsgraph.updates:
            original = update.id.original
            kinds.add(original.id_type)
            if update.is_updated_geometry or original.id_type not in _WITHOUT_EFFECT | {"OBJECT"}:
                changed.add(original.session_uid)
            if update.is_updated_geometry and original.id_type == "OBJECT" and original.type not in _UNSEEN:
                objects.add(original.name)
        if kinds & _OF_MATERIALS and not kinds & {"MATERIAL", "WORLD", "LIGHT"}:
            self.geometry.clear()
        for identity, known in list(self.geometry.items()):
            if changed & known.made_of:
                del self.geometry[identity]
        return objects

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
