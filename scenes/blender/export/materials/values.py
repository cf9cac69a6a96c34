# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of sockets as fields: constants and images are folded, node by node."""

import numpy

from .coordinates import render_uv_map
from .fields import Field, NotFolded, combine, constant, to_number, to_vector
from .nodes import source_of

# function(values, source) -> Field by bl_idname of nodes; see folded_nodes.py and images.py.
FOLDED = {}


def folds(*names):
    """Registers the function for nodes of these names."""
    def register(function):
        for name in names:
            FOLDED[name] = function
        return function
    return register


def own_value(socket):
    """The value of an unlinked input: a number, or three channels."""
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, (bool, int, float)):
        return constant(value)
    if isinstance(value, str):
        return constant(0.0)
    return constant(list(value)[:3])


def converted(field, kind, to):
    """A field of a socket type as that of another."""
    if to in {"VALUE", "INT", "BOOLEAN"}:
        field = to_number(field, kind)
        if to == "INT" and kind not in {"INT", "BOOLEAN"}:
            field = combine(numpy.trunc, field)
        return field
    return to_vector(field) if to in {"RGBA", "VECTOR"} else field


class Values:
    """Folds the sockets of one material."""

    def __init__(self, images, mesh):
        self.images, self.mesh = images, mesh
        self._known = {}

    def is_uv_map(self, name):
        """Whether the mesh has a UV map of that name."""
        return self.mesh is not None and name in self.mesh.uv_layers

    def uv_map(self, name):
        """The name, or None for the map that is active for renders, which an empty name means, too."""
        return None if name in {"", render_uv_map(self.mesh)} else name

    def attribute(self, node, name):
        """The Field of a colour attribute; an empty name means the one that is active for renders."""
        colours = self.mesh.color_attributes if self.mesh is not None else None
        if not name and colours:
            name = colours[max(colours.render_color_index, 0)].name
        if not colours or name not in colours:
            raise NotFolded(node, "the mesh has no such colour attribute")
        return Field(numpy.zeros(3), None, None, name)

    def fold(self, at):
        """The Field of an Input. Raises NotFolded."""
        source = source_of(at)
        if source is None:
            return converted(constant(0.0), "VALUE", at.socket.type)
        field = self.of_source(source)
        kind = source.socket.type
        for to in reversed(source.kinds):
            field = converted(field, kind, to)
            kind = to
        return field

    def of_source(self, source):
        """The Field of what feeds an input, as its own type."""
        if source.is_constant:
            return own_value(source.socket)
        key = (source.socket.as_pointer(), tuple(group.as_pointer() for group in source.groups))
        if key not in self._known:
            function = FOLDED.get(source.node.bl_idname)
            if function is None:
                raise NotFolded(source.node, "it is no constant and no image")
            self._known[key] = function(self, source)
        return self._known[key]

    def input(self, source, name):
        """The Field of an input of the source's node."""
        return self.fold(source.input(name))


def is_linked(at):
    """Whether an input gets its value from a node."""
    if at.socket is None:
        return False
    source = source_of(at)
    return source is not None and not source.is_constant
