# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps as emitters and emitting shapes."""

import math

from .elements import add_matrix, add_value, plugin


def export_light(context, light_object, matrix):
    """The elements of an evaluated light object in a place."""
    light = light_object.data
    if light.type == "POINT":
        emitter = plugin("emitter", "point")
        add_matrix(emitter, matrix)
        add_value(emitter, "rgb", "intensity", [light.energy / (4 * math.pi) * channel for channel in light.color])
        return [emitter]
    context.report.add(f"lamps of type {light.type} are not exported", light_object.name)
    return []
