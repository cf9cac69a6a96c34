# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume shaders as homogeneous media."""

from dataclasses import dataclass, field

import numpy

from ..elements import add_value, plugin
from .fields import LUMINANCE, NotFolded
from .nodes import Input, source_of


@dataclass
class Medium:
    """Coefficients of absorption and scattering per Blender unit, emitted radiance per unit, and phase functions:
    scattering coefficient by g, or by "rayleigh"."""
    absorbed: numpy.ndarray = field(default_factory=lambda: numpy.zeros(3))
    emitted: numpy.ndarray = field(default_factory=lambda: numpy.zeros(3))
    scattered: dict = field(default_factory=dict)

    def add(self, other, factor=1.0):
        self.absorbed = self.absorbed + factor * other.absorbed
        self.emitted = self.emitted + factor * other.emitted
        for phase, amount in other.scattered.items():
            self.scattered[phase] = self.scattered.get(phase, numpy.zeros(3)) + factor * amount
        return self

    @property
    def scattering(self):
        """Of all phase functions."""
        return sum(self.scattered.values(), numpy.zeros(3))

    @property
    def mixes_colours(self):
        """Whether phase functions would have to be mixed by another weight in each channel."""
        colours = [amount / amount.max() for amount in self.scattered.values() if amount.any()]
        return any(not numpy.allclose(colour, colours[0]) for colour in colours)

    def element(self):
        """The <medium>."""
        element = plugin("medium", "homogeneous")
        add_value(element, "rgb", "sigma_a", self.absorbed)
        add_value(element, "rgb", "sigma_s", self.scattering)
        if self.emitted.any():
            add_value(element, "rgb", "emission", self.emitted)
        if self.scattering.any():
            element.append(self.phase())
        return element

    def phase(self):
        """The <phase>: one, or a blend by the luminance of what each scatters. Something must scatter."""
        parts = [(phase, float(amount @ LUMINANCE)) for phase, amount in self.scattered.items() if amount.any()]
        element, total = None, 0.0
        for phase, amount in parts:
            one = plugin("phase", "rayleigh") if phase == "rayleigh" else plugin("phase", "hg")
            if phase != "rayleigh":
                add_value(one, "float", "g", phase)
            total += amount
            if element is None:
                element = one
                continue
            both = plugin("phase", "blendphase")
            add_value(both, "float", "weight", amount / total)
            both.extend([element, one])
            element = both
        return element


def medium_of(reading, at):
    """The Medium of a Volume input, or None."""
    source = source_of(at)
    if source is None or source.is_constant:
        return None
    medium = _medium(reading, at)
    if not (medium.scattering.any() or medium.absorbed.any() or medium.emitted.any()):
        return None
    if medium.mixes_colours:
        reading.note(source.node, "phase functions are mixed alike for all colours")
    return medium


def _medium(reading, at):
    source = source_of(at)
    if source is None or source.is_constant:
        return Medium()
    node = source.node
    function = {"ShaderNodeVolumeAbsorption": _absorption, "ShaderNodeVolumeScatter": _scatter,
                "ShaderNodeVolumePrincipled": _principled, "ShaderNodeVolumeCoefficients": _coefficients,
                "ShaderNodeEmission": _emission}.get(node.bl_idname)
    if function is not None:
        return function(reading, source)
    shaders = [Input(socket, source.groups) for socket in node.inputs if socket.type == "SHADER"]
    if node.bl_idname == "ShaderNodeAddShader":
        return _medium(reading, shaders[0]).add(_medium(reading, shaders[1]))
    if node.bl_idname == "ShaderNodeMixShader":
        weight = _number(reading, source, "Fac")
        return Medium().add(_medium(reading, shaders[0]), 1 - weight).add(_medium(reading, shaders[1]), weight)
    reading.note(node, f"volume shader '{node.bl_label}' is not exported")
    return Medium()


def _fold(reading, source, name):
    """The constant of an input; what varies is left out, with a note."""
    at = reading.at(source, name)
    try:
        field_ = reading.values.fold(at)
    except NotFolded:
        field_ = None
    if field_ is None or not field_.is_constant:
        reading.note(source.node, f"'{name}' varies within the volume; it counts as "
                                  "the value of its socket where nothing is linked")
        value = at.socket.default_value
        return numpy.array(value if isinstance(value, float) else list(value)[:3], dtype=float)
    return field_.data


def _number(reading, source, name):
    return float(numpy.mean(_fold(reading, source, name)))


def _colour(reading, source, name):
    return numpy.maximum(numpy.broadcast_to(_fold(reading, source, name), (3,)), 0).astype(float)


def _phase_of(reading, source):
    kind = getattr(source.node, "phase", "HENYEY_GREENSTEIN")
    if kind == "RAYLEIGH":
        return "rayleigh"
    if kind != "HENYEY_GREENSTEIN":
        reading.note(source.node, f"phase function {kind} is exported as that of Henyey and Greenstein")
    return min(max(_number(reading, source, "Anisotropy"), -0.99), 0.99)


def _absorption(reading, source):
    density = max(_number(reading, source, "Density"), 0.0)
    return Medium(absorbed=density * numpy.maximum(1 - _colour(reading, source, "Color"), 0))


def _scatter(reading, source):
    density = max(_number(reading, source, "Density"), 0.0)
    return Medium(scattered={_phase_of(reading, source): density * _colour(reading, source, "Color")})


def _principled(reading, source):
    """Absorption is the share 1 - colour times 1 - sqrt(absorption colour)."""
    density = max(_number(reading, source, "Density"), 0.0)
    colour = _colour(reading, source, "Color")
    absorbed = numpy.maximum(1 - colour, 0) * numpy.maximum(1 - numpy.sqrt(_colour(reading, source, "Absorption Color")), 0)
    emitted = max(_number(reading, source, "Emission Strength"), 0.0) * _colour(reading, source, "Emission Color")
    if _number(reading, source, "Blackbody Intensity") > 0:
        reading.note(source.node, "blackbody emission of volumes is not exported")
    return Medium(density * absorbed, emitted, {_phase_of(reading, source): density * colour})


def _coefficients(reading, source):
    return Medium(_colour(reading, source, "Absorption Coefficients"), _colour(reading, source, "Emission Coefficients"),
                  {_phase_of(reading, source): _colour(reading, source, "Scatter Coefficients")})


def _emission(reading, source):
    return Medium(emitted=max(_number(reading, source, "Strength"), 0.0) * _colour(reading, source, "Color"))
