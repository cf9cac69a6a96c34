# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: exports each view layer, runs `penumbra`, and shows and keeps what it makes."""

import dataclasses
import errno
import json
import pathlib
import shutil
import tempfile
import time
import traceback

import bpy
import numpy as np

from . import exr, passes, preview
from .command import sampling_options, worker_options
from .export.context import Context, Report, Stopped
from .export.scene import export_scene
from .program import Process, ProgramError
from .properties import settings_of
from .tile_stream import TileStream

FILM = ["--set", "film.compression=none"]  # as fast as can be, since the file is read at once, by exr.py
GRACE = 0.6  # seconds in which a stopped renderer may write its files
POLL_INTERVAL = 0.05  # seconds between looks at Esc
SHOW_INTERVAL = 0.25  # seconds between updates of the picture, longer where it is large:
SHOW_SHARE = 8  # so many times the time that an update takes
PREVIEW_SAMPLES = 16  # of the small pictures of materials


class PenumbraRenderEngine(bpy.types.RenderEngine):
    """Penumbra as one of Blender's render engines."""

    bl_idname = "PENUMBRA"
    bl_label = "Penumbra"
    bl_use_preview = True
    bl_use_eevee_viewport = True  # Material Preview, without lights of the scene
    bl_use_postprocess = True

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.viewport = None
        self.contexts = {}  # of view layers, by name

    def render(self, depsgraph):
        """Renders one view layer of one frame."""
        try:
            LayerRender(self, depsgraph).run()
        except (ProgramError, ValueError) as error:
            self.fail(str(error))
        except OSError as error:
            self.fail(disk_error_text(error))
        except Exception as error:  # Blender would print it, and take the render for done
            traceback.print_exc()
            self.fail(f"The scene cannot be rendered: {error!r}. The console tells where this happened.")

    def context_of(self, depsgraph, folder, texture_size):
        """The export's context. That of the frame before knows what stays, if Blender has kept its evaluation, too."""
        context = self.contexts.get(depsgraph.view_layer.name)
        known = (context.folder, context.depsgraph, context.texture_size) if context is not None else None
        if known != (folder, depsgraph, texture_size):
            context = Context(folder, depsgraph, texture_size,
                              frame_set=lambda frame, subframe: self.frame_set(frame, subframe=subframe))
            self.contexts[depsgraph.view_layer.name] = context
        context.report = Report()
        return context

    def fail(self, text):
        """An error in Blender's report. It ends an animation; so the picture of a material reports none."""
        if self.is_preview:
            print(f"Penumbra: {text}")
        else:
            self.report({"ERROR"}, text)

    def warn(self, text):
        """A warning that Blender shows once until the next render begins."""
        if text not in _told:
            _told.add(text)
            self.report({"WARNING"}, text)

    def update_render_passes(self, scene=None, renderlayer=None):
        """Tells the compositor which outputs a view layer has."""
        for entry in [passes.COMBINED, *passes.passes_of(renderlayer, settings_of(scene).denoise != "off")]:
            self.register_pass(scene, renderlayer, entry.name, len(entry.channels), entry.channels, entry.kind)

    def view_update(self, context, depsgraph):
        """The scene, or what shows it, has changed."""
        if self.viewport is None:
            self.viewport = preview.Viewport(self)
        self.viewport.update(context, depsgraph)

    def view_draw(self, context, depsgraph):
        """Draws the viewport."""
        if self.viewport is None:
            self.viewport = preview.Viewport(self)
        self.viewport.draw(context, depsgraph)

    def __del__(self):
        # By way of the dictionary, since Blender has invalidated the rest.
        viewport = object.__getattribute__(self, "__dict__").get("viewport")
        if viewport is not None:
            viewport.close()


_told = set()  # warnings since the last render began


