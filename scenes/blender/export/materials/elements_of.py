# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of BSDFs and fields as elements of scene files."""

import math

import numpy

from ..elements import add_value, plugin
from .closures import BLACK, SMOOTH, Blend, Clear, Leaf, Mask
from .fields import Field
from .textures import add_texture


def add_field(parent, name, field, context, colour=True):
    """Adds a parameter: a number, a colour or a texture."""
    if not field.is_constant:
        add_texture(parent, name, field, context)
    elif colour:
        add_value(parent, "rgb", name, numpy.maximum(field.colour, 0))
    else:
        add_value(parent, "float", name, field.number)


def bsdf_element(bsdf, context):
    """The <bsdf> of a tree. Opaque BSDFs get both sides alike, as Blender's surfaces have."""
    if isinstance(bsdf, Blend):
        element = plugin("bsdf", "blendbsdf")
        add_field(element, "weight", bsdf.weight, context, colour=False)
        element.append(bsdf_element(bsdf.first, context))
        element.append(bsdf_element(bsdf.second, context))
        return element
    if isinstance(bsdf, Mask):
        element = plugin("bsdf", "mask")
        add_field(element, "opacity", bsdf.opacity, context, colour=False)
        element.append(bsdf_element(bsdf.inside, context))
        return element
    if isinstance(bsdf, Clear):
        return plugin("bsdf", "null")
    return _leaf_element(bsdf if bsdf is not None else BLACK, context)


def _leaf_element(leaf: Leaf, context):
    element = plugin("bsdf", leaf.plugin)
    for name, value in leaf.parameters.items():
        if isinstance(value, Field):
            add_field(element, name, value, context, colour=value.data.shape[-1] == 3 or name in leaf.colours)
        elif isinstance(value, bool):
            add_value(element, "boolean", name, value)
        elif isinstance(value, str):
            add_value(element, "string", name, value)
        else:
            add_value(element, "float", name, value)
    if leaf.turn is not None:
        outer = plugin("bsdf", "turnedtangent")
        add_value(outer, "float", "angle", math.degrees(leaf.turn.angle))
        if leaf.turn.directions is not None:
            add_texture(outer, None, leaf.turn.directions, context, raw=True)
        outer.append(element)
        element = outer
    if not leaf.transmits:
        sides = plugin("bsdf", "twosided")
        sides.append(element)
        element = sides
    if leaf.bend is not None:
        element = _bent_element(leaf, leaf.bend, "all" if leaf.coat_bend is None else "base", element, context)
    if leaf.coat_bend is not None and leaf.coat_bend is not SMOOTH:
        element = _bent_element(leaf, leaf.coat_bend, "coat", element, context)
    return element


def _bent_element(leaf, bend, layers, element, context):
    outer = plugin("bsdf", bend.plugin)
    if bend.plugin == "bumpmap":
        add_value(outer, "float", "scale", bend.scale)
    # Cycles lets bumps shade each other where light is reflected diffusely only.
    add_value(outer, "boolean", "use_shadowing_function", _is_mostly_diffuse(leaf))
    if layers != "all":
        add_value(outer, "string", "layers", layers)
    add_texture(outer, None, bend.texture, context, raw=True)
    outer.append(element)
    return outer


def _is_mostly_diffuse(leaf):
    if leaf.plugin == "openpbr":
        metalness = leaf.parameters.get("base_metalness", 0.0)
        metalness = metalness if isinstance(metalness, float) else float(metalness.data.mean())
        return metalness < 0.5 and not leaf.transmits
    return leaf.plugin in {"diffuse", "difftrans"}


def emission_element(field, context):
    """The area light of a radiance. Blender's surfaces emit to both sides."""
    element = plugin("emitter", "area")
    add_field(element, "radiance", field, context)
    add_value(element, "boolean", "two_sided", True)
    return element
