# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with their materials: equal materials are written once and referred to."""

import dataclasses
from xml.etree import ElementTree

from .elements import add_reference


@dataclasses.dataclass
class Part:
    """What shows one material. shape: <shape> without a place and a material. name: of the material. outline: of what has
    an interior, vertices and triangles, (n, 3) each, in the space of the object. within: for a volume, the matrix from the
    shape's own space to that of the object, where the grid of its medium is."""
    shape: object
    surface: object
    name: str
    outline: object = None
    within: object = None


class Surfaces:
    """The <bsdf> and <medium> elements of one scene file. Equal ones share an id."""

    def __init__(self):
        self.elements = []
        self._ids = {}

    def add_to(self, shape, surface, name, interior=None, exterior=None):
        """Gives a <shape> the surface's BSDF and emission, and <medium> elements; `name` becomes part of their ids."""
        if surface.bsdf is not None:
            add_reference(shape, self._id(surface.bsdf, name))
        elif surface.emission is None:
            ElementTree.SubElement(shape, "bsdf", {"type": "null"})
        if surface.emission is not None:
            shape.append(surface.emission)
        for side, medium in (("interior", interior), ("exterior", exterior)):
            if medium is not None:
                self.add_medium_to(shape, medium, name, side)

    def add_medium_to(self, parent, medium, name, side):
        """Refers to a <medium> as a parameter."""
        add_reference(parent, self._id(medium, f"{name} {side}"), side)

    def _id(self, element, name):
        text = ElementTree.tostring(element)
        if text not in self._ids:
            names = set(self._ids.values())
            identifier, number = name, 1
            while identifier in names:
                number += 1
                identifier = f"{name}.{number}"
            self._ids[text] = identifier
            copied = ElementTree.fromstring(text)
            copied.set("id", identifier)
            self.elements.append(copied)
        return self._ids[text]
