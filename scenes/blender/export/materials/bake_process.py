# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender of its own that bakes: the user's file, selection and undo stay as they are, also during a render.

It reads jobs from stdin, a JSON object on each line, and answers each with a line of JSON after MARK: {} or {"error": …}.
Started by bake.py. Jobs name a file with a material (`blend`, `material`), the input whose value is baked (`groups`: names
of group nodes, `node`, `socket`), the arrays of a mesh (`mesh`) or a rectangle of texture coordinates (`bounds`), `width`,
`height`, images whose pixels are in no file (`painted`: {name: path}) and where the values go (`to`); `unwrap` alone makes
texture coordinates for a mesh.
"""

import json
import sys
import traceback

import bpy
import numpy

MARK = "penumbra bake: "
GENERATED = "penumbra generated"
TARGET = "penumbra target"


def make_mesh(arrays):
    """The object of a mesh; arrays as in meshes_to_bake.py."""
    mesh = bpy.data.meshes.new("baked")
    mesh.vertices.add(len(arrays["positions"]))
    mesh.vertices.foreach_set("co", arrays["positions"].astype(numpy.float32).ravel())
    mesh.loops.add(len(arrays["corners"]))
    mesh.loops.foreach_set("vertex_index", arrays["corners"].astype(numpy.int32))
    mesh.polygons.add(len(arrays["starts"]))
    mesh.polygons.foreach_set("loop_start", arrays["starts"].astype(numpy.int32))
    mesh.update(calc_edges=True)
    for key in arrays.files:
        domain, _, rest = key.partition(" ")
        kind, _, name = rest.partition(" ")
        if domain not in {"POINT", "CORNER", "FACE"}:
            continue
        if kind == "FLOAT2" and domain == "CORNER":
            attribute = mesh.uv_layers.new(name=name, do_init=False)
            attribute.uv.foreach_set("vector", arrays[key].ravel())
            continue
        attribute = mesh.attributes.new(name, kind, domain)
        fields = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
        field = fields.get(kind, "value")
        attribute.data.foreach_set(field, arrays[key].ravel())
    if arrays["smooth"][0]:
        mesh.normals_split_custom_set(arrays["normals"].astype(float))
    else:
        mesh.polygons.foreach_set("use_smooth", numpy.zeros(len(mesh.polygons), bool))
    uv_map, colours = arrays["names"]
    if uv_map in mesh.uv_layers:
        mesh.uv_layers[uv_map].active_render = True
    if colours in mesh.color_attributes:
        mesh.color_attributes.render_color_index = mesh.color_attributes.find(colours)
    obj = bpy.data.objects.new(str(arrays["object"][0]), mesh)
    obj.matrix_world = arrays["matrix"].tolist()
    obj.color, obj.pass_index = arrays["colour"].tolist(), int(arrays["index"][0])
    return obj


def make_rectangle(bounds, uv_map):
    """A square whose UV map covers bounds: (least u, least v, most u, most v)."""
    mesh = bpy.data.meshes.new("baked")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    u0, v0, u1, v1 = bounds
    mesh.uv_layers.new(name=uv_map).uv.foreach_set("vector", [u0, v0, u1, v0, u1, v1, u0, v1])
    target = mesh.uv_layers.new(name=TARGET)
    target.uv.foreach_set("vector", [0, 0, 1, 0, 1, 1, 0, 1])
    return bpy.data.objects.new("baked", mesh)


def show(obj):
    """Makes it the only object of the scene, active and selected."""
    scene = bpy.context.scene
    for other in list(scene.collection.objects):
        scene.collection.objects.unlink(other)
    scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def unwrap(job):
    """Coordinates of loops without overlaps: (loops, 2)."""
    arrays = numpy.load(job["mesh"])
    obj = make_mesh(arrays)
    show(obj)
    mesh = obj.data
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    mesh.uv_layers.new(name=TARGET)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.15192, island_margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")
    uvs = numpy.empty(len(mesh.loops) * 2, numpy.float32)
    mesh.uv_layers[0].uv.foreach_get("vector", uvs)
    return uvs.reshape(-1, 2)


def find_input(node, identifier):
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def through_groups(material, job):
    """The output socket, in the material's own tree, of what feeds the job's input: groups get an output for it."""
    trees, nodes = [material.node_tree], []
    for name in job["groups"]:
        nodes.append(trees[-1].nodes[name])
        trees.append(nodes[-1].node_tree)
    socket = find_input(trees[-1].nodes[job["node"]], job["socket"])
    output = next(link for link in socket.links if link.is_valid and not link.is_muted).from_socket
    for tree, node in zip(reversed(trees[1:]), reversed(nodes)):
        made = tree.interface.new_socket(TARGET, in_out="OUTPUT", socket_type=type_of(output))
        end = next(each for each in tree.nodes if each.bl_idname == "NodeGroupOutput" and each.is_active_output)
        tree.links.new(output, find_input(end, made.identifier))
        output = next(each for each in node.outputs if each.identifier == made.identifier)
    return output


def type_of(socket):
    return {"VALUE": "NodeSocketFloat", "RGBA": "NodeSocketColor", "VECTOR": "NodeSocketVector",
            "SHADER": "NodeSocketShader"}.get(socket.type, "NodeSocketFloat")


def read_generated(tree, met):
    """Generated coordinates come from the attribute, which has those of the mesh before its modifiers."""
    if tree in met:
        return
    met.add(tree)
    for node in list(tree.nodes):
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
            read_generated(node.node_tree, met)
        vector = next((socket for socket in node.inputs if socket.identifier == "Vector"), None)
        needs = node.bl_idname.startswith("ShaderNodeTex") and node.bl_idname not in {
            "ShaderNodeTexImage", "ShaderNodeTexWhiteNoise", "ShaderNodeTexIES", "ShaderNodeTexSky"}
        generated = [link.to_socket for socket in node.outputs for link in list(socket.links)
                     if node.bl_idname == "ShaderNodeTexCoord" and socket.identifier == "Generated"]
        if needs and vector is not None and not vector.is_linked:
            generated.append(vector)
        for to in generated:
            made = tree.nodes.new("ShaderNodeAttribute")
            made.attribute_name = GENERATED
            tree.links.new(made.outputs["Vector"], to)


def show_displacement_as_bumps(material):
    """The surface stays where it is: a property of materials, before Blender 4.1 of Cycles."""
    (material if hasattr(material, "displacement_method") else material.cycles).displacement_method = "BUMP"


def bake(job):
    """The values: (height, width, 3) from the top row down. Of normals: in tangent space, in [0, 1]."""
    with bpy.data.libraries.load(job["blend"]) as (_, to):
        to.materials = [job["material"]]
    material = to.materials[0]
    for name, path in job["painted"].items():
        bpy.data.images[name].pixels.foreach_set(numpy.load(path))
        bpy.data.images[name].update()
    if "mesh" in job:
        obj = make_mesh(numpy.load(job["mesh"]))
        target = obj.data.uv_layers.new(name=TARGET, do_init=False)
        target.uv.foreach_set("vector", numpy.load(job["uvs"]).astype(numpy.float32).ravel())
    else:
        obj = make_rectangle(job["bounds"], job["uv_map"] or "UVMap")
    mesh = obj.data
    mesh.uv_layers.active_index = mesh.uv_layers.find(TARGET)
    show(obj)
    mesh.materials.clear()
    mesh.materials.append(material)
    tree = material.node_tree
    output = through_groups(material, job)
    if "mesh" in job:
        read_generated(tree, set())
    for node in [node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"]:
        tree.nodes.remove(node)
    end = tree.nodes.new("ShaderNodeOutputMaterial")
    if job["kind"] in {"NORMAL", "DISPLACEMENT"}:
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(output, shader.inputs["Normal"] if job["kind"] == "NORMAL" else end.inputs["Displacement"])
        show_displacement_as_bumps(material)
    else:
        shader = tree.nodes.new("ShaderNodeEmission")
        if job["is_number"]:
            number = tree.nodes.new("ShaderNodeMath")
            number.operation = "ADD"
            number.inputs[1].default_value = 0
            tree.links.new(output, number.inputs[0])
            output = number.outputs[0]
        # Emission is not negative: the values above 0, or those below.
        vector = tree.nodes.new("ShaderNodeVectorMath")
        vector.operation = "SCALE"
        vector.inputs["Scale"].default_value = job["sign"]
        tree.links.new(output, vector.inputs[0])
        above = tree.nodes.new("ShaderNodeVectorMath")
        above.operation = "MAXIMUM"
        above.inputs[1].default_value = (0, 0, 0)
        tree.links.new(vector.outputs[0], above.inputs[0])
        tree.links.new(above.outputs[0], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], end.inputs["Surface"])
    image = bpy.data.images.new("baked", job["width"], job["height"], float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    holder = tree.nodes.new("ShaderNodeTexImage")
    holder.image = image
    tree.nodes.active = holder
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.render.bake.margin = 0 if "bounds" in job else 8
    scene.frame_set(job["frame"])
    bpy.ops.object.bake(type="EMIT" if job["kind"] == "EMIT" else "NORMAL", margin=scene.render.bake.margin, use_clear=True)
    values = numpy.empty(job["width"] * job["height"] * 4, numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(job["height"], job["width"], 4)[::-1, :, :3]


def run(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if "unwrap" in job:
        result = unwrap(job)
    else:
        result = bake(job)
    with open(job["to"], "wb") as file:
        numpy.save(file, result)


def main():
    for line in sys.stdin:
        answer = {}
        try:
            run(json.loads(line))
        except Exception as error:  # the parent reports it
            traceback.print_exc()
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(MARK + json.dumps(answer), flush=True)


main()
