# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture coordinates that are an affine map of one UV map."""

import mathutils
import numpy

from .fields import NotFolded
from .nodes import source_of


def render_uv_map(mesh):
    """The name of the UV map that is active for renders, or None."""
    layers = getattr(mesh, "uv_layers", None) or []
    return next((layer.name for layer in layers if layer.active_render), None)


def is_plain_mapping(mapping):
    """Whether a texture node's own mapping (of before Blender 2.8) changes nothing."""
    return (mapping.vector_type == "POINT" and not any(mapping.translation) and not any(mapping.rotation)
            and all(x == 1 for x in mapping.scale) and not mapping.use_min and not mapping.use_max
            and (mapping.mapping_x, mapping.mapping_y, mapping.mapping_z) == ("X", "Y", "Z"))


def affine_uv(values, at):
    """(UV map's name, or None for the active one; 3 × 3 matrix that takes (u, v, 1) to x, y, z) of a vector's input."""
    source = source_of(at)
    if source is None or source.is_constant:
        raise NotFolded(at.node, "its texture coordinates are constant")
    node, output = source.node, source.socket.identifier
    identity = numpy.diag([1.0, 1.0, 0.0])
    if node.bl_idname == "ShaderNodeTexCoord" and output == "UV" and not node.from_instancer:
        return None, identity
    if node.bl_idname == "ShaderNodeUVMap" and not node.from_instancer:
        return values.uv_map(node.uv_map), identity
    if node.bl_idname == "ShaderNodeAttribute" and node.attribute_type == "GEOMETRY" and output in {"Vector", "Color"} \
            and values.is_uv_map(node.attribute_name):
        return values.uv_map(node.attribute_name), identity
    if node.bl_idname == "ShaderNodeMapping":
        return _mapped(values, source)
    if node.bl_idname == "ShaderNodeVectorMath":
        return _computed(values, source)
    raise NotFolded(node, f"texture coordinates '{source.socket.name}' are no UV map")


def _constant(values, at):
    field = values.fold(at)
    if not field.is_constant:
        raise NotFolded(at.node, "its placement varies")
    return field.colour


def _mapped(values, source):
    """Mapping: rotation times scale, plus location; TEXTURE: the inverse."""
    kind = source.node.vector_type
    if kind == "NORMAL":
        raise NotFolded(source.node, "it normalises its vectors")
    uv_map, inside = affine_uv(values, source.input("Vector"))
    turned = numpy.array(mathutils.Euler(_constant(values, source.input("Rotation"))).to_matrix())
    scale = _constant(values, source.input("Scale"))
    moved = numpy.zeros(3) if kind == "VECTOR" else _constant(values, source.input("Location"))
    last = numpy.array([0.0, 0.0, 1.0])
    if kind == "TEXTURE":
        inverse = numpy.divide(1, scale, out=numpy.zeros(3), where=scale != 0)
        return uv_map, inverse[:, None] * (turned.T @ (inside - numpy.outer(moved, last)))
    return uv_map, turned @ (scale[:, None] * inside) + numpy.outer(moved, last)


def _computed(values, source):
    """Sums with constants and products by constants."""
    node = source.node
    last = numpy.array([0.0, 0.0, 1.0])
    if node.operation == "SCALE":
        uv_map, inside = affine_uv(values, source.input("Vector"))
        return uv_map, inside * _constant(values, source.input("Scale"))[0]
    if node.operation not in {"ADD", "SUBTRACT", "MULTIPLY"}:
        raise NotFolded(node, f"operation {node.operation} of texture coordinates")
    second = _constant(values, source.input("Vector_001"))
    uv_map, inside = affine_uv(values, source.input("Vector"))
    if node.operation == "MULTIPLY":
        return uv_map, second[:, None] * inside
    return uv_map, inside + numpy.outer(second if node.operation == "ADD" else -second, last)
