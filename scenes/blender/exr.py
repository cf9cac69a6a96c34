# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads OpenEXR files as Penumbra writes them: one part, scan lines, uncompressed, ZIPS or ZIP.

The format: https://openexr.com/en/latest/OpenEXRFileLayout.html. Blender's Python has no reader for other channels than
R, G, B and A.
"""

import dataclasses
import struct
import zlib

import numpy as np

MAGIC = 20000630
TILED, DEEP, PARTS = 0x200, 0x800, 0x1000  # flags of the version field
LINES_OF_CHUNK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIPS, ZIP
TYPES = {0: "<u4", 1: "<f2", 2: "<f4"}


@dataclasses.dataclass
class Image:
    """channels: name to an array (height, width) of the data window, whose rows go down. offset: x and y of its first
    pixel in the display window, whose (width, height) is `size`. metadata: the attributes that are texts."""

    channels: dict
    offset: tuple
    size: tuple
    metadata: dict

    def stack(self, names):
        """These channels as an array (height, width, count) of floats; None where one is missing."""
        if any(name not in self.channels for name in names):
            return None
        return np.stack([self.channels[name] for name in names], axis=-1).astype(np.float32)


def read(path):
    """The image of a file. ValueError: it is no such file, or damaged."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        return _read(data)
    except (struct.error, zlib.error, IndexError, KeyError) as error:
        raise ValueError(f"{path} is damaged: {error!r}") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _read(data):
    magic, version = struct.unpack_from("<II", data)
    if magic != MAGIC:
        raise ValueError("is no OpenEXR file")
    if version & (TILED | DEEP | PARTS):
        raise ValueError("has tiles, deep pixels or several parts, which are not read")
    attributes, position = _attributes(data, 8)
    compression = attributes["compression"][1][0]
    if compression not in LINES_OF_CHUNK:
        raise ValueError(f"has compression {compression}; only none, ZIPS and ZIP are read")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    display = struct.unpack("<4i", attributes["displayWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    layout = [(name, np.dtype(TYPES[kind])) for name, kind in _channels(attributes["channels"][1])]
    row = np.dtype([(name, dtype, (width,)) for name, dtype in layout])
    rows = np.zeros(height, row)
    lines = LINES_OF_CHUNK[compression]
    count = (height + lines - 1) // lines
    for offset in struct.unpack_from(f"<{count}Q", data, position):
        y, size = struct.unpack_from("<ii", data, offset)
        first = y - top
        part = rows[first:first + lines]
        chunk = data[offset + 8:offset + 8 + size]
        if size < part.nbytes:  # chunks that do not become smaller are stored as they are
            chunk = _decompressed(chunk)
        part[:] = np.frombuffer(chunk, row, count=len(part))
    return Image(
        channels={name: rows[name] for name, _ in layout},
        offset=(left - display[0], top - display[1]),
        size=(display[2] - display[0] + 1, display[3] - display[1] + 1),
        metadata={name: value.decode("utf-8", "replace") for name, (kind, value) in attributes.items()
                  if kind == "string"},
    )


def _text(data, position):
    end = data.index(b"\0", position)
    return data[position:end].decode("utf-8", "replace"), end + 1


def _attributes(data, position):
    """The header's attributes, name to (type, bytes), and the position behind them."""
    attributes = {}
    while data[position] != 0:
        name, position = _text(data, position)
        kind, position = _text(data, position)
        size, = struct.unpack_from("<i", data, position)
        attributes[name] = kind, data[position + 4:position + 4 + size]
        position += 4 + size
    return attributes, position + 1


def _channels(data):
    """Names and types of the channels, in the order of the file."""
    channels, position = [], 0
    while data[position] != 0:
        name, position = _text(data, position)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", data, position)
        if (x_sampling, y_sampling) != (1, 1):
            raise ValueError(f"has a channel {name} of another resolution, which is not read")
        channels.append((name, kind))
        position += 16
    return channels


def _decompressed(chunk):
    """Undoes zlib, then the differences of neighbouring bytes, then their order: the first bytes of all pairs, then the
    second ones."""
    coded = np.frombuffer(zlib.decompress(chunk), np.uint8)
    # Each byte is the difference to the one before, plus 128.
    steps = coded.copy()
    steps[1:] -= 128
    values = np.cumsum(steps, dtype=np.uint8)
    half = (len(values) + 1) // 2
    ordered = np.empty_like(values)
    ordered[0::2] = values[:half]
    ordered[1::2] = values[half:]
    return ordered.tobytes()
