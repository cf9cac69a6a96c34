# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF as an openpbr surface."""

from .closures import Closure, Leaf
from .fields import constant, product
from .shaders import scaled_emission, shades


@shades("ShaderNodeBsdfPrincipled")
def principled(reading, source):
    parameters = {"base_color": reading.colour(source, "Base Color", high=1.0),
                  "base_metalness": reading.number(source, "Metallic", low=0.0, high=1.0),
                  "specular_roughness": reading.number(source, "Roughness", low=0.0, high=1.0)}
    emitted = product(reading.colour(source, "Emission Color"), reading.number(source, "Emission Strength", low=0.0))
    return Closure(Leaf("openpbr", parameters, ("base_weight",)), scaled_emission(emitted, constant(1.0)))
