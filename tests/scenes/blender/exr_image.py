"""Reads uncompressed OpenEXR images of one part."""

import struct

import numpy

_KINDS = {0: numpy.dtype("<u4"), 1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def read_exr(path):
    """The channels by name: (height, width) each, the first row on top. Errors: compressed or tiled images."""
    with open(path, "rb") as file:
        data = file.read()
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0x1A00:
        raise ValueError(f"{path} is not an OpenEXR image of one part in scan lines")
    at = 8
    attributes = {}
    while data[at]:
        name, at = _text(data, at)
        _, at = _text(data, at)
        size, = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    if attributes["compression"][0]:
        raise ValueError(f"{path} is compressed")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels, kinds = [], attributes["channels"]
    place = 0
    while kinds[place]:
        name, place = _text(kinds, place)
        channels.append((name, _KINDS[struct.unpack_from("<i", kinds, place)[0]]))
        place += 16
    images = {name: numpy.empty((height, width), kind) for name, kind in channels}
    for offset in struct.unpack_from(f"<{height}Q", data, at + 1):
        row, _ = struct.unpack_from("<ii", data, offset)
        place = offset + 8
        for name, kind in channels:
            images[name][row - top] = numpy.frombuffer(data, kind, width, place)
            place += width * kind.itemsize
    return images


def read_rgb(path):
    """(height, width, 3), float32."""
    images = read_exr(path)
    return numpy.stack([images[name].astype(numpy.float32) for name in "RGB"], axis=-1)
