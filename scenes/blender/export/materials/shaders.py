# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes that are no microfacets, and their mixtures, as closures."""

from dataclasses import replace

from .closures import BLACK, Blend, Clear, Closure, Leaf, Mask
from .fields import NotFolded, combine, constant, product, to_number
from .nodes import Input, source_of
from .normals import bend_of

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
    if first is second:
        return first
    if isinstance(first, Clear):
        return Mask(weight, second or BLACK)
    if isinstance(second, Clear):
        return Mask(inverse(weight), first or BLACK)
    return Blend(weight, first or BLACK, second or BLACK)


def inverse(field):
    """1 less the field."""
    return combine(lambda data: 1 - data, field)


def multiplied(reading, first, second, node):
    """The product of two fields; where their images differ in place, the second counts by its mean."""
    try:
        return product(first, second)
    except NotFolded as reason:
        reading.note(node, f"its factor counts by its mean, since {reason}")
        mean = second.data.reshape(-1, second.data.shape[-1]).mean(axis=0) if second.attribute is None else [1.0]
        return product(first, constant(mean))


def shining(field):
    """A radiance, or None where it is 0."""
    return None if field is None or field.is_value(0.0) else field


@shades("ShaderNodeMixShader")
def mix(reading, source):
    weight = reading.number(source, "Fac", low=0.0, high=1.0)
    shaders = [Input(socket, source.groups) for socket in source.node.inputs if socket.type == "SHADER"]
    first, second = (closure_of(reading, at) for at in shaders)
    emitted = [shining(each and multiplied(reading, each, part, source.node))
               for each, part in ((first.emission, inverse(weight)), (second.emission, weight))]
    nothing = first.bsdf is None and second.bsdf is None
    return Closure(None if nothing else blended(weight, first.bsdf, second.bsdf), _sum(reading, *emitted, source.node))


def _sum(reading, first, second, node):
    if first is None or second is None:
        return second if first is None else first
    try:
        return combine(lambda a, b: a + b, first, second)
    except NotFolded as reason:
        reading.note(node, f"of two emissions the first is exported, since {reason}")
        return first


@shades("ShaderNodeAddShader")
def add(reading, source):
    first, second = (closure_of(reading, Input(socket, source.groups)) for socket in source.node.inputs)
    emission = _sum(reading, first.emission, second.emission, source.node)
    if first.bsdf is None or second.bsdf is None:
        return Closure(second.bsdf if first.bsdf is None else first.bsdf, emission)
    most = [_most(bsdf) for bsdf in (first.bsdf, second.bsdf)]
    total = sum(most)
    if total == 0:
        return Closure(first.bsdf, emission)
    weight = most[1] / total
    factors = [0 if part == 0 else 1 / part for part in (1 - weight, weight)]
    if total > 1:
        reading.note(source.node, f"the sum of two BSDFs that reflect up to {total:g} times the light is exported as "
                                  f"{1 / total:.3g} of it")
        factors = [factor / total for factor in factors]
    scaled = [_scaled(bsdf, factor) for bsdf, factor in zip((first.bsdf, second.bsdf), factors)]
    return Closure(blended(constant(weight), *scaled), emission)


def _most(bsdf):
    """A bound of what a tree reflects and transmits, in [0, 1]."""
    if isinstance(bsdf, Blend):
        return max(_most(bsdf.first), _most(bsdf.second))
    if not isinstance(bsdf, Leaf) or not bsdf.colours:
        return float(bsdf.reflectance.data.max()) if isinstance(bsdf, Leaf) and bsdf.remade is not None else 1.0
    return max(1.0 if bsdf.parameters[name].attribute is not None else float(bsdf.parameters[name].data.max())
               for name in bsdf.colours)


def _scaled(bsdf, factor):
    """The tree with colours times the factor; a share of it where it has no such colours (the factor is 1 at most)."""
    if isinstance(bsdf, Blend):
        return replace(bsdf, first=_scaled(bsdf.first, factor), second=_scaled(bsdf.second, factor))
    if isinstance(bsdf, Leaf) and bsdf.colours and all(bsdf.parameters[name].attribute is None for name in bsdf.colours):
        colours = {name: product(bsdf.parameters[name], constant(factor)) for name in bsdf.colours}
        return replace(bsdf, parameters={**bsdf.parameters, **colours})
    if isinstance(bsdf, Leaf) and bsdf.remade is not None:
        return bsdf.remade(factor)
    return Blend(constant(1 - factor), bsdf, BLACK) if factor < 1 else bsdf


@shades("ShaderNodeBsdfDiffuse")
def diffuse(reading, source):
    colour = reading.colour(source, "Color", high=1.0)
    roughness = reading.number(source, "Roughness", low=0.0, high=1.0)
    bend = bend_of(reading, source)
    if roughness.is_value(0.0):
        return Closure(Leaf("diffuse", {"reflectance": colour}, ("reflectance",), bend=bend))
    # Without a reflection above it, openpbr's base is the same model (Portsmouth, Kutz and Hill 2024).
    return Closure(Leaf("openpbr", {"base_color": colour, "base_diffuse_roughness": roughness, "specular_ior": 1.0},
                        bend=bend))


@shades("ShaderNodeBsdfTranslucent")
def translucent(reading, source):
    colour = reading.colour(source, "Color", high=1.0)
    return Closure(Leaf("difftrans", {"transmittance": colour}, ("transmittance",), True, bend_of(reading, source)))


@shades("ShaderNodeBsdfTransparent")
def transparent(reading, source):
    colour = reading.colour(source, "Color", high=1.0)
    if colour.is_value(1.0):
        return Closure(Clear())
    if not colour.is_constant or len(set(colour.colour)) > 1:
        reading.note(source.node, "its colour counts by its luminance")
    return Closure(Mask(inverse(to_number(colour, "RGBA")), BLACK))


@shades("ShaderNodeEmission", "ShaderNodeBackground")
def emission(reading, source):
    radiance = multiplied(reading, reading.colour(source, "Color"), reading.number(source, "Strength", low=0.0), source.node)
    return Closure(None, shining(radiance))


@shades("ShaderNodeHoldout")
def holdout(reading, source):
    reading.note(source.node, "a holdout is black; it makes no hole")
    return Closure(BLACK)
