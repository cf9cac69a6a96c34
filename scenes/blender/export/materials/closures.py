# SPDX-License-Identifier: GPL-3.0-or-later
"""What a shader is: a tree of BSDFs, and the light that it emits."""

from dataclasses import dataclass, field, replace

from .fields import Field, constant


@dataclass(frozen=True)
class Leaf:
    """One BSDF plugin. parameters: Field, bool, int or str by name. colours: the parameters that multiply all of it.

    transmits: whether it has two sides of its own. bend: a Bend, or None. turn: a Turn, or None. coat_bend: that of its
    coat, SMOOTH, or None where it is `bend`.
    remade: function(factor) -> Leaf, the same with `reflectance`, a Field, times the factor; where no parameter multiplies
    all of it.
    """
    plugin: str
    parameters: dict
    colours: tuple = ()
    transmits: bool = False
    bend: object = None
    reflectance: Field | None = None
    remade: object = None
    turn: object = None
    coat_bend: object = None


SMOOTH = "smooth"


@dataclass(frozen=True)
class Bend:
    """A normal map or bump map: the plugin, its texture, and the factor of heights."""
    plugin: str
    texture: Field
    scale: float = 1.0


@dataclass(frozen=True)
class Turn:
    """Of the tangent: an angle in radians, or a Field of directions along tangent and bitangent, in [0, 1]."""
    angle: float = 0.0
    directions: Field | None = None


@dataclass(frozen=True)
class Blend:
    """weight: of the second."""
    weight: Field
    first: object
    second: object


@dataclass(frozen=True)
class Mask:
    """Light passes where the opacity is 0."""
    opacity: Field
    inside: object


@dataclass(frozen=True)
class Clear:
    """No surface: all light passes."""


BLACK = Leaf("diffuse", {"reflectance": constant(0.0)}, ("reflectance",))


@dataclass
class Closure:
    """bsdf: Leaf, Blend, Mask, Clear, or None where nothing scatters light. emission: radiance, or None."""
    bsdf: object = None
    emission: Field | None = None


def leaves(bsdf):
    """All leaves of a tree."""
    if isinstance(bsdf, Leaf):
        yield bsdf
    elif isinstance(bsdf, Blend):
        yield from leaves(bsdf.first)
        yield from leaves(bsdf.second)
    elif isinstance(bsdf, Mask):
        yield from leaves(bsdf.inside)


def bent(bsdf, bend):
    """The tree with the bend on all leaves, and all coats, that have none."""
    if bend is None or bsdf is None:
        return bsdf
    if isinstance(bsdf, Leaf):
        coat = bend if bsdf.coat_bend is SMOOTH else bsdf.coat_bend
        return replace(bsdf, bend=bend if bsdf.bend is None else bsdf.bend, coat_bend=coat)
    if isinstance(bsdf, Blend):
        return replace(bsdf, first=bent(bsdf.first, bend), second=bent(bsdf.second, bend))
    if isinstance(bsdf, Mask):
        return replace(bsdf, inside=bent(bsdf.inside, bend))
    return bsdf
