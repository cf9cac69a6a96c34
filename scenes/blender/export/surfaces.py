# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of shapes: equal ones are written once and referred to."""

from xml.etree import ElementTree

from .elements import add_reference
try:
    from .materials import export_material
except ImportError:
    # Until the materials are there, all are the default grey.
    import types

    from .elements import add_value, plugin

    def export_material(material, obj, context):
        bsdf = plugin("bsdf", "diffuse")
        add_value(bsdf, "rgb", "reflectance", [0.8] * 3)
        return types.SimpleNamespace(bsdf=bsdf, emission=None, interior=None, uv_map=None, uvs=None, attributes=set())


class Surfaces:
    """The <bsdf> and <medium> elements of one scene file. Equal ones share an id."""

    def __init__(self, context):
        self.context = context
        self.elements = []
        self._ids = {}

    def of(self, material, obj):
        """The Surface of a material on an evaluated object."""
        return export_material(material, obj, self.context)

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
