# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF as an openpbr surface, whose layers are the same but for what is noted."""

import math

from .closures import SMOOTH, Closure, Leaf, Mask
from .fields import combine, constant, product
from .microfacets import as_openpbr, fixed, squared, subsurface_parameters, turn_of
from .normals import bend_of
from .nodes import source_of
from .shaders import blended, inverse, multiplied, shades, shining


def _reflectance(ior):
    return ((ior - 1) / (ior + 1)) ** 2


def _index(reflectance):
    root = min(math.sqrt(reflectance), 0.999)
    return (1 + root) / (1 - root)


@shades("ShaderNodeBsdfPrincipled")
def principled(reading, source):
    node = source.node
    if node.distribution == "GGX":
        reading.note(node, "its microfacets scatter light among each other, as those of Multiscatter GGX")
    metalness = reading.number(source, "Metallic", low=0.0, high=1.0)
    # Of what is no metal a share transmits. Its inner side shows the opaque part, too, which openpbr's does not.
    transmission = multiplied(reading, inverse(metalness),
                              reading.number(source, "Transmission Weight", low=0.0, high=1.0), node)
    opaque_metal = metalness
    if not transmission.is_value(0.0) and not metalness.is_value(0.0):
        opaque_metal = combine(lambda metal, glass: (metal / (1 - glass).clip(1e-6, 1)).clip(0, 1), metalness, transmission)
    bend = bend_of(reading, source)
    turn = None
    if not reading.number(source, "Anisotropic", low=0.0, high=1.0).is_value(0.0):
        turn = turn_of(reading, source, "Anisotropic Rotation")
    opaque, glass = (None if unused else Leaf("openpbr", _parameters(reading, source, transmits, opaque_metal), (),
                                              transmits, bend, turn=None if transmits else turn,
                                              coat_bend=_coat_bend(reading, source, bend))
                     for transmits, unused in ((False, transmission.is_value(1.0)), (True, transmission.is_value(0.0))))
    bsdf = blended(transmission, opaque, glass)
    emission = multiplied(reading, reading.colour(source, "Emission Color"),
                          reading.number(source, "Emission Strength", low=0.0), node)
    layers = [reading.number(source, name) for name in ("Coat Weight", "Sheen Weight")]
    if shining(emission) is not None and not all(layer.is_value(0.0) for layer in layers):
        reading.note(node, "coat and sheen do not dim its emission")
    alpha = reading.number(source, "Alpha", default=1.0, low=0.0, high=1.0)
    if alpha.is_value(1.0):
        return Closure(bsdf, shining(emission))
    return Closure(Mask(alpha, bsdf), shining(emission) and shining(multiplied(reading, emission, alpha, node)))


def _parameters(reading, source, transmits, metalness):
    """Of the part that transmits, or of the opaque one."""
    node = source.node
    colour = reading.colour(source, "Base Color", high=1.0)
    parameters = {"specular_roughness": reading.number(source, "Roughness", low=0.0, high=1.0)}
    _add_specular(reading, source, parameters, transmits)
    if transmits:
        parameters |= {"transmission_weight": 1.0, "transmission_color": colour}
    else:
        parameters |= {"base_color": colour, "base_metalness": metalness}
        _add(parameters, "base_diffuse_roughness", reading.number(source, "Diffuse Roughness", low=0.0, high=1.0))
        _add_anisotropy(reading, source, parameters)
        subsurface = reading.number(source, "Subsurface Weight", low=0.0, high=1.0)
        if not subsurface.is_value(0.0):
            parameters |= {"subsurface_weight": subsurface, **subsurface_parameters(
                reading, source, node.subsurface_method, colour, "Subsurface Scale", "Subsurface Radius",
                "Subsurface Anisotropy")}
    _add_coat(reading, source, parameters, transmits)
    _add_sheen(reading, source, parameters)
    _add_film(reading, source, parameters)
    return parameters


def _add(parameters, name, field, neutral=0.0):
    if not field.is_value(neutral):
        parameters[name] = field


def _add_specular(reading, source, parameters, transmits):
    """The level is a factor of the reflectance along the normal, 0.5 being 1; the tint fades to white at grazing angles."""
    node = source.node
    ior = fixed(reading, reading.number(source, "IOR", default=1.5, low=1e-5), node, "IOR")
    if ior < 1:
        reading.note(node, "a refractive index below 1 is exported as its inverse")
        ior = 1 / ior
    level = reading.number(source, "Specular IOR Level", default=0.5, low=0.0)
    tint = reading.colour(source, "Specular Tint", default=1.0)
    along_normal = _reflectance(ior)
    if not level.is_constant and not transmits:
        parameters["specular_weight"] = combine(lambda data: (2 * data).clip(0, 1), level)
        if (level.data > 0.5).any():
            reading.note(node, "a 'Specular IOR Level' that varies is 0.5 at most")
    elif not transmits:
        along_normal = min(along_normal * 2 * level.number, 1.0)
    most = float(tint.data.max()) if tint.attribute is None else 1.0
    if most > 1 and not transmits:  # more than white is another index
        tint = product(tint, constant(1 / most))
        along_normal = min(along_normal * most, 1.0)
    parameters["specular_ior"] = ior if along_normal == _reflectance(ior) else _index(along_normal)
    if not tint.is_value(1.0):
        parameters |= {"specular_color": tint, "specular_color_fades": True}


