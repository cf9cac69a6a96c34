# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes OpenEXR images of 32-bit floats (https://openexr.com/en/latest/OpenEXRFileLayout.html). Blender's images save
16 bits, in which a sun is too bright."""

import struct
import zlib

import numpy

_FLOAT, _ZIPS, _INCREASING = 2, 2, 0


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def _compressed(row):
    """Bytes of even and odd places apart, then differences, then zlib's; unchanged where that is no shorter."""
    data = numpy.frombuffer(row, numpy.uint8)
    apart = numpy.concatenate([data[0::2], data[1::2]])
    differences = apart.copy()
    differences[1:] = apart[1:] - apart[:-1] + 128  # modulo 256
    packed = zlib.compress(differences.tobytes(), 4)
    return packed if len(packed) < len(row) else row


def write_exr(path, pixels):
    """pixels: (height, width, 3), linear, the first row on top."""
    height, width, _ = pixels.shape
    channels = b"".join(name + b"\0" + struct.pack("<iiii", _FLOAT, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", 20000630, 2) + b"".join([
        _attribute("channels", "chlist", channels), _attribute("compression", "compression", bytes([_ZIPS])),
        _attribute("dataWindow", "box2i", window), _attribute("displayWindow", "box2i", window),
        _attribute("lineOrder", "lineOrder", bytes([_INCREASING])),
        _attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        _attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    rows = [_compressed(row.tobytes()) for row in numpy.ascontiguousarray(pixels[:, :, ::-1].transpose(0, 2, 1), "<f4")]
    chunks = [struct.pack("<ii", y, len(row)) + row for y, row in enumerate(rows)]
    ends = numpy.cumsum([len(header) + 8 * height] + [len(chunk) for chunk in chunks])
    with open(path, "wb") as file:
        file.write(header + ends[:-1].astype("<u8").tobytes())
        file.writelines(chunks)
