# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields as <texture> elements, and their files."""

import numpy

from ..elements import add_matrix, add_value, plugin
from ..exr_writer import exr_bytes
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