def disk_error_text(error):
    """What an error of the file system means, and what to do."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return (f"The disk of Blender's temporary files is full ({error.filename or bpy.app.tempdir}). Free some "
                "space, or choose another folder: Edit > Preferences > File Paths > Temporary Files.")
    return f"The scene cannot be handed to the renderer: {error}."


_shared = None  # the folder of the render that is under way


def shared_folder():
    """Where frames of a shot are exported: its files by content are shared until the render ends."""
    global _shared
    if _shared is None:
        _shared = pathlib.Path(tempfile.mkdtemp(dir=bpy.app.tempdir or None, prefix="penumbra."))
    return _shared


def clear_shared_folder(*_):
    """Handler at the end of a render."""
    global _shared
    if _shared is not None:
        shutil.rmtree(_shared, ignore_errors=True)
    _shared = None


def forget_warnings(*_):
    """Handler at the beginning of a render."""
    _told.clear()


def window_of(render, width, height):
    """The part of the film that is rendered: (left, bottom, right, top), as Blender computes it."""
    if not render.use_border:
        return 0, 0, width, height
    share = np.float32([render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y])
    left, bottom, right, top = (share * np.float32([width, height, width, height])).astype(int).tolist()
    return left, bottom, max(right, left + 1), max(top, bottom + 1)


class LayerRender:
    """The render of one view layer of one frame."""

    def __init__(self, engine, depsgraph):
        self.engine = engine
        self.depsgraph = depsgraph
        self.scene = depsgraph.scene
        self.layer = depsgraph.view_layer
        self.settings = settings_of(self.scene)
        if self.scene.camera is None:
            raise ProgramError("The scene has no camera. Add one, or choose one in the properties of the scene.")
        width, height = engine.resolution_x, engine.resolution_y
        self.window = window_of(self.scene.render, width, height)
        left, bottom, right, top = self.window
        self.crop = (left, height - top, right, height - bottom)  # rows count downwards in files
        self.film = (width, height)
        if self.is_preview:
            self.settings = dataclasses.replace(self.settings, samples=PREVIEW_SAMPLES, denoise="off")
        is_denoised = self.settings.denoise != "off"
        self.passes = [] if self.is_preview else passes.passes_of(self.layer, is_denoised)

    def run(self):
        """Exports, renders, and hands the picture to Blender."""
        engine = self.engine
        engine.update_stats("", "Exporting the scene")
        shared = bpy.app.tempdir or None if self.is_preview else shared_folder()
        with tempfile.TemporaryDirectory(dir=shared, prefix="render.") as own:
            folder = pathlib.Path(own) if self.is_preview else shared
            context = engine.context_of(self.depsgraph, folder, self.settings.texture_size)
            context.is_stopped = self.is_stopped
            try:
                scene_file = export_scene(context, self.scene, pathlib.Path(own).name)
            except Stopped:
                engine.end_result(self.begin())  # Blender crashes where there is no picture to write
                return
            try:
                self.tell(context.report)
                if not self.is_stopped():
                    self.render(scene_file, pathlib.Path(own) / "image.exr")
            finally:
                scene_file.unlink(missing_ok=True)

    @property
    def is_preview(self):
        """Whether it is a small picture of a material, in its own small scene."""
        return self.engine.is_preview

    def is_stopped(self):
        """Whether the user has pressed Esc."""
        return self.engine.test_break()

    def tell(self, report):
        """Warns of what the picture will lack."""
        if self.is_preview:
            return
        for line in report.lines:
            self.engine.warn(f"Penumbra: {line}")
        for name in passes.missing_passes(self.layer):
            self.engine.warn(f'Penumbra: view layer "{self.layer.name}": the pass {name} is not rendered')
        if self.scene.render.use_multiview:
            self.engine.warn("Penumbra: the views of stereoscopy all show the scene's camera")

    def arguments(self, scene_file, image, stream):
        """Of `penumbra`."""
        return [
            "render", scene_file, "-o", image, "--quiet", "--progress", "json", "--tev", stream.address, "--crop",
            ",".join(map(str, self.crop)), "--checkpoint-interval", "0", *sampling_options(self.settings),
            *worker_options(self.settings), *FILM, *passes.options_for(self.passes),
        ]

    def begin(self):
        """The picture of this layer, which is empty."""
        left, bottom, right, top = self.window
        return self.engine.begin_result(0, 0, right - left, top - bottom, layer=self.layer.name)

    def render(self, scene_file, image):
        """Runs `penumbra`, showing tiles as they arrive."""
        left, bottom, right, top = self.window
        for entry in self.passes:
            self.engine.add_pass(entry.name, len(entry.channels), entry.channels, layer=self.layer.name)
        result = self.begin()
        stream = TileStream()
        process = None
        try:
            if (result.resolution_x, result.resolution_y) != (right - left, top - bottom):
                raise ProgramError(f"Blender renders {result.resolution_x} x {result.resolution_y} pixels where "
                                   f"{right - left} x {top - bottom} are expected.")
            process = Process(self.arguments(scene_file, image, stream))
            self.watch(process, stream, result)
            self.take(process, stream, result, image)
        finally:
            if process is not None:
                process.kill()
            stream.close()
            self.engine.end_result(result)

    def watch(self, process, stream, result):
        """Until the renderer ends, or the user stops it."""
        began = show_at = time.monotonic()
        shown = 0
        while not process.wait(POLL_INTERVAL):
            if self.is_stopped():
                process.stop(GRACE)
                return
            now = time.monotonic()
            if now < show_at:
                continue
            self.show_progress(process.progress, now - began)
            if stream.version != shown:
                shown = stream.version
                self.show_tiles(stream, result)
                self.engine.update_result(result)
            spent = time.monotonic() - now
            show_at = now + max(SHOW_INTERVAL, SHOW_SHARE * spent)

    def show_progress(self, progress, seconds):
        """On Blender's bar and over the picture."""
        total = progress.get("samples_total") or 0
        if not total:
            self.engine.update_stats("", "Starting the renderer")
            return
        share = progress["samples_done"] / total
        left = progress.get("seconds_left")
        budget = self.settings.time_budget
        if budget > 0:
            share = max(share, min(1.0, seconds / budget))
            left = min(left if left is not None else budget, max(0.0, budget - seconds))
        text = f"{share * 100:.0f} %"
        if left is not None:
            text = f"Remaining {bpy.utils.smpte_from_seconds(left, fps=1)[:-3]} | " + text
        if progress.get("relative_error") is not None:
            text += f" | Error {progress['relative_error'] * 100:.2g} %"
        self.engine.update_stats("", text)
        self.engine.update_progress(share)

    def show_tiles(self, stream, result):
        """Copies what has arrived into the result."""
        pixels = stream.image(self.crop)  # alpha arrives at the end
        if pixels is not None:
            fill(result.layers[0].passes["Combined"], pixels)

    def take(self, process, stream, result, image):
        """Fills the passes from the file, or from the tiles where there is none. Error: the renderer has failed."""
        is_stopped = self.is_stopped()
        code = process.code()
        if image.exists():
            self.fill_from(image, result)
        else:
            self.show_tiles(stream, result)
            if not is_stopped:
                raise ProgramError(process.failure())
        if code == 0 or is_stopped:
            return
        ended_by = ended_by_of(image)
        if ended_by != "time_budget":
            raise ProgramError("The picture is not complete. " + process.failure())

    def fill_from(self, path, result):
        """Fills the passes from the EXR, the combined one from the denoised EXR where there is one."""
        image = exr.read(path)
        denoised = path.with_name(path.stem + "-denoised" + path.suffix)
        layer = result.layers[0]
        fill(layer.passes["Combined"], passes.combined(exr.read(denoised) if denoised.exists() else image))
        for entry in self.passes:
            target = layer.passes.get(entry.name)
            values = entry.values(image)
            if values is None:
                self.engine.warn(f"Penumbra: the pass {entry.name} is empty, since this integrator does not make it")
            elif target is not None:
                fill(target, values)
        for key, value in passes.cryptomatte_metadata(image, self.layer.name).items():
            self.engine.get_result().stamp_data_add_field(key, value)


def ended_by_of(image):
    """Why the render of this image has ended, by its statistics."""
    try:
        return json.loads(image.with_suffix(".json").read_text())["ended_by"]
    except (OSError, ValueError, KeyError):
        return "failure"


def fill(target, values):
    """Copies (height, width, channels), whose rows go down, into a pass of Blender, whose rows go up."""
    if target.channels != values.shape[-1]:
        raise ValueError(f"the pass {target.name} has {target.channels} channels, not {values.shape[-1]}")
    target.rect.foreach_set(np.ascontiguousarray(values[::-1], np.float32).ravel())


_HANDLERS = [("render_init", forget_warnings), ("render_complete", clear_shared_folder),
             ("render_cancel", clear_shared_folder)]


def register():
    bpy.utils.register_class(PenumbraRenderEngine)
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(bpy.app.handlers.persistent(handler))


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    bpy.utils.unregister_class(PenumbraRenderEngine)
