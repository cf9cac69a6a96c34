# SPDX-License-Identifier: GPL-3.0-or-later
"""One material on one object, while it is read."""

import numpy

from .fields import NotFolded, constant
from .nodes import Input, input_socket
from .values import Values, is_linked


class Reading:
    """The values of a material's sockets, with a report of what is left out."""

    def __init__(self, material, obj, context):
        self.material, self.obj, self.context = material, obj, context
        self.values = Values(None)

    def note(self, node, message):
        """Adds a line to the report."""
        self.context.report.add(message, self.obj.name if self.obj is not None else None, self.material.name,
                                node.name if node is not None else None)

    def at(self, source, *names):
        """The input of the source's node that has one of the names; its socket may be None."""
        return Input(input_socket(source.node, *names), source.groups)

    def colour_at(self, at):
        """The value of an input as a colour."""
        return self._value(at, [0.0] * 3, 0.0, None)

    def is_linked(self, source, *names):
        return is_linked(self.at(source, *names))

    def number(self, source, *names, default=0.0, low=None, high=None):
        """The value of a number's input, clamped to [low, high]."""
        return self._value(self.at(source, *names), default, low, high)

    def colour(self, source, *names, default=0.0, low=0.0, high=None):
        """The value of a colour's input."""
        return self._value(self.at(source, *names), [default] * 3, low, high)

    def _value(self, at, default, low, high):
        if at.socket is None:
            return constant(default)
        try:
            field = self.values.fold(at)
        except NotFolded as missing:
            self.note(missing.node, f"'{at.socket.name}' of '{at.node.name}' is not exported: {missing}")
            field = constant(default)
        return clamped(field, low, high)


def clamped(field, low, high):
    """The field within bounds; itself if it is."""
    if field.attribute is not None or field.file is not None:
        return field  # within [0, 1], as far as the program clamps textures
    data = numpy.clip(field.data, low, high) if low is not None or high is not None else field.data
    if numpy.array_equal(data, field.data):
        return field
    field.data = data
    return field
