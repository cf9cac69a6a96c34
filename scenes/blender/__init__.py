# SPDX-License-Identifier: GPL-3.0-or-later
"""Penumbra in Blender: a render engine, a viewport preview, and a render farm. The renderer runs beside Blender."""

import atexit

import bpy

from . import engine, farm, panels, properties

MODULES = [properties, engine, farm, panels]


def register():
    for module in MODULES:
        module.register()
    if getattr(bpy.app, "module", False):  # as a module of Python, Blender 4.5 hangs at its end if it still has engines
        atexit.register(unregister)


def unregister():
    atexit.unregister(unregister)
    for module in reversed(MODULES):
        module.unregister()
