# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a world by Cycles to an equirectangular image. Runs in a Blender of its own.

Arguments: .blend file, name of the world in it, frame, width and samples per pixel, EXR file.
"""

import math
import os
import pathlib
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from exr_writer import exr_bytes  # noqa: E402

# The brightest pixel and so many around it have more samples, if it is so much brighter than the mean: they are a sun,
# whose edge crosses pixels.
_AROUND, _SUN, _MORE = 12, 100, 256


def scene_of(blend, name, frame, width):
    """A scene that shows the world as the Environment Texture node shows images: x is in the middle, z at the top."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(blend) as (_, loaded):
        loaded.worlds = [name]
    scene = bpy.context.scene
    scene.world = loaded.worlds[0]
    scene.frame_set(frame)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    camera.data.type = "PANO"
    scene.collection.objects.link(camera)
    scene.camera = camera
    (camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles).panorama_type = "EQUIRECTANGULAR"
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
    cycles = scene.cycles
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = 0
    cycles.pixel_filter_type = "BOX"
    settings = render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "32", "NONE"
    return scene


def rendered(scene, samples):
    """(height, width, 3), the first row at the bottom."""
    scene.cycles.samples = samples
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "world.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = numpy.empty(len(image.pixels), numpy.float32)
        image.pixels.foreach_get(pixels)
        width, height = image.size
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)[:, :, :3]


def bake(blend, name, frame, width, samples, path):
    scene = scene_of(blend, name, frame, width)
    pixels = rendered(scene, samples)
    height = width // 2
    brightness = pixels.mean(axis=2)
    y, x = numpy.unravel_index(brightness.argmax(), brightness.shape)
    if brightness[y, x] > _SUN * brightness.mean():
        left, right = max(x - _AROUND, 0), min(x + _AROUND, width)
        low, high = max(y - _AROUND, 0), min(y + _AROUND, height)
        render = scene.render
        render.use_border = render.use_crop_to_border = True
        # Blender rounds down.
        render.border_min_x, render.border_max_x = (left + 0.5) / width, (right + 0.5) / width
        render.border_min_y, render.border_max_y = (low + 0.5) / height, (high + 0.5) / height
        pixels[low:high, left:right] = rendered(scene, samples * _MORE)
    pathlib.Path(path).write_bytes(exr_bytes(pixels[::-1]))


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1:]
    bake(given[0], given[1], int(given[2]), int(given[3]), int(given[4]), given[5])
    sys.stdout.flush()
    os._exit(0)  # what Blender does at its end may crash, with all written
