# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy, Metallic, Glass, Refraction, Sheen, Subsurface and hair shaders as closures."""

import math

import numpy

from .closures import BLACK, Closure, Leaf, Turn
from .fields import combine, constant, product, to_number
from .nodes import source_of
from .normals import bend_of
from .shaders import blended, shades, transparent

_LEAST_ALPHA = 1e-4  # the program raises lower ones
# Cycles scales the radii of walks by this ("Random Walk").
SUBSURFACE_RADIUS = 1 / (4 * math.pi)
# Absorption of Cycles' pigments at concentration 1 per radius of hair: more than in d'Eon et al. 2011, whose numbers the
# program has.
_EUMELANIN, _PHEOMELANIN = numpy.array([0.506, 0.841, 1.653]), numpy.array([0.343, 0.733, 1.924])


def squared(field):
    """The square of a field."""
    return combine(lambda data: data ** 2, field)


def fixed(reading, field, node, name):
    """The field as a constant number; of an image the mean, with a note."""
    if field.is_constant:
        return field.number
    reading.note(node, f"'{name}' counts by its mean")
    return float(to_number(field, "VECTOR").data.mean()) if field.attribute is None else 0.5


def turn_of(reading, source, *names, quarters=0):
    """The Turn of tangents by a rotation, in whole turns, and by quarters of a turn; None: there is none."""
    feed = source_of(reading.at(source, "Tangent"))
    node = getattr(feed, "node", None)
    if node is None or node.bl_idname != "ShaderNodeTangent" or node.direction_type != "UV_MAP":
        reading.note(source.node, "highlights are long in the direction of the texture's u, not of Blender's tangent")
    rotation = reading.number(source, *names)
    if rotation.is_constant:
        angle = 2 * math.pi * rotation.number + math.pi / 2 * quarters
        return Turn(angle) if angle else None

    def directions(data):
        angles = 2 * math.pi * data + math.pi / 2 * quarters
        return numpy.concatenate([numpy.cos(angles), numpy.sin(angles), 0 * angles], axis=-1) / 2 + 0.5

    return Turn(directions=combine(directions, rotation))


def _roughnesses(reading, source):
    """alpha along the tangent and across it, and the tangent's Turn: (u, v, turn)."""
    alpha = squared(reading.number(source, "Roughness", low=0.0, high=1.0))
    anisotropy = reading.number(source, "Anisotropy", low=-0.99, high=0.99)
    if anisotropy.is_value(0.0):
        return alpha, alpha, None
    amount = fixed(reading, anisotropy, source.node, "Anisotropy")
    along = 1 - amount if amount >= 0 else 1 / (1 + amount)
    return (product(alpha, constant(along)), product(alpha, constant(1 / along)),
            turn_of(reading, source, "Rotation"))


def _rough(distribution, along, across):
    """Parameters of rough plugins."""
    kind = {"distribution": "beckmann" if distribution == "BECKMANN" else "ggx"}
    return {**kind, "alpha": along} if along is across else {**kind, "alpha_u": along, "alpha_v": across}


def _is_smooth(along):
    return along.is_constant and along.number < _LEAST_ALPHA


def _loses_little(along):
    """Whether microfacets lose less than 0.5 % of the light between each other."""
    return along.is_constant and along.number <= 0.05


def as_openpbr(along, across):
    """openpbr's roughness and anisotropy that give these alphas, of which the first is larger and not 0."""
    def roughness(u, v):
        return numpy.sqrt(u * numpy.sqrt((1 + (v / u) ** 2) / 2))

    return {"specular_roughness": combine(roughness, along, across),
            "specular_roughness_anisotropy": combine(lambda u, v: 1 - v / u, along, across)}


@shades("ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfGlossy")
def glossy(reading, source):
    node = source.node
    colour = reading.colour(source, "Color", high=1.0)
    along, across, turn = _roughnesses(reading, source)
    bend = bend_of(reading, source)
    if node.distribution == "ASHIKHMIN_SHIRLEY":
        reading.note(node, "the distribution of Ashikhmin and Shirley is exported as GGX")
    mirror = {"material": "none", "specular_reflectance": colour}
    if _is_smooth(along) and along is across:
        return Closure(Leaf("conductor", mirror, ("specular_reflectance",), bend=bend))
    if node.distribution == "MULTI_GGX" and along is across and not _loses_little(along):
        return Closure(_constant_metal(reading, source, colour, bend))
    if node.distribution == "MULTI_GGX" and not _loses_little(along):
        reading.note(node, "what anisotropic microfacets lose between each other stays lost")
    return Closure(Leaf("roughconductor", {**mirror, **_rough(node.distribution, along, across)}, ("specular_reflectance",),
                        bend=bend, turn=turn))


