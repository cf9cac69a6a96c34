# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with their materials: equal materials are written once and referred to."""

import dataclasses
from xml.etree import ElementTree

from .elements import add_reference


@dataclasses.dataclass
class Part:
    """What shows one material. shape: <shape> without a place and a material. name: of the material. within: for a
    volume, the matrix from the shape's own space to that of the object, where the grid of its medium is."""
    shape: object
    surface: object
    name: str
    within: object = None


class Surfaces:
    """The <bsdf> and <medium> elements of one scene file. Equal ones share an id."""

    def __init__(self):
        self.elements = []
        self._ids = {}

    def add_to(self, shape, surface, name):
        """Gives a <shape> the surface's BSDF, emission and interior; `name` becomes part of their ids."""
        if surface.bsdf is not None:
            add_reference(shape, self._id(surface.bsdf, name))
        elif surface.emission is None:
            ElementTree.SubElement(shape, "bsdf", {"type": "null"})
        if surface.emission is not None:
            shape.append(surface.emission)
        if surface.interior is not None:
            add_reference(shape, self._id(surface.interior, f"{name} interior"), "interior")

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
