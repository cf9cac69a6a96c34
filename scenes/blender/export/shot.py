# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports the frames of a shot, which share what stays the same."""

import bpy

from .context import Context, Report
from .scene import export_scene

_QUIET = {"engine": "PENUMBRA_EXPORT", "use_persistent_data": True, "use_compositing": False, "use_sequencer": False,
          "use_multiview": False, "use_lock_interface": True}


class _Shot:
    """The export of a shot that is under way. Its Context lasts for all frames."""

    def __init__(self, folder, report, texture_size, camera):
        self.folder, self.report, self.texture_size, self.camera = folder, report, texture_size, camera
        self.context = None
        self.path = self.error = None

    def export(self, engine, depsgraph):
        """The frame that the depsgraph shows."""
        if self.context is None or self.context.depsgraph != depsgraph:
            self.context = Context(self.folder, depsgraph, self.texture_size, self.report, camera=self.camera)
        self.context.frame_set = lambda frame, subframe: engine.frame_set(frame, subframe=subframe)
        scene = depsgraph.scene.original
        self.path = export_scene(self.context, scene, f"frame.{scene.frame_current:04d}")


class _ExportEngine(bpy.types.RenderEngine):
    """A render engine only because Blender evaluates scenes for renders, not for the viewport, for those alone."""

    bl_idname = "PENUMBRA_EXPORT"
    bl_label = "Penumbra's export"
    shot = None

    def render(self, depsgraph):
        try:
            type(self).shot.export(self, depsgraph)
        except Exception as error:  # Blender would only print it
            type(self).shot.error = error


def export_shot(folder, scene, frames, view_layer=None, camera=None, texture_size=1024, progress=None,
                report=None):
    """Writes frame.NNNN.xml of each frame to the folder, as the scene is evaluated for renders.

    view_layer: its name, or all that are rendered have to be one. camera: the name of an object, or the scene's camera.
    progress(done, count) is called after each frame. report: a Report to add to. Returns the paths and the Report. Not
    while Blender renders.
    """
    report = report if report is not None else Report()
    paths = []
    render = scene.render
    kept = {name: getattr(render, name) for name in _QUIET}
    frame_before, layers_before = scene.frame_current, {layer.name: layer.use for layer in scene.view_layers}
    shot = _Shot(folder, report, texture_size, bpy.data.objects[camera] if camera else None)
    if view_layer is None:
        view_layer = next((layer.name for layer in scene.view_layers if layer.use), scene.view_layers[0].name)
    bpy.utils.register_class(_ExportEngine)
    try:
        _ExportEngine.shot = shot
        for name, value in _QUIET.items():
            setattr(render, name, value)
        for layer in scene.view_layers:
            layer.use = layer.name == view_layer
        for done, frame in enumerate(frames):
            scene.frame_set(frame)
            bpy.ops.render.render(scene=scene.name)
            if shot.error is not None:
                raise shot.error
            paths.append(shot.path)
            if progress is not None:
                progress(done + 1, len(frames))
    finally:
        for name, value in kept.items():
            setattr(render, name, value)
        for name, used in layers_before.items():
            scene.view_layers[name].use = used
        scene.frame_set(frame_before)
        bpy.utils.unregister_class(_ExportEngine)
        _ExportEngine.shot = None
    return paths, report