def _constant_metal(reading, source, colour, bend):
    """A metal with all scattering among its microfacets, whose mean reflectance is the colour, as that along the normal.
    Of F82 (kernels/bsdf/openpbr.h) the means over cosines are those of Schlick's term, 1 / 21, and of the dip, 1 / 126."""
    def tint(data):
        schlick = data + (1 - data) * 0.46266435  # at the cosine 1 / 7
        return numpy.maximum(1 - 6 * (1 - data) / (17.6514166 * schlick), 0)

    parameters = {"base_color": colour, "base_metalness": 1.0, "specular_color": combine(tint, colour),
                  "specular_roughness": reading.number(source, "Roughness", low=0.0, high=1.0)}
    return Leaf("openpbr", parameters, bend=bend, reflectance=colour, remade=lambda factor: _constant_metal(
        reading, source, product(colour, constant(factor)), bend))


@shades("ShaderNodeBsdfMetallic")
def metallic(reading, source):
    node = source.node
    along, across, turn = _roughnesses(reading, source)
    bend = bend_of(reading, source)
    note_film(reading, source)
    if node.fresnel_type == "F82":
        if node.distribution != "MULTI_GGX":
            reading.note(node, "its microfacets scatter light among each other, as those of Multiscatter GGX")
        parameters = {"base_color": reading.colour(source, "Base Color", high=1.0), "base_metalness": 1.0,
                      "specular_color": reading.colour(source, "Edge Tint", high=1.0)}
        if along is across:
            parameters["specular_roughness"] = reading.number(source, "Roughness", low=0.0, high=1.0)
        else:
            along, across = (combine(lambda data: data.clip(1e-8, 1), alpha) for alpha in (along, across))
            if along.data.mean() < across.data.mean():  # openpbr's highlights are long along the tangent
                along, across, turn = across, along, turn_of(reading, source, "Rotation", quarters=1)
            parameters |= as_openpbr(along, across)
        return Closure(Leaf("openpbr", parameters, bend=bend, turn=turn))
    if node.distribution == "MULTI_GGX" and not _is_smooth(along):
        reading.note(node, "what its microfacets lose between each other stays lost")
    parameters = {"eta": reading.colour(source, "IOR"), "k": reading.colour(source, "Extinction")}
    if not _is_smooth(along):
        parameters |= _rough(node.distribution, along, across)
    return Closure(Leaf("conductor" if _is_smooth(along) else "roughconductor", parameters, bend=bend, turn=turn))


def note_film(reading, source):
    """Thin films are exported of the Principled BSDF only."""
    if not reading.number(source, "Thin Film Thickness").is_value(0.0):
        reading.note(source.node, "its thin film is not exported")


@shades("ShaderNodeBsdfGlass")
def glass(reading, source):
    node = source.node
    colour = reading.colour(source, "Color", high=1.0)
    ior = max(fixed(reading, reading.number(source, "IOR", default=1.5), node, "IOR"), 1e-5)
    roughness = reading.number(source, "Roughness", low=0.0, high=1.0)
    alpha = squared(roughness)
    bend = bend_of(reading, source)
    note_film(reading, source)
    if node.distribution == "MULTI_GGX" and not _loses_little(alpha) and ior > 1:
        return Closure(_glass_of_many_reflections(reading, node, colour, ior, roughness, bend))
    parameters = {"int_ior": ior, "ext_ior": 1.0, "specular_reflectance": colour, "specular_transmittance": colour}
    if _is_smooth(alpha):
        return Closure(Leaf("dielectric", parameters, ("specular_reflectance", "specular_transmittance"), True, bend))
    return Closure(Leaf("roughdielectric", {**parameters, **_rough(node.distribution, alpha, alpha)},
                        ("specular_reflectance", "specular_transmittance"), True, bend))


def _glass_of_many_reflections(reading, node, colour, ior, roughness, bend):
    """openpbr's glass, which has no colour of reflections inside: a grey is absorbed by a share of black instead."""
    most = float(colour.data.max()) if colour.is_constant else 1.0
    rest = product(colour, constant(1 / most)) if most > 0 else colour
    if not rest.is_value(1.0):
        reading.note(node, "its reflections inside have less colour")
    parameters = {"transmission_weight": 1.0, "transmission_color": squared(rest), "specular_color": rest,
                  "specular_ior": ior, "specular_roughness": roughness}
    return blended(constant(1 - most), Leaf("openpbr", parameters, (), True, bend), BLACK)


@shades("ShaderNodeBsdfRefraction")
def refraction(reading, source):
    node = source.node
    ior = max(fixed(reading, reading.number(source, "IOR", default=1.5), node, "IOR"), 1e-5)
    if ior == 1:
        return transparent(reading, source)
    reading.note(node, "it transmits what a boundary does not reflect, not all light")
    colour = reading.colour(source, "Color", high=1.0)
    alpha = squared(reading.number(source, "Roughness", low=0.0, high=1.0))
    parameters = {"int_ior": ior, "ext_ior": 1.0, "specular_reflectance": constant(0.0), "specular_transmittance": colour}
    bend = bend_of(reading, source)
    if _is_smooth(alpha):
        return Closure(Leaf("dielectric", parameters, ("specular_transmittance",), True, bend))
    return Closure(Leaf("roughdielectric", {**parameters, **_rough(node.distribution, alpha, alpha)},
                        ("specular_transmittance",), True, bend))