def _add_anisotropy(reading, source, parameters):
    anisotropy = reading.number(source, "Anisotropic", low=0.0, high=1.0)
    if anisotropy.is_value(0.0):
        return
    aspect = combine(lambda data: (1 - 0.9 * data) ** 0.5, anisotropy)
    alpha = combine(lambda data: data.clip(1e-8, 1), squared(parameters["specular_roughness"]))
    parameters |= as_openpbr(combine(lambda a, ratio: (a / ratio).clip(0, 1), alpha, aspect), product(alpha, aspect))


def _add_coat(reading, source, parameters, transmits):
    """Cycles' coat changes neither the reflectance nor the roughness of what is below it, and has no darkening."""
    weight = reading.number(source, "Coat Weight", low=0.0, high=1.0)
    if weight.is_value(0.0):
        return
    node = source.node
    ior = max(fixed(reading, reading.number(source, "Coat IOR", default=1.5), node, "Coat IOR"), 1.0)
    roughness = reading.number(source, "Coat Roughness", default=0.03, low=0.0, high=1.0)
    parameters |= {"coat_weight": weight, "coat_ior": ior, "coat_darkening": 0.0, "coat_roughness": roughness}
    tint = reading.colour(source, "Coat Tint", default=1.0, high=1.0)
    _add(parameters, "coat_color", tint, 1.0)
    if transmits:
        return
    share = weight.number if weight.is_constant else 1.0
    parameters["specular_ior"] /= 1 - share + share / ior
    below = parameters["specular_roughness"]
    below = below if not isinstance(below, float) else constant(below)
    if not below.is_constant or not roughness.is_constant:
        return  # openpbr, too, leaves such roughnesses as they are
    given = below.number

    def seen(base):
        both = min(1.0, base ** 4 + 2 * roughness.number ** 4) ** 0.25
        return base + (both - base) * share

    if seen(0.0) > given:
        reading.note(node, f"below the coat the surface looks as if its roughness were {seen(0.0):.3g}")
    low, high = 0.0, given
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if seen(middle) < given else (low, middle)
    parameters["specular_roughness"] = constant(low)


def _coat_bend(reading, source, bend):
    """Of the coat, which has the surface's normals where nothing is linked."""
    if reading.number(source, "Coat Weight", low=0.0, high=1.0).is_value(0.0):
        return None
    feed, below = (source_of(reading.at(source, name)) for name in ("Coat Normal", "Normal"))
    if feed is not None and feed == below:
        return None
    coat = bend_of(reading, source, "Coat Normal")
    return coat if coat is not None or bend is None else SMOOTH


def _add_sheen(reading, source, parameters):
    weight = reading.number(source, "Sheen Weight", low=0.0, high=1.0)
    if weight.is_value(0.0):
        return
    tint = reading.colour(source, "Sheen Tint", default=1.0, high=1.0)
    if tint.is_constant:  # what is below has what its brightest channel leaves, in openpbr what white leaves
        most = max(float(tint.data.max()), 1e-6)
        weight, tint = product(weight, constant(most)), product(tint, constant(1 / most))
    else:
        reading.note(source.node, "below sheen of a tint that varies it is as dark as below a white one")
    parameters |= {"fuzz_weight": weight, "fuzz_color": tint,
                   "fuzz_roughness": reading.number(source, "Sheen Roughness", default=0.5, low=0.0, high=1.0)}


def _add_film(reading, source, parameters):
    thickness = reading.number(source, "Thin Film Thickness", low=0.0)
    if thickness.is_value(0.0):
        return
    node = source.node
    ior = fixed(reading, reading.number(source, "Thin Film IOR", default=1.33), node, "Thin Film IOR")
    parameters |= {"thin_film_weight": 1.0, "thin_film_ior": max(ior, 1.0)}
    if thickness.is_constant:
        parameters["thin_film_thickness"] = thickness.number / 1000  # of nanometres
        return
    most = float(thickness.data.max())
    parameters |= {"thin_film_thickness": product(thickness, constant(1 / most)), "thin_film_thickness_minimum": 0.0,
                   "thin_film_thickness_maximum": most / 1000}
