"""Renders scenes of bpy by Cycles, and by the penumbra program from their export.

PENUMBRA_PROGRAM names the program; without it, it is sought in PATH. Runs in a Python with bpy.
"""

import dataclasses
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import bpy
import mathutils
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scenes"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from blender import exr  # noqa: E402
from blender.export.shot import export_shot  # noqa: E402


def program():
    """The path of the penumbra program, or None."""
    return os.environ.get("PENUMBRA_PROGRAM") or shutil.which("penumbra")


def empty_scene(width=32, height=24, spp=64):
    """A new file without objects and with a black world. Cycles is set up without bias: no clamping, no denoising, 64
    bounces, a box filter."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    cycles = scene.cycles
    cycles.samples = spp
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", 64)
    cycles.pixel_filter_type = "BOX"
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    scene.world = world
    set_world(scene, (0, 0, 0))
    return scene


def set_world(scene, colour, strength=1.0):
    """A world of one colour."""
    background = next(node for node in scene.world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*colour, 1)
    background.inputs["Strength"].default_value = strength


def add_camera(scene, location, target, angle=40.0):
    """A camera at a location that looks at the target; angle: of the larger side, degrees."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = location
    camera.rotation_euler = (mathutils.Vector(target) - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.angle = math.radians(angle)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def cycles_image(scene, seed=0):
    """The current frame by Cycles: (height, width, 3), linear."""
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR"
    settings.color_mode = "RGB"
    settings.color_depth = "32"
    settings.exr_codec = "NONE"
    scene.cycles.seed = seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "cycles.exr")
        bpy.ops.render.render(write_still=True)
        return exr.read(scene.render.filepath).stack("RGB")


def rendered(path, spp=64, seed=0, settings=None):
    """The picture of a scene file by penumbra: (height, width, 3). settings: {key: value} of --set."""
    with tempfile.TemporaryDirectory() as folder:
        image = os.path.join(folder, "penumbra.exr")
        command = [program(), "render", str(path), "--quiet", "--threads", "2", "--spp", str(spp), "--seed", str(seed),
                   "-o", image]
        for key, value in {"film.compression": "none", **(settings or {})}.items():
            command += ["--set", f"{key}={value}"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}\n{done.stdout}")
        return exr.read(image).stack("RGB")


def penumbra_image(scene, spp=64, seed=0, folder=None, settings=None):
    """The current frame by penumbra, see rendered, and the export's Report.

    folder: of the exported files, which are kept; without it they are removed.
    """
    with tempfile.TemporaryDirectory() as temporary:
        paths, report = export_shot(folder or temporary, scene, [scene.frame_current])
        return rendered(paths[0], spp, seed, settings), report


@dataclasses.dataclass
class Mean:
    """The mean of renders with several seeds. error: standard error of the image's mean, per channel. pixel_error: mean
    standard error of a pixel's channel. seconds: of all renders."""
    image: numpy.ndarray
    error: numpy.ndarray
    pixel_error: float
    seconds: float


@dataclasses.dataclass
class Comparison:
    """Both programs' pictures of a scene, and the Report of the export."""
    cycles: Mean
    penumbra: Mean
    report: object


def _mean(render, batches):
    """render(seed) gives the picture of a batch."""
    start = time.monotonic()
    images = [render(seed) for seed in range(batches)]
    seconds = time.monotonic() - start
    root = len(images) ** 0.5
    means = numpy.array([image.mean(axis=(0, 1), dtype=float) for image in images])
    return Mean(numpy.mean(images, axis=0, dtype=float), means.std(axis=0, ddof=1) / root,
                float(numpy.std(images, axis=0, ddof=1, dtype=float).mean() / root), seconds)


def compare(scene, spp=64, cycles_spp=None, batches=4, settings=None):
    """Renders the current frame with both programs, with spp samples in all of several seeds."""
    scene.cycles.samples = max(1, (cycles_spp or spp) // batches)
    theirs = _mean(lambda seed: cycles_image(scene, seed), batches)
    with tempfile.TemporaryDirectory() as folder:
        paths, report = export_shot(folder, scene, [scene.frame_current])
        ours = _mean(lambda seed: rendered(paths[0], max(1, spp // batches), seed, settings), batches)
    return Comparison(theirs, ours, report)
