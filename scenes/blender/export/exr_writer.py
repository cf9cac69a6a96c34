# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes OpenEXR images (https://openexr.com/en/latest/OpenEXRFileLayout.html). Blender's images save 16 bits, in which a
sun is too bright."""

import struct
import zlib

import numpy

_HALF, _FLOAT, _ZIP, _INCREASING = 1, 2, 3, 0
_ROWS = 16  # that ZIP compresses together
_CHANNELS = {1: ["Y"], 3: ["B", "G", "R"]}


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def _compressed(plain):
    """Bytes of even and odd places apart, then differences, then zlib's; unchanged where that is no shorter."""
    data = numpy.frombuffer(plain, numpy.uint8)
    apart = numpy.concatenate([data[0::2], data[1::2]])
    differences = apart.copy()
    differences[1:] = apart[1:] - apart[:-1] + numpy.uint8(128)
    packed = zlib.compress(differences.tobytes(), 4)
    return packed if len(packed) < len(plain) else plain


def exr_bytes(pixels):
    """A file of (height, width, 1 or 3), linear, the first row on top: of half numbers if they are, else of floats."""
    height, width, count = pixels.shape
    kind, number = (_HALF, "<f2") if pixels.dtype == numpy.float16 else (_FLOAT, "<f4")
    channels = b"".join(name.encode() + b"\0" + struct.pack("<4i", kind, 0, 1, 1) for name in _CHANNELS[count]) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", 20000630, 2) + b"".join([
        _attribute("channels", "chlist", channels), _attribute("compression", "compression", bytes([_ZIP])),
        _attribute("dataWindow", "box2i", window), _attribute("displayWindow", "box2i", window),
        _attribute("lineOrder", "lineOrder", bytes([_INCREASING])),
        _attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        _attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    planar = numpy.ascontiguousarray(pixels[:, :, ::-1].transpose(0, 2, 1), number)  # rows of channels, B first
    blocks = []
    for row in range(0, height, _ROWS):
        packed = _compressed(planar[row:row + _ROWS].tobytes())
        blocks.append(struct.pack("<ii", row, len(packed)) + packed)
    ends = numpy.cumsum([len(header) + 8 * len(blocks)] + [len(block) for block in blocks])
    return header + ends[:-1].astype("<u8").tobytes() + b"".join(blocks)
