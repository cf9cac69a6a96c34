# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume shaders as media."""

from dataclasses import dataclass, field

import numpy

from ..elements import add_value, plugin
from .black_body import black_body_emission
from .fields import LUMINANCE, NotFolded
from .nodes import Input, source_of

_LEAST_BLACK_BODY = 1e-3  # less Cycles leaves out
_OF_VOLUME_INFO = {"Color": "color", "Density": "density", "Flame": "flame", "Temperature": "temperature"}


@dataclass
class Medium:
    """Coefficients of absorption and scattering per Blender unit, emitted radiance per unit, and phase functions:
    scattering coefficient by g, or by "rayleigh". Colours are (3,), or where grids are looked up (x, y, z, 3)."""
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
        means = [amount.reshape(-1, 3).mean(axis=0) for amount in self.scattered.values() if amount.any()]
        colours = [mean / mean.max() for mean in means]
        return any(not numpy.allclose(colour, colours[0]) for colour in colours)

    def element(self):
        """The <medium>, without grids."""
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
        parts = [(phase, float(amount.reshape(-1, 3).mean(axis=0) @ LUMINANCE)) for phase, amount in self.scattered.items() if amount.any()]
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
        weight = numpy.clip(_number(reading, source, "Fac"), 0, 1)
        return Medium().add(_medium(reading, shaders[0]), 1 - weight).add(_medium(reading, shaders[1]), weight)
    reading.note(node, f"volume shader '{node.bl_label}' is not exported")
    return Medium()


def _grid(reading, name):
    """The values of a grid: (x, y, z, 1 or 3). None if there is no such grid."""
    return reading.grids.values(name) if reading.grids is not None and name else None


def _linked_grid(reading, at):
    """The values of the grid that feeds an input, or None."""
    source = source_of(at)
    node = source.node if source is not None and not source.is_constant else None
    if node is not None and node.bl_idname == "ShaderNodeVolumeInfo":
        return _grid(reading, _OF_VOLUME_INFO[source.socket.name])
    if node is not None and node.bl_idname == "ShaderNodeAttribute" and node.attribute_type == "GEOMETRY":
        return _grid(reading, node.attribute_name)
    return None


def _named_grid(reading, source, name):
    """The grid that the node names, or None."""
    socket = reading.at(source, name).socket
    return _grid(reading, socket.default_value) if socket is not None else None


def _fold(reading, source, name):
    """The constant of an input, or a grid that feeds it; what varies otherwise is left out, with a note."""
    at = reading.at(source, name)
    grid = _linked_grid(reading, at)
    if grid is not None:
        return grid
    try:
        field_ = reading.values.fold(at)
    except NotFolded:
        field_ = None
    if field_ is None or not field_.is_constant:
        reading.note(source.node, f"'{name}' varies within the volume; it counts as "
                                  "the value of its socket where nothing is linked")
        value = at.socket.default_value
        return numpy.array([value] if isinstance(value, float) else list(value)[:3], dtype=float)
    return numpy.atleast_1d(field_.data)


def _number(reading, source, name):
    """(1,), or on a grid (x, y, z, 1)."""
    return numpy.mean(_fold(reading, source, name), axis=-1, keepdims=True)


def _positive(reading, source, name):
    return numpy.maximum(_number(reading, source, name), 0.0)


def _colour(reading, source, name):
    value = numpy.maximum(_fold(reading, source, name), 0).astype(float)
    return numpy.broadcast_to(value, (*value.shape[:-1], 3))


def _phase_of(reading, source):
    kind = getattr(source.node, "phase", "HENYEY_GREENSTEIN")
    if kind == "RAYLEIGH":
        return "rayleigh"
    if kind != "HENYEY_GREENSTEIN":
        reading.note(source.node, f"phase function {kind} is exported as that of Henyey and Greenstein")
    anisotropy = _number(reading, source, "Anisotropy")
    if anisotropy.size > 1:
        reading.note(source.node, "'Anisotropy' varies within the volume; it counts as its mean")
    return min(max(float(anisotropy.mean()), -0.99), 0.99)


def _absorption(reading, source):
    density = _positive(reading, source, "Density")
    return Medium(absorbed=density * numpy.maximum(1 - _colour(reading, source, "Color"), 0))


def _scatter(reading, source):
    density = _positive(reading, source, "Density")
    return Medium(scattered={_phase_of(reading, source): density * _colour(reading, source, "Color")})


def _principled(reading, source):
    """Absorption is the share 1 - colour times 1 - sqrt(absorption colour). Density does not change what is emitted."""
    density, colour = _positive(reading, source, "Density"), _colour(reading, source, "Color")
    grid = _named_grid(reading, source, "Density Attribute")
    if grid is not None and density.any():
        density = density * numpy.maximum(grid.mean(axis=-1, keepdims=True), 0)
    grid = _named_grid(reading, source, "Color Attribute")
    if grid is not None:
        colour = colour * numpy.maximum(grid, 0)
    absorbed = numpy.maximum(1 - colour, 0) * numpy.maximum(1 - numpy.sqrt(_colour(reading, source, "Absorption Color")), 0)
    emitted = _positive(reading, source, "Emission Strength") * _colour(reading, source, "Emission Color")
    intensity = _number(reading, source, "Blackbody Intensity")
    if (intensity > _LEAST_BLACK_BODY).any():
        kelvins = _positive(reading, source, "Temperature")

        def of_grid(factor):
            return black_body_emission(kelvins * numpy.maximum(factor.mean(axis=-1, keepdims=True), 0), intensity)

        light = of_grid(numpy.ones(1))
        name = reading.at(source, "Temperature Attribute").socket
        if reading.grids is not None and name is not None and name.default_value:
            hot = reading.grids.mapped(name.default_value, of_grid)
            light = light if hot is None else hot
        emitted = emitted + light * _colour(reading, source, "Blackbody Tint")
    return Medium(density * absorbed, emitted, {_phase_of(reading, source): density * colour})


def _coefficients(reading, source):
    return Medium(_colour(reading, source, "Absorption Coefficients"), _colour(reading, source, "Emission Coefficients"),
                  {_phase_of(reading, source): _colour(reading, source, "Scatter Coefficients")})


def _emission(reading, source):
    return Medium(emitted=_positive(reading, source, "Strength") * _colour(reading, source, "Color"))
