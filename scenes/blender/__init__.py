# SPDX-License-Identifier: GPL-3.0-or-later
"""Penumbra in Blender: a render engine, a viewport preview, and a render farm. The renderer runs beside Blender."""

from . import engine, properties

MODULES = [properties, engine]


def register():
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
