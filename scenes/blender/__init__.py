# SPDX-License-Identifier: GPL-3.0-or-later
"""Penumbra in Blender: a render engine, a viewport preview, and a render farm. The renderer runs beside Blender."""

from . import engine, farm, panels, properties

MODULES = [properties, engine, farm, panels]


def register():
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
