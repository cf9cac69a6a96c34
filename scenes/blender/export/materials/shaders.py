# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes as closures."""

from .closures import BLACK, Blend, Clear, Closure, Leaf, Mask
from .fields import combine, constant, product
from .nodes import source_of

# function(reading, source) -> Closure by bl_idname of shader nodes.
SHADERS = {}


def shades(*names):
    """Registers the function for shader nodes of these names."""
    def register(function):
        for name in names:
            SHADERS[name] = function
        return function
    return register


def closure_of(reading, at):
    """The Closure of an input for shaders. Nothing linked: nothing scatters light."""
    source = source_of(at)
    if source is None or source.is_constant:
        return Closure()
    if source.socket.type != "SHADER":
        return Closure(None, reading.value(at, [0.0] * 3, 0.0))  # Blender shows colours as light
    function = SHADERS.get(source.node.bl_idname)
    if function is None:
        reading.note(source.node, f"shader '{source.node.bl_label}' is not exported; it is black")
        return Closure(BLACK)
    return function(reading, source)


def blended(weight, first, second):
    """The blend of two BSDF trees, by the weight of the second."""
    if weight.is_value(0.0):
        return first
    if weight.is_value(1.0):
        return second
    if first == second:
        return first
    if isinstance(first, Clear):
        return Mask(weight, second or BLACK)
    if isinstance(second, Clear):
        return Mask(inverse(weight), first or BLACK)
    return Blend(weight, first or BLACK, second or BLACK)


def inverse(field):
    """1 less the field."""
    return combine(lambda data: 1 - data, field)


def scaled_emission(field, factor):
    """Emission times a factor; None is none."""
    if field is None or factor.is_value(0.0) or field.is_value(0.0):
        return None
    return product(field, factor)


def sum_of_emissions(first, second):
    """The sum; None is none."""
    if first is None or second is None:
        return second if first is None else first
    return combine(lambda a, b: a + b, first, second)


@shades("ShaderNodeBsdfDiffuse")
def diffuse(reading, source):
    return Closure(Leaf("diffuse", {"reflectance": reading.colour(source, "Color", high=1.0)}, ("reflectance",)))


@shades("ShaderNodeEmission")
def emission(reading, source):
    radiance = product(reading.colour(source, "Color"), reading.number(source, "Strength", low=0.0))
    return Closure(None, scaled_emission(radiance, constant(1.0)))
