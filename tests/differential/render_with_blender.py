"""Makes a scene in Blender, exports it as glTF and renders it with Cycles, for blender_test.

Arguments: folder, scene (metals, plastics, black_plane or grey_plane), batches, samples per pixel of a batch. The folder
then holds scene.glb and the images 0.exr, 1.exr, ... of other seeds.
"""

import math
import os
import sys

import bpy
from mathutils import Vector

folder, name, batches, spp = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
metallic = 1.0 if name == "metals" else 0.0
# Rough metals mask themselves by Smith's functions of both directions multiplied; Cycles has the joint one.
rough = 0.3 if name == "metals" else 0.6

bpy.ops.wm.read_factory_settings(use_empty=True)


def material(title, colour, roughness, emission=0.0):
    made = bpy.data.materials.new(title)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.distribution = "GGX"
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    if emission > 0:
        shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
        shader.inputs["Emission Color"].default_value = (*colour, 1)
        shader.inputs["Emission Strength"].default_value = emission
    return made


def chequers(shader_of):
    """The base colour is an image: by its texture coordinates, in sRGB."""
    image = bpy.data.images.new("chequers", 16, 16)
    image.pixels = [v for y in range(16) for x in range(16)
                    for v in ((0.9, 0.5, 0.2, 1) if (x // 4 + y // 8) % 2 else (0.3, 0.7, 0.9, 1))]
    image.pack()
    nodes = shader_of.node_tree
    texture = nodes.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Closest"  # between texels Cycles goes by sRGB, glTF by light
    nodes.links.new(texture.outputs["Color"], nodes.nodes["Principled BSDF"].inputs["Base Color"])


def give(made):
    bpy.context.object.data.materials.append(made)
    return made


plane = name.endswith("_plane")
bpy.ops.mesh.primitive_plane_add(size=10)
floor = give(material("floor", (0, 0, 0) if name == "black_plane" else (0.6, 0.6, 0.6), rough))
if not plane:
    chequers(floor)
if not plane:
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5), rotation=(0, 0, 0.4))
    give(material("cube", (0.8, 0.4, 0.2), rough))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=0.5, location=(1.3, -0.5, 0.5))
    bpy.ops.object.shade_smooth()
    give(material("sphere", (0.9, 0.8, 0.3), rough))
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(-1, 0, 2.5), rotation=(math.pi, 0.3, 0))
    give(material("area_light", (1, 0.8, 0.6), rough, 5.0))
bpy.ops.object.light_add(type="POINT", location=(2, -2, 3))
bpy.context.object.data.energy = 200
bpy.context.object.data.shadow_soft_size = 0
bpy.ops.object.camera_add(location=(3, -3, 3.5))
camera = bpy.context.object
camera.rotation_euler = (Vector((0, 0, 0.3)) - camera.location).to_track_quat("-Z", "Y").to_euler()
camera.data.angle = math.radians(40)

scene = bpy.context.scene
scene.camera = camera
scene.render.resolution_x, scene.render.resolution_y = 64, 48
bpy.ops.export_scene.gltf(filepath=os.path.join(folder, "scene.glb"), export_cameras=True, export_lights=True)

scene.render.engine = "CYCLES"
cycles = scene.cycles
cycles.samples = spp
cycles.use_denoising = cycles.use_adaptive_sampling = False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.light_sampling_threshold = 0
cycles.blur_glossy = 0
# Of metals direct light: what mirrors gather from a point shines on too few samples for a test of means.
bounces = 0 if name == "metals" or plane else 64
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
cycles.pixel_filter_type = "BOX"
scene.render.use_motion_blur = False
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_mode = "RGB"
scene.render.image_settings.color_depth = "32"
scene.view_settings.view_transform = "Standard"
for batch in range(batches):
    cycles.seed = batch
    scene.render.filepath = os.path.join(folder, f"{batch}.exr")
    bpy.ops.render.render(write_still=True)
sys.stdout.flush()
os._exit(0)  # what Blender does at its end may crash, with all written
