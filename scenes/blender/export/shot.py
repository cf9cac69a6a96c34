# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports the frames of a shot, which share what stays the same."""

from .context import Context, Report
from .scene import export_scene


def export_shot(folder, scene, frames, view_layer=None, camera=None, texture_size=1024, progress=None):
    """Writes frame.NNNN.xml of each frame to the folder.

    view_layer: its name, or the active one. camera: the name of an object, or the scene's camera.
    progress(done, count) is called after each frame. Returns the paths and the Report.
    """
    import bpy

    report = Report()
    layer = scene.view_layers[view_layer] if view_layer else scene.view_layers[0]
    paths = []
    if camera:
        scene.camera = bpy.data.objects[camera]
    for done, frame in enumerate(frames):
        scene.frame_set(frame)
        context = Context(folder, layer.depsgraph, texture_size, report)
        paths.append(export_scene(context, scene, f"frame.{frame:04d}"))
        if progress is not None:
            progress(done + 1, len(frames))
    return paths, report
