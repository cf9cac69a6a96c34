# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport: exports the scene when it changes, and renders what the viewport sees, first coarse, then finer.

Each view is a `penumbra render` of its own, which takes the camera from its options; so moving through a scene exports
nothing. Files by content stay, so a change writes only what has changed.
"""

import dataclasses
import math
import pathlib
import shutil
import tempfile

import bpy
import mathutils
import numpy as np

from .command import worker_options
from .export.context import Context, Report
from .export.scene import export_scene
from .program import Process, ProgramError
from .properties import settings_of
from .tile_stream import TileStream

POLL_INTERVAL = 0.1  # seconds between looks at the renderer
COARSE_SCALE = 4  # the first picture has so many times fewer pixels on a side
# Blender's cameras look along -z with x to the right; Penumbra's look along +z with x to the left.
TURN = mathutils.Matrix.Diagonal((-1, 1, -1, 1))


@dataclasses.dataclass(frozen=True)
class View:
    """What a viewport sees: pixels, and the matrices from camera to world and from camera to the viewport's clip space,
    as rows of numbers."""

    width: int
    height: int
    to_world: tuple
    projection: tuple

    @staticmethod
    def of(region, region_3d):
        return View(region.width, region.height, _rows(region_3d.view_matrix.inverted()),
                    _rows(region_3d.window_matrix))

    def options(self, scale):
        """Of `penumbra render`, for a film that is smaller by a factor."""
        width, height = max(1, self.width // scale), max(1, self.height // scale)
        projection = np.reshape(self.projection, (4, 4))
        to_world = mathutils.Matrix(np.reshape(self.to_world, (4, 4)).tolist())
        settings = {"film.width": width, "film.height": height, "film.crop_offset_x": 0, "film.crop_offset_y": 0,
                    "film.crop_width": width, "film.crop_height": height, "camera.shutter": 0}
        if projection[3, 3] == 0:
            # Clip coordinates are P00 x / -z - P02: the axis of view, x = 0, is at -P02 of -1 to 1. Offsets of the
            # principal point count to the left and up.
            settings |= {
                "camera.projection": "perspective",
                "camera.fov_axis": "x", "camera.fov": math.degrees(2 * math.atan(1 / projection[0, 0])),
                "camera.pixel_aspect": projection[0, 0] / projection[1, 1] * width / height,
                "camera.principal_point_offset_x": 0.5 * projection[0, 2],
                "camera.principal_point_offset_y": -0.5 * projection[1, 2],
            }
        else:
            centre = (-projection[0, 3] / projection[0, 0], -projection[1, 3] / projection[1, 1], 0)
            to_world = to_world @ mathutils.Matrix.Translation(centre)
            settings |= {"camera.projection": "orthographic", "camera.scale_x": 1 / projection[0, 0],
                         "camera.principal_point_offset_x": 0, "camera.principal_point_offset_y": 0}
        settings["camera.to_world"] = " ".join(map(repr, _rows(to_world @ TURN)))
        return [text for key, value in settings.items() for text in ("--set", f"{key}={value}")]


def _rows(matrix):
    return tuple(float(value) for row in matrix for value in row)


class _Stage:
    """One picture in the making."""

    def __init__(self, scene_file, view, scale, samples, options):
        self.view = view
        self.is_coarse = scale > 1
        self.stream = TileStream()
        self._folder = tempfile.TemporaryDirectory(dir=scene_file.parent, prefix="view.")
        try:
            self.process = Process(["render", scene_file, "-o", f"{self._folder.name}/view.png", "--quiet",
                                    "--progress", "json", "--no-statistics", "--no-features", "--checkpoint-interval",
                                    "0", "--tev", self.stream.address, "--spp", str(samples), "--pass", "1",
                                    *view.options(scale), *options])
        except ProgramError:
            self.stream.close()
            self._folder.cleanup()
            raise

    def close(self):
        self.process.kill()
        self.stream.close()
        self._folder.cleanup()


class Viewport:
    """What one viewport shows. Its state changes by update, draw and poll, all in Blender's main thread."""

    def __init__(self, engine):
        self._engine = engine
        self._folder = pathlib.Path(tempfile.mkdtemp(dir=bpy.app.tempdir or None, prefix="penumbra.viewport."))
        self._context = None  # of the export
        self._scene_file = None
        self._samples = 1
        self._options = []
        self._view = None  # the newest
        self._is_stale = False  # whether no stage has begun with the newest scene and view
        self._stage = None
        self._shown = 0  # version of the stage's picture that is in _picture
        self._picture = None  # (height, width, 4), rows go down
        self._texture = None
        self.problem = ""

    # --- What Blender says

    def update(self, context, depsgraph):
        """The scene has changed: exports it."""
        scene = depsgraph.scene
        settings = settings_of(scene)
        self._engine.update_stats("", "Exporting the scene")
        if self._context is None or self._context.texture_size != settings.texture_size:
            # The present instant alone: another frame would change what all of Blender shows.
            self._context = Context(self._folder, depsgraph, settings.texture_size, frame_set=lambda *_: None)
        self._context.depsgraph = depsgraph
        self._context.report = Report()
        try:
            self._scene_file = export_scene(self._context, scene, "viewport")
        except (OSError, ValueError) as error:
            return self._fail(str(error))
        for line in self._context.report.lines:
            self._engine.report({"INFO"}, f"Penumbra: {line}")
        self._samples = settings.preview_samples
        self._options = ["--seed", str(settings.seed), *worker_options(settings)]
        self._is_stale = True
        if self._stage is not None and not self._stage.is_coarse:
            self._replace(None)
        self.look(View.of(context.region, context.region_data))

    def draw(self, context, _depsgraph):
        """Draws the newest picture, scaled to the viewport."""
        import gpu
        from gpu_extras.presets import draw_texture_2d

        self.look(View.of(context.region, context.region_data))
        if self._picture is None:
            return
        if self._texture is None:
            height, width = self._picture.shape[:2]
            pixels = np.ascontiguousarray(self._picture[::-1], np.float32).ravel()
            self._texture = gpu.types.GPUTexture((width, height), format="RGBA16F",
                                                 data=gpu.types.Buffer("FLOAT", len(pixels), pixels))
        gpu.state.blend_set("ALPHA_PREMULT")
        self._engine.bind_display_space_shader(context.scene)
        draw_texture_2d(self._texture, (0, 0), context.region.width, context.region.height)
        self._engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")

    # --- What follows from it

    def look(self, view):
        """The viewport sees this. A coarse picture of a view before is finished first: moving shows something."""
        if view != self._view:
            self._view = view
            self._is_stale = True
            if self._stage is not None and not self._stage.is_coarse:
                self._replace(None)
        self.poll()
        if not bpy.app.background and not bpy.app.timers.is_registered(self._tick):
            bpy.app.timers.register(self._tick, first_interval=POLL_INTERVAL)

    def poll(self):
        """Takes what has arrived, and begins what is next. Returns whether there is more to come."""
        stage = self._stage
        if stage is not None:
            code = stage.process.code()
            if code == 0:
                stage.stream.drain()
            self._take(stage)
            if code is not None:
                self._replace(None)
                if code != 0:
                    self._fail(stage.process.failure())
                elif stage.is_coarse and not self._is_stale:
                    self._begin(1, self._samples)
        if self._stage is None and self._is_stale and self._scene_file is not None:
            self._is_stale = False
            self.problem = ""
            self._begin(COARSE_SCALE, 1)
        return self._stage is not None

    @property
    def picture(self):
        """(height, width, 4), rows go down; None before the first."""
        return self._picture

    def close(self):
        """Ends the renderer, and removes the files."""
        if bpy.app.timers.is_registered(self._tick):
            bpy.app.timers.unregister(self._tick)
        self._replace(None)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _tick(self):
        try:
            return POLL_INTERVAL if self.poll() else None
        except ReferenceError:  # Blender has removed the engine
            self.close()
            return None

    def _begin(self, scale, samples):
        try:
            self._replace(_Stage(self._scene_file, self._view, scale, samples, self._options))
        except ProgramError as error:
            self._fail(str(error))

    def _replace(self, stage):
        """Ends the present stage; this one takes its place."""
        if self._stage is not None:
            self._stage.close()
        self._stage = stage
        self._shown = 0

    def _take(self, stage):
        """Makes the stage's image the picture; where it has no tiles yet, the picture before shows."""
        version = stage.stream.version
        if version == self._shown:
            return
        self._shown = version
        background = None if stage.is_coarse else self._picture
        self._picture = stage.stream.image_over(background)
        self._texture = None
        self._engine.update_stats("", "Coarse" if stage.is_coarse else self._progress_text(stage))
        self._engine.tag_redraw()

    def _progress_text(self, stage):
        progress = stage.process.progress
        total = progress.get("samples_total") or 0
        return f"{progress['samples_done'] / total * 100:.0f} % of {self._samples} samples" if total else ""

    def _fail(self, text):
        self.problem = text
        self._engine.update_stats("Penumbra", text.splitlines()[0])
        self._engine.report({"WARNING"}, text)
