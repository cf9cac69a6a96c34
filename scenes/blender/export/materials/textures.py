# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields as <texture> elements, and their files."""

import struct
import zlib

import numpy

from ..elements import add_matrix, add_value, plugin
from ..ply import attribute_name

_WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "zero", "MIRROR": "mirror"}


def add_texture(parent, name, field, context, raw=False):
    """Adds the <texture> of a field that is no constant; raw: of values that are no colours."""
    if field.attribute is not None:
        texture = plugin("texture", "mesh_attribute", name=name)
        add_value(texture, "string", "name", "vertex_" + attribute_name(field.attribute))
        parent.append(texture)
        return
    texture = plugin("texture", "bitmap", name=name)
    placement = field.placement
    if field.file is not None:
        path, is_raw, channel = field.file
        add_value(texture, "string", "filename", path)
        add_value(texture, "boolean", "raw", is_raw or raw)
        if channel is not None:
            add_value(texture, "string", "channel", channel)
    else:
        add_value(texture, "string", "filename", write_image(field.data, context))
    add_value(texture, "string", "wrap_mode", _WRAPS[placement.extension])
    if placement.nearest:
        add_value(texture, "string", "filter_type", "nearest")
    # Blender's v goes up from the lowest row of an image, Mitsuba's down from the first.
    first, second = placement.rows
    add_matrix(texture, [[first[0], first[1], 0, first[2]], [-second[0], -second[1], 0, 1 - second[2]],
                         [0, 0, 1, 0], [0, 0, 0, 1]], "to_uv")
    parent.append(texture)


def write_image(data, context):
    """Writes (height, width, channels) as an OpenEXR file of half numbers, and returns its path in the folder."""
    limit = float(numpy.finfo(numpy.float16).max)
    texels = numpy.clip(numpy.nan_to_num(data, nan=0.0, posinf=limit, neginf=-limit), -limit, limit).astype("<f2")
    return context.file("textures", ".exr", str(texels.shape).encode() + texels.tobytes(),
                        lambda path: path.write_bytes(exr_bytes(texels)))


def exr_bytes(texels):
    """An OpenEXR file (https://openexr.com/en/latest/OpenEXRFileLayout.html) of half numbers (height, width, channels):
    scan lines, compressed 16 at a time by ZIP."""
    height, width, count = texels.shape
    names = {1: ["Y"], 3: ["B", "G", "R"]}[count]
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 1, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [("channels", "chlist", channels), ("compression", "compression", b"\3"), ("dataWindow", "box2i", window),
                  ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
                  ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
                  ("screenWindowWidth", "float", struct.pack("<f", 1))]
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    blocks = []
    planar = numpy.ascontiguousarray(texels[:, :, ::-1].transpose(0, 2, 1))  # rows of channels, B first
    for row in range(0, height, 16):
        plain = numpy.frombuffer(planar[row:row + 16].tobytes(), numpy.uint8)
        # All low bytes, then all high ones; each as its difference from the one before.
        apart = numpy.concatenate([plain[0::2], plain[1::2]])
        steps = apart.copy()
        steps[1:] = apart[1:] - apart[:-1] + numpy.uint8(128)
        packed = zlib.compress(steps.tobytes(), 4)
        if len(packed) >= len(plain):
            packed = plain.tobytes()
        blocks.append(struct.pack("<ii", row, len(packed)) + packed)
    at = len(header) + 8 * len(blocks)
    offsets = b""
    for block in blocks:
        offsets += struct.pack("<Q", at)
        at += len(block)
    return header + offsets + b"".join(blocks)
