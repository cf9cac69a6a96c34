# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements of Mitsuba's XML: plugins and their parameters."""

from xml.etree import ElementTree

Element = ElementTree.Element


def plugin(kind, plugin_type, identifier=None, name=None):
    """An element such as <bsdf type="diffuse" id="wall" name="bsdf">."""
    attributes = {"type": plugin_type}
    if identifier is not None:
        attributes["id"] = identifier
    if name is not None:
        attributes["name"] = name
    return Element(kind, attributes)


def number(value):
    """The shortest text that gives the same double again."""
    return repr(float(value))


def add_value(parent, kind, name, value):
    """Adds <KIND name="NAME" value="VALUE"/>; kind is float, integer, boolean, string or rgb."""
    if kind == "rgb":
        text = ", ".join(number(channel) for channel in value)
    elif kind == "float":
        text = number(value)
    elif kind == "integer":
        text = str(int(value))
    elif kind == "boolean":
        text = "true" if value else "false"
    else:
        text = str(value)
    ElementTree.SubElement(parent, kind, {"name": name, "value": text})


def matrix_text(matrix):
    """The numbers of a 4 × 4 matrix of floats, by rows."""
    return " ".join([repr(x) for row in matrix for x in row])


def add_matrix(parent, matrix, name="to_world"):
    """Adds <transform> with the 4 × 4 matrix, given as rows."""
    transform = ElementTree.SubElement(parent, "transform", {"name": name})
    ElementTree.SubElement(transform, "matrix", {"value": matrix_text(matrix)})


def add_reference(parent, identifier, name=None):
    """Adds <ref id="IDENTIFIER"/>."""
    attributes = {"id": identifier}
    if name is not None:
        attributes["name"] = name
    ElementTree.SubElement(parent, "ref", attributes)


def write_scene(scene, path):
    """Writes the element to a file."""
    ElementTree.indent(scene, space="  ")
    ElementTree.ElementTree(scene).write(path, encoding="utf-8", xml_declaration=True)
