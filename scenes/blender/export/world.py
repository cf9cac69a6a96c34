# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world as an environment: a constant, an image, or an image that Cycles renders of it."""

import os
import pathlib
import subprocess
import tempfile

import bpy
import mathutils

from .context import own_blender
from .elements import add_matrix, add_value, plugin
from .node_text import tree_text

# Environment maps have y up, and -z at their left and right edges; Blender's have z up and -x there.
_TURN = mathutils.Matrix(((0, 0, 1, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
_BAKED_WIDTH = 2048  # pixels: the sun is three of them wide
_BAKED_SAMPLES = 16
_BAKING = 2  # another number for another way, so that old files are not taken for new ones
_LARGEST_WIDTH = 8192
_LINEAR = {"Linear Rec.709", "Linear", "Non-Color"}


def _source(socket):
    """The socket that is linked to the input, without reroutes; None: it has a value of its own."""
    while socket.is_linked:
        source = socket.links[0].from_socket
        if source.node.type != "REROUTE":
            return source
        socket = source.node.inputs[0]
    return None


def _rotation(texture):
    """From directions to those that the image is looked up by: a 3 × 3 matrix, or None if it is no rotation."""
    source = _source(texture.inputs["Vector"])
    if source is None or (source.node.type == "TEX_COORD" and source.name == "Generated"):
        return mathutils.Matrix.Identity(3)
    node = source.node
    if node.type != "MAPPING" or node.vector_type not in {"POINT", "TEXTURE", "VECTOR"}:
        return None
    inner = _source(node.inputs["Vector"])
    if inner is None or inner.node.type != "TEX_COORD" or inner.name != "Generated":
        return None
    if any(_source(socket) is not None for socket in node.inputs[1:] if socket.enabled):
        return None
    if node.vector_type != "VECTOR" and any(node.inputs["Location"].default_value):
        return None
    if any(abs(scale - 1) > 1e-6 for scale in node.inputs["Scale"].default_value):
        return None
    rotation = node.inputs["Rotation"].default_value.to_matrix()
    return rotation.transposed() if node.vector_type == "TEXTURE" else rotation


def _image_file(image):
    """The file of an image that is read as Blender reads it, or None."""
    if image is None or image.source != "FILE" or image.packed_file is not None or image.is_dirty:
        return None
    path = bpy.path.abspath(image.filepath, library=image.library)
    if not path.lower().endswith((".exr", ".hdr")) or image.colorspace_settings.name not in _LINEAR:
        return None
    return os.path.abspath(path) if os.path.isfile(path) else None


def _map(path, scale, rotation):
    emitter = plugin("emitter", "envmap")
    add_value(emitter, "string", "filename", path)
    if scale != 1:
        add_value(emitter, "float", "scale", scale)
    add_matrix(emitter, rotation.transposed().to_4x4() @ _TURN)
    return emitter


def _constant(colour):
    if not any(colour):
        return []
    emitter = plugin("emitter", "constant")
    add_value(emitter, "rgb", "radiance", colour)
    return [emitter]


def _baked(context, world, width):
    """The path of an image of the world, which another Blender renders."""
    original = world.original
    frame = context.depsgraph.scene.frame_current

    def write(path):
        with tempfile.TemporaryDirectory() as folder:
            blend = os.path.join(folder, "world.blend")
            bpy.data.libraries.write(blend, {original}, path_remap="ABSOLUTE", fake_user=True)
            command = [*own_blender(pathlib.Path(__file__).with_name("bake_world.py")),
                       "--", blend, original.name, str(frame), str(width), str(_BAKED_SAMPLES), str(path)]
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if done.returncode != 0 or not path.exists():
                raise RuntimeError(f'the world "{original.name}" could not be baked:\n{done.stdout[-2000:]}')

    key = repr((tree_text(world.node_tree), width, _BAKED_SAMPLES, _BAKING, bpy.app.version[:2]))
    return context.file("worlds", ".exr", key.encode(), write)


def _background(context, world):
    output = world.node_tree.get_output_node("CYCLES")
    if output is None:
        return []
    surface = _source(output.inputs["Surface"])
    if surface is None:
        return []
    width = _BAKED_WIDTH
    if surface.node.type == "BACKGROUND":
        colour, strength = surface.node.inputs["Color"], surface.node.inputs["Strength"]
        source = _source(colour)
        if _source(strength) is None:
            if strength.default_value == 0:
                return []
            if source is None:
                return _constant([strength.default_value * channel for channel in colour.default_value[:3]])
            if source.node.type == "TEX_ENVIRONMENT" and source.node.projection == "EQUIRECTANGULAR":
                path, rotation = _image_file(source.node.image), _rotation(source.node)
                if path is not None and rotation is not None and strength.default_value > 0:
                    return [_map(path, strength.default_value, rotation)]
    for node in world.node_tree.nodes:
        if node.type == "TEX_ENVIRONMENT" and node.image is not None:
            width = max(width, min(node.image.size[0], _LARGEST_WIDTH))
    return [_map(_baked(context, world, width), 1, mathutils.Matrix.Identity(3))]


def shown_world(context):
    """The evaluated world, or None."""
    return getattr(context.depsgraph.view_layer_eval, "world_override", None) or context.depsgraph.scene.world


def export_world(context, world):
    """The elements of the evaluated world, which may be None: a list."""
    if world is None:
        return []
    visibility = getattr(world, "cycles_visibility", None)
    hidden = [ray for ray in ("camera", "diffuse", "glossy", "transmission", "scatter")
              if not getattr(visibility, ray, True)]
    if hidden:
        context.report.add(f"the world is invisible to {', '.join(hidden)} rays, but exported as visible", world.name)
    if world.node_tree is None or (bpy.app.version < (5, 0) and not world.use_nodes):  # Blender 5 always has nodes
        return _constant(list(world.color))
    return _background(context, world)
