# SPDX-License-Identifier: GPL-3.0-or-later
"""What the value of a socket depends on, and a fingerprint of all that determines it."""

import hashlib

import bpy
import numpy

from .coordinates import render_uv_map
from .nodes import Input, source_of

# Of a surface as it is met by a ray, or of what a bake does not know. None: all outputs.
_VIEW = {"ShaderNodeLightPath": None, "ShaderNodeCameraData": None, "ShaderNodeFresnel": None,
         "ShaderNodeLayerWeight": None, "ShaderNodeNewGeometry": {"Incoming", "Backfacing"},
         "ShaderNodeTexCoord": {"Camera", "Window", "Reflection"}, "ShaderNodeParticleInfo": None,
         "ShaderNodeHairInfo": None, "ShaderNodePointInfo": None, "ShaderNodeVolumeInfo": None}
# Of the place on the mesh.
_MESH = {"ShaderNodeNewGeometry", "ShaderNodeVertexColor", "ShaderNodeAttribute", "ShaderNodeObjectInfo", "ShaderNodeBump",
         "ShaderNodeNormalMap", "ShaderNodeBevel", "ShaderNodeAmbientOcclusion", "ShaderNodeWireframe",
         "ShaderNodeTangent", "ShaderNodeDisplacement", "ShaderNodeVectorDisplacement", "ShaderNodeTexEnvironment",
         "ShaderNodeVectorTransform"}
# Textures that take generated coordinates where nothing is linked.
_GENERATED = {"ShaderNodeTexBrick", "ShaderNodeTexChecker", "ShaderNodeTexGradient", "ShaderNodeTexMagic",
              "ShaderNodeTexMusgrave", "ShaderNodeTexNoise", "ShaderNodeTexPointDensity", "ShaderNodeTexVoronoi",
              "ShaderNodeTexWave", "ShaderNodeTexGabor"}
# Of the object and its place, not only of its mesh. None: all outputs.
_OBJECT = {"ShaderNodeObjectInfo": None, "ShaderNodeVectorTransform": None,
           "ShaderNodeNewGeometry": {"Position", "Normal", "Tangent", "True Normal"}, "ShaderNodeTexCoord": {"Normal"}}


def is_of_object(tree, met=()):
    """Whether values of a node tree may differ between objects that have the same mesh."""
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and node.node_tree not in met:
            if is_of_object(node.node_tree, (*met, tree)):
                return True
        if node.bl_idname in _OBJECT and any(socket.is_linked and socket.identifier in (_OBJECT[node.bl_idname] or {
                socket.identifier}) for socket in node.outputs):
            return True
        if getattr(node, "object", None) is not None and any(socket.is_linked for socket in node.outputs):
            return True
    return False


class Dependencies:
    """uv_maps: names (the active one by its name). needs_mesh: the place on the mesh. view: nodes that depend on the ray.
    nodes: all (node, groups) that take part."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.uv_maps, self.needs_mesh, self.view, self.nodes = set(), False, [], []
        self._met = set()

    def add(self, at):
        """Adds what an input depends on."""
        source = source_of(at)
        if source is None or source.is_constant:
            return
        node, output = source.node, source.socket.identifier
        kind = node.bl_idname
        if kind in _VIEW and (_VIEW[kind] is None or output in _VIEW[kind]):
            if node not in self.view:
                self.view.append(node)
        elif kind in _MESH:
            self.needs_mesh = True
        elif kind == "ShaderNodeTexCoord":
            if output == "UV":
                self.uv_maps.add(render_uv_map(self.mesh))
            else:
                self.needs_mesh = True
        elif kind == "ShaderNodeUVMap":
            self.uv_maps.add(node.uv_map or render_uv_map(self.mesh))
        key = (node.as_pointer(), tuple(group.as_pointer() for group in source.groups))
        if key in self._met:
            return
        self._met.add(key)
        self.nodes.append((node, source.groups))
        vector = next((socket for socket in node.inputs if socket.identifier == "Vector"), None)
        if vector is not None and not vector.is_linked:
            if kind in _GENERATED and vector.enabled:
                self.needs_mesh = True
            elif kind == "ShaderNodeTexImage":
                self.uv_maps.add(render_uv_map(self.mesh))
        if kind == "ShaderNodeTexImage" and node.projection == "BOX":
            self.needs_mesh = True
        for socket in node.inputs:
            self.add(Input(socket, source.groups))


def fingerprint(at, dependencies):
    """Bytes that are the same where the nodes that an input depends on are."""
    digest = hashlib.sha256()
    digest.update(repr((bpy.app.version, at.socket.identifier, at.socket.type, at.node.name,
                        [group.name for group in at.groups], _links(at.socket))).encode())
    for node, groups in dependencies.nodes:
        digest.update(repr([group.name for group in groups]).encode())
        digest.update(repr(_content(node, 0)).encode())
        for socket in [*node.inputs, *(group for each in groups for group in each.inputs)]:
            digest.update(repr((socket.identifier, _links(socket), _plain(getattr(socket, "default_value", None)))).encode())
        for socket in node.outputs:
            digest.update(repr(_plain(getattr(socket, "default_value", None))).encode())
    return digest.digest()


def _links(socket):
    return [(link.from_node.name, link.from_socket.identifier, link.is_muted) for link in socket.links]


_SKIPPED = {"rna_type", "location", "location_absolute", "width", "height", "select", "inputs", "outputs",
            "internal_links", "parent", "dimensions", "show_options", "show_preview", "show_texture", "hide", "color",
            "use_custom_color", "warning_propagation", "cache_point_density", "bl_icon", "bl_height_default", "id_data",
            "bl_height_max", "bl_height_min", "bl_width_default", "bl_width_max", "bl_width_min"}


def _plain(value):
    if isinstance(value, (bool, int, float, str)) or value is None:
        return value
    if isinstance(value, bpy.types.ID):
        return value.name_full
    try:
        return [_plain(each) for each in value]
    except TypeError:
        return str(value)


def _content(thing, depth):
    """The properties of a node, and of what belongs to it."""
    result = []
    for rna in thing.bl_rna.properties:
        name = rna.identifier
        if name in _SKIPPED:
            continue
        value = getattr(thing, name)
        if isinstance(value, bpy.types.Image):
            result.append((name, _image_content(value)))
        elif isinstance(value, bpy.types.Object):
            result.append((name, value.name_full, _plain(value.matrix_world)))
        elif isinstance(value, bpy.types.ID):
            result.append((name, value.name_full))
        elif rna.type == "COLLECTION":
            result.append((name, [_content(each, depth + 1) for each in value] if depth < 4 else len(value)))
        elif rna.type == "POINTER":
            result.append((name, _content(value, depth + 1) if value is not None and depth < 4 else None))
        else:
            result.append((name, _plain(value)))
    return result


def is_painted(image):
    """Whether its pixels are neither in a file nor computed again when one opens."""
    return image.source == "GENERATED" and image.is_dirty and not image.packed_files


def pixels_of(image):
    """All channels of all pixels, from the lowest row up."""
    values = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(values)
    return values


def _image_content(image):
    from .images import file_of

    packed = [hashlib.sha256(each.packed_file.data).hexdigest() for each in image.packed_files]
    stamps = [] if packed else [(str(path), path.stat().st_mtime_ns, path.stat().st_size) for path in file_of(image)]
    painted = hashlib.sha256(pixels_of(image).tobytes()).hexdigest() if is_painted(image) else None
    return (image.name_full, packed, stamps, painted, image.colorspace_settings.name, image.alpha_mode, image.source,
            [tile.number for tile in image.tiles], list(image.generated_color), image.generated_type)