@shades("ShaderNodeBsdfSheen")
def sheen(reading, source):
    if source.node.distribution != "MICROFIBER":
        reading.note(source.node, "sheen of Ashikhmin is exported as that of microfibres")
    return Closure(Leaf("openpbr", {"base_weight": 0.0, "specular_ior": 1.0, "fuzz_weight": 1.0,
                                    "fuzz_color": reading.colour(source, "Color", high=1.0),
                                    "fuzz_roughness": reading.number(source, "Roughness", low=0.0, high=1.0)},
                        bend=bend_of(reading, source)))


def subsurface_parameters(reading, source, method, colour, scale, radius, anisotropy):
    """openpbr's parameters of subsurface scattering, but for its weight; names of inputs."""
    node = source.node
    if method == "BURLEY":
        reading.note(node, "subsurface scattering of Christensen and Burley is exported as a random walk")
    elif method == "RANDOM_WALK_SKIN":
        reading.note(node, "the refraction of 'Random Walk (Skin)' at the surface is not exported")
    scales = reading.value(reading.at(source, radius), [1.0] * 3, 0.0)
    if not scales.is_constant:
        reading.note(node, "'Radius' counts by its mean")
        scales = constant(scales.data.reshape(-1, 3).mean(axis=0) if scales.attribute is None else [1.0] * 3)
    length = max(fixed(reading, reading.number(source, scale), node, scale), 0.0) * SUBSURFACE_RADIUS
    most = float(scales.colour.max())
    return {"subsurface_color": colour, "subsurface_radius": length * most,
            "subsurface_radius_scale": constant(scales.colour / most if most > 0 else [1.0] * 3),
            "subsurface_scatter_anisotropy": fixed(reading, reading.number(source, anisotropy, low=0.0, high=0.9), node,
                                                   anisotropy)}


@shades("ShaderNodeSubsurfaceScattering")
def subsurface(reading, source):
    colour = reading.colour(source, "Color", high=1.0)
    parameters = {"base_color": colour, "specular_ior": 1.0, "subsurface_weight": 1.0,
                  **subsurface_parameters(reading, source, source.node.falloff, colour, "Scale", "Radius", "Anisotropy")}
    return Closure(Leaf("openpbr", parameters, bend=bend_of(reading, source)))


@shades("ShaderNodeBsdfHairPrincipled")
def hair(reading, source):
    """Chiang et al. 2016."""
    node = source.node
    if node.model != "CHIANG":
        reading.note(node, "hair of Huang is exported as that of Chiang")
    if any(not reading.number(source, name).is_value(0.0) for name in ("Coat", "Random Roughness")):
        reading.note(node, "its coat and its random roughness are not exported")
    parameters = {"longitudinal_roughness": reading.number(source, "Roughness", low=0.0, high=1.0),
                  "azimuthal_roughness": reading.number(source, "Radial Roughness", low=0.0, high=1.0),
                  # Cycles counts the angle in the other sense.
                  "scale_tilt": -math.degrees(fixed(reading, reading.number(source, "Offset"), node, "Offset")),
                  "int_ior": fixed(reading, reading.number(source, "IOR", default=1.55), node, "IOR"), "ext_ior": 1.0}
    if node.parametrization == "ABSORPTION":
        parameters["sigma_a"] = reading.value(reading.at(source, "Absorption Coefficient"), [0.0] * 3, 0.0)
    elif node.parametrization == "COLOR":
        parameters["reflectance"] = reading.colour(source, "Color", high=1.0)
    else:
        _add_melanin(reading, source, parameters)
    return Closure(Leaf("hair", parameters, (), True))


def _add_melanin(reading, source, parameters):
    """Pigments: Cycles' amount is -ln(1 - melanin), of which the share of redness is pheomelanin."""
    node = source.node
    if not reading.number(source, "Random Color").is_value(0.0) or not reading.colour(source, "Tint").is_value(1.0):
        reading.note(node, "the random colour and the tint of melanin are not exported")
    melanin = fixed(reading, reading.number(source, "Melanin", low=0.0, high=1.0), node, "Melanin")
    redness = fixed(reading, reading.number(source, "Melanin Redness", low=0.0, high=1.0), node, "Melanin Redness")
    amount = -math.log(max(1 - melanin, 1e-4))
    parameters["sigma_a"] = constant(amount * ((1 - redness) * _EUMELANIN + redness * _PHEOMELANIN))


@shades("ShaderNodeBsdfHair")
def hair_of_kajiya(reading, source):
    reading.note(source.node, "this hair is exported as that of Chiang et al. 2016 with its colour")
    return Closure(Leaf("hair", {"reflectance": reading.colour(source, "Color", high=1.0)}, (), True))
