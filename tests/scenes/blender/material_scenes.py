"""Scenes of one material each: it is on a sphere above a plane, below a square light, in a coloured world."""

import pathlib
import sys

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from cycles_comparison import add_camera, empty_scene, set_world  # noqa: E402


def material(name, bl_idname=None, values=None, **properties):
    """A new material with one shader: the Principled BSDF or a node of that name; values: {input: value}."""
    made = bpy.data.materials.new(name)
    if hasattr(made, "use_nodes"):
        made.use_nodes = True
    tree = made.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    if bl_idname is not None:
        tree.nodes.remove(shader)
        shader = tree.nodes.new(bl_idname)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    for key, value in properties.items():
        setattr(shader, key, value)
    set_inputs(shader, values or {})
    return made, shader, output


def set_inputs(node, values):
    """Sets values of inputs by name or identifier; colours may have three channels."""
    for name, value in values.items():
        socket = next(each for each in node.inputs if name in {each.name, each.identifier} and each.enabled)
        socket.default_value = (*value, 1.0) if socket.type == "RGBA" and len(value) == 3 else value


def add_node(made, bl_idname, values=None, **properties):
    """A new node of a material."""
    node = made.node_tree.nodes.new(bl_idname)
    for key, value in properties.items():
        setattr(node, key, value)
    set_inputs(node, values or {})
    return node


def link(made, output, to):
    made.node_tree.links.new(output, to)


def add_shape(make, made, **placement):
    """An object of a mesh operator with a material."""
    make(**placement)
    obj = bpy.context.object
    obj.data.materials.append(made)
    return obj


def stage(made, width=48, height=36):
    """The scene with the material on the sphere. Returns (scene, sphere)."""
    scene = empty_scene(width, height)
    return scene, fill(scene, made())


def fill(scene, made):
    """Adds camera, world, plane, light and the sphere of the material."""
    set_world(scene, (0.3, 0.35, 0.45))
    add_camera(scene, (0, -5, 2.2), (0, 0, 0.9), 35)
    floor, _, _ = material("floor", "ShaderNodeBsdfDiffuse", {"Color": (0.4, 0.4, 0.4)})
    lamp, _, _ = material("lamp", "ShaderNodeEmission", {"Color": (1.0, 0.9, 0.8), "Strength": 3.0})
    add_shape(bpy.ops.mesh.primitive_plane_add, floor, size=8)
    add_shape(bpy.ops.mesh.primitive_plane_add, lamp, size=3, location=(1.5, -1.5, 4), rotation=(0.5, 0.4, 0))
    sphere = add_shape(bpy.ops.mesh.primitive_uv_sphere_add, made, segments=64, ring_count=32, radius=0.9,
                       location=(0, 0, 0.9))
    bpy.ops.object.shade_smooth()
    return sphere


def picture(size=256, seed=1, smooth=True, colourspace="sRGB", alpha=False):
    """A generated image of smooth random colours (rows of texels change slowly), or of noise."""
    rng = numpy.random.default_rng(seed)
    x = (numpy.arange(size) + 0.5) / size * 2 * numpy.pi
    texels = numpy.ones((size, size, 4), numpy.float32)
    for channel in range(4 if alpha else 3):
        a, b = rng.integers(1, 4, 2)
        texels[..., channel] = 0.5 + 0.4 * numpy.sin(a * x[None, :] + channel) * numpy.cos(b * x[:, None] + seed)
    image = bpy.data.images.new(f"picture {seed}", size, size, alpha=alpha)
    image.colorspace_settings.name = colourspace
    image.pixels.foreach_set(texels.ravel())
    image.update()
    return image
