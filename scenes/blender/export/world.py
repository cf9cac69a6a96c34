# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world as an environment."""

from .elements import add_value, plugin


def export_world(context, world):
    """The elements of the evaluated world, which may be None."""
    if world is None:
        return []
    background = None
    if world.node_tree is not None:
        background = next((node for node in world.node_tree.nodes if node.type == "BACKGROUND"), None)
    if background is not None and not background.inputs["Color"].is_linked:
        strength = background.inputs["Strength"].default_value
        colour = [strength * channel for channel in background.inputs["Color"].default_value[:3]]
    else:
        colour = list(world.color)
    if not any(colour):
        return []
    emitter = plugin("emitter", "constant")
    add_value(emitter, "rgb", "radiance", colour)
    return [emitter]
