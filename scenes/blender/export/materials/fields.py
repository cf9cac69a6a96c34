# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of sockets: constants, and images over texture coordinates."""

from dataclasses import dataclass
from typing import NamedTuple

import bpy
import numpy

# Luminance of linear Rec. 709, by which Blender makes a number of a colour: with D65 at (0.3127, 0.3290), or as rounded
# in IEC 61966-2-1.
LUMINANCE = numpy.array([0.21263901, 0.71516868, 0.07219232] if bpy.app.version >= (5, 0, 0) else
                        [0.2126729, 0.7151522, 0.0721750])


class NotFolded(Exception):
    """The value is neither constant nor an image over one UV map; a bake has to find it."""

    def __init__(self, node, reason):
        super().__init__(reason)
        self.node = node


class Placement(NamedTuple):
    """Where an image lies: texture coordinates are `rows` (2 × 3) times (u, v, 1) of the UV map (None: the active one)."""
    uv_map: str | None
    rows: tuple = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    extension: str = "REPEAT"
    nearest: bool = False


@dataclass
class Field:
    """A value: of shape (channels,), or (height, width, channels) of an image from its top row down.

    channels: 1 of numbers, 3 of colours and vectors.
    file: of an image that nothing has changed, the bitmap element's (path, raw, channel); None: `data` is written.
    attribute: name of the colour attribute that the value is; its data are placeholders.
    """
    data: numpy.ndarray
    placement: Placement | None = None
    file: tuple | None = None
    attribute: str | None = None

    @property
    def is_constant(self):
        return self.placement is None and self.attribute is None

    @property
    def number(self):
        """Of a constant: as a number."""
        return float(self.data[0]) if len(self.data) == 1 else float(self.data @ LUMINANCE)

    @property
    def colour(self):
        """Of a constant: three channels."""
        return numpy.broadcast_to(self.data, (3,)).astype(float)

    def is_value(self, value):
        """Whether it is that constant everywhere."""
        return self.is_constant and bool(numpy.all(self.data == value))


def constant(value):
    """The field of a number, or of three channels."""
    return Field(numpy.atleast_1d(numpy.asarray(value, dtype=float)))


def combine(function, *fields, node=None):
    """function(data, …) of fields that are constant or images of one placement and size."""
    placed = [field for field in fields if not field.is_constant]
    if not placed:
        return Field(numpy.asarray(function(*(field.data for field in fields)), dtype=float))
    for field in placed:
        if field.attribute is not None:
            raise NotFolded(node, "it changes a colour attribute")
        if field.placement != placed[0].placement or field.data.shape[:2] != placed[0].data.shape[:2]:
            raise NotFolded(node, "it combines images that differ in size or place")
    return Field(numpy.asarray(function(*(field.data for field in fields)), dtype=float), placed[0].placement)


def product(first, second):
    """The product of two fields, without a new image where one is 1."""
    if first.is_value(1.0) and (second.data.shape[-1] >= first.data.shape[-1]):
        return second
    if second.is_value(1.0) and (first.data.shape[-1] >= second.data.shape[-1]):
        return first
    return combine(numpy.multiply, first, second)


def to_number(field, kind):
    """As a number; kind: of the socket that it came from (a colour's luminance, a vector's mean)."""
    if field.data.shape[-1] == 1:
        return field
    if kind == "RGBA":
        return combine(lambda data: (data @ LUMINANCE)[..., None], field)
    return combine(lambda data: data.mean(axis=-1, keepdims=True), field)


def to_vector(field):
    """As three channels."""
    if field.data.shape[-1] == 3:
        return field
    return combine(lambda data: numpy.repeat(data, 3, axis=-1), field)
