# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a world by Cycles to an equirectangular image. Runs in a Blender of its own.

Arguments: .blend file, name of the world in it, frame, width and samples per pixel, EXR file.
"""

import math
import os
import sys

import bpy


def bake(blend, name, frame, width, samples, image):
    """The image is as the Environment Texture node shows it: its middle is the direction x, its top is z."""
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
    cycles.samples = samples
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = 0
    cycles.pixel_filter_type = "BOX"
    settings = render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = "OPEN_EXR", "RGB", "32", "ZIP"
    render.filepath = image
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1:]
    bake(given[0], given[1], int(given[2]), int(given[3]), int(given[4]), given[5])
    sys.stdout.flush()
    os._exit(0)  # what Blender does at its end may crash, with all written
