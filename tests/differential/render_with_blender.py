"""Makes scenes in Blender, exports them as glTF and renders them with Cycles, for blender_test.

Arguments: folder, scenes, batches, samples per pixel of a batch. Scenes are plastics or a JSON array with an
object for each: the inputs of the Principled BSDF of a sphere and a plane. Beside them, "Tangent" gives the tangent by
texture coordinates, "Thickness" makes glTF's material solid, "Normal Strength" adds a normal map. The folder then holds
0.glb, 1.glb, ... and for each of them images 0.0.exr, 0.1.exr, ... of other seeds.
"""

import json
import math
import os
import sys

import bpy
from mathutils import Vector

folder, argument, batches, spp = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
scenes = json.loads(argument) if argument.startswith("[") else [argument]


def material(title, inputs, emission=0.0):
    made = bpy.data.materials.new(title)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.distribution = "MULTI_GGX"
    for name, value in inputs.items():
        shader.inputs[name].default_value = value
    if emission > 0:
        shader.inputs["Emission Color"].default_value = shader.inputs["Base Color"].default_value
        shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
        shader.inputs["Emission Strength"].default_value = emission
    return made


def image_node(made, title, pixel, size=16, data=False):
    """An image of size by size pixels of colours pixel(x, y)."""
    image = bpy.data.images.new(title, size, size)
    if data:
        image.colorspace_settings.name = "Non-Color"
    image.pixels = [v for y in range(size) for x in range(size) for v in (*pixel(x, y), 1)]
    image.pack()
    texture = made.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Closest"  # between texels Cycles goes by sRGB, glTF by light
    return texture


def chequers(made):
    """The base colour is an image: by its texture coordinates, in sRGB."""
    texture = image_node(made, "chequers", lambda x, y: (0.9, 0.5, 0.2) if (x // 4 + y // 8) % 2 else (0.3, 0.7, 0.9))
    made.node_tree.links.new(texture.outputs["Color"], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])


def bumps(made, strength):
    """Normals of four slopes, 30 degrees each."""
    def normal(x, y):
        angle = math.pi / 2 * ((x // 2 + 2 * (y // 2)) % 4)
        return 0.5 + 0.25 * math.cos(angle), 0.5 + 0.25 * math.sin(angle), 0.5 + 0.25 * math.sqrt(3)
    nodes = made.node_tree
    bent = nodes.nodes.new("ShaderNodeNormalMap")
    bent.inputs["Strength"].default_value = strength
    nodes.links.new(image_node(made, "normals", normal, data=True).outputs["Color"], bent.inputs["Color"])
    nodes.links.new(bent.outputs["Normal"], nodes.nodes["Principled BSDF"].inputs["Normal"])


def tangent_by_uv(made):
    """Cycles' tangents are by position else, which glTF does not know."""
    nodes = made.node_tree
    tangent = nodes.nodes.new("ShaderNodeTangent")
    tangent.direction_type = "UV_MAP"
    nodes.links.new(tangent.outputs["Tangent"], nodes.nodes["Principled BSDF"].inputs["Tangent"])


def solid(made, thickness):
    """The exporter reads the thickness from a node group of this name; without it what transmits is thin."""
    title = "glTF Material Output"
    group = bpy.data.node_groups.get(title)
    if group is None:
        group = bpy.data.node_groups.new(title, "ShaderNodeTree")
        group.interface.new_socket("Thickness", socket_type="NodeSocketFloat")
    node = made.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs["Thickness"].default_value = thickness


def give(made):
    bpy.context.object.data.materials.append(made)
    return made


def look(place, at, angle):
    bpy.ops.object.camera_add(location=place)
    camera = bpy.context.object
    camera.rotation_euler = (Vector(at) - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.angle = angle
    bpy.context.scene.camera = camera


def plastics_under_lights():
    def principled(colour):
        return {"Base Color": (*colour, 1), "Roughness": 0.6}
    bpy.ops.mesh.primitive_plane_add(size=10)
    chequers(give(material("floor", principled((0.6, 0.6, 0.6)))))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5), rotation=(0, 0, 0.4))
    give(material("cube", principled((0.8, 0.4, 0.2))))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=0.5, location=(1.3, -0.5, 0.5))
    bpy.ops.object.shade_smooth()
    give(material("sphere", principled((0.9, 0.8, 0.3))))
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(-1, 0, 2.5), rotation=(math.pi, 0.3, 0))
    give(material("area_light", principled((1, 0.8, 0.6)), 5.0))
    bpy.ops.object.light_add(type="POINT", location=(2, -2, 3))
    bpy.context.object.data.energy = 200
    bpy.context.object.data.shadow_soft_size = 0
    look((3, -3, 3.5), (0, 0, 0.3), math.radians(40))


def sphere_and_plane(inputs):
    """Left a sphere of radius 1, right a plane of 2 by 2 that leans by 60 degrees, both 8 away, within 4.8 by 2.4. A
    bright square and a dim cube around all of them are the light."""
    inputs = dict(inputs)
    strength, thickness = inputs.pop("Normal Strength", None), inputs.pop("Thickness", 0.0)
    tangent = inputs.pop("Tangent", None)
    made = material("both", {"Base Color": (0.6, 0.4, 0.25, 1), "Roughness": 0.4} | inputs)
    if strength is not None:
        bumps(made, strength)
    if tangent:
        tangent_by_uv(made)
    if thickness > 0:
        solid(made, thickness)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(-1.2, 0, 0))
    bpy.ops.object.shade_smooth()
    give(made)
    bpy.ops.mesh.primitive_plane_add(size=2, location=(1.2, 0, 0), rotation=(math.radians(60), 0, 0))
    give(made)
    black = {"Base Color": (1, 1, 1, 1), "Roughness": 1.0, "Specular IOR Level": 0}
    bpy.ops.mesh.primitive_cube_add(size=24)
    give(material("room", black, 0.15))
    bpy.ops.mesh.primitive_plane_add(size=4, location=(-2, -3, 5), rotation=(math.radians(30), math.radians(-20), 0))
    give(material("light", black, 5.0))
    look((0, -8, 0), (0, 0, 0), 2 * math.atan(2.4 / 8))


def render(number, kind):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 64, 48 if isinstance(kind, str) else 32
    bpy.ops.export_scene.gltf(filepath=os.path.join(folder, f"{number}.glb"), export_cameras=True, export_lights=True)
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = spp
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 64
    cycles.transparent_max_bounces = 64
    cycles.pixel_filter_type = "BOX"
    scene.render.use_motion_blur = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Standard"
    for batch in range(batches):
        cycles.seed = batch
        scene.render.filepath = os.path.join(folder, f"{number}.{batch}.exr")
        bpy.ops.render.render(write_still=True)


for number, kind in enumerate(scenes):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    plastics_under_lights() if isinstance(kind, str) else sphere_and_plane(kind)
    render(number, kind)
sys.stdout.flush()
os._exit(0)  # what Blender does at its end may crash, with all written
