# SPDX-License-Identifier: GPL-3.0-or-later
"""Normal inputs and displacement as normal maps and bump maps."""

import numpy

from .closures import Bend
from .fields import Field, combine
from .nodes import source_of


def bend_of(reading, source, *names):
    """The Bend of a BSDF's Normal input, or None."""
    at = reading.at(source, *(names or ("Normal",)))
    if at.socket is None:
        return None
    feed = source_of(at)
    if feed is None or feed.is_constant:
        return None
    if feed.node.bl_idname == "ShaderNodeNormalMap" and not reading.over_mesh:
        bend = _normal_map(reading, feed)
    elif feed.node.bl_idname == "ShaderNodeBump" and not reading.over_mesh:
        bend = _bump(reading, feed)
    else:
        bend = None
    if bend is not None:
        return bend
    return _baked_normals(reading, at)


def _baked_normals(reading, at, kind="NORMAL"):
    normals = reading.normals(at, kind)
    return Bend("normalmap", normals) if normals is not None else None


def _texture(reading, at):
    """The image of an input, or None."""
    field = reading.value(at, signed=True)
    return field if field.placement is not None else None


def _normal_map(reading, source):
    """A map in tangent space whose tangents are those of its own UV map."""
    node = source.node
    if node.space != "TANGENT":
        return None
    texture = reading.value(reading.at(source, "Color"))
    if texture.placement is None or reading.values.uv_map(node.uv_map) != texture.placement.uv_map:
        return None
    strength = reading.number(source, "Strength", default=1.0, low=0.0)
    if strength.is_value(1.0):
        return Bend("normalmap", texture)
    if not strength.is_constant:
        return None
    weight = strength.number

    def weakened(data):
        normals = _unit(2 * data - 1)
        straight = numpy.array([0.0, 0.0, 1.0])
        return (_unit(straight + (normals - straight) * weight) + 1) / 2

    return Bend("normalmap", combine(weakened, texture))


def _unit(vectors):
    length = numpy.sqrt((vectors ** 2).sum(axis=-1, keepdims=True))
    return numpy.divide(vectors, length, out=numpy.zeros(vectors.shape), where=length > 0)


def _bump(reading, source):
    """Heights over a UV map. A strength below 1 mixes normals; for gentle slopes that is a factor of the heights."""
    if reading.is_linked(source, "Normal") or reading.is_linked(source, "Strength") or reading.is_linked(source, "Distance"):
        return None
    strength = reading.number(source, "Strength", default=1.0, low=0.0).number
    scale = strength * reading.number(source, "Distance", default=1.0).number * (-1 if source.node.invert else 1)
    heights = _texture(reading, reading.at(source, "Height"))
    if heights is None or heights.attribute is not None:
        return None
    if strength not in {0.0, 1.0}:
        reading.note(source.node, f"strength {strength:g} of the bumps is a factor of their heights")
    return _bump_map(reading, heights, scale)


def _bump_map(reading, heights, scale):
    """Textures are not negative: heights begin at 0."""
    least = float(heights.data.min())
    if least < 0:
        heights = Field(heights.data - least, heights.placement)
    return Bend("bumpmap", heights, scale)


def displacement_bend(reading, output):
    """The Bend of a displacement output that only changes normals, or None."""
    feed = source_of(output)
    if feed is None or feed.is_constant:
        return None
    material = reading.material
    if getattr(material, "displacement_method", "BUMP") != "BUMP":
        reading.note(feed.node, "displacement does not move the surface; it only bends its normals")
    if feed.node.bl_idname == "ShaderNodeDisplacement" and not reading.over_mesh:
        heights, scale = _texture(reading, reading.at(feed, "Height")), reading.number(feed, "Scale", default=1.0)
        if heights is not None and scale.is_constant and not reading.is_linked(feed, "Normal"):
            return _bump_map(reading, heights, scale.number)
    return _baked_normals(reading, output, "DISPLACEMENT")
