# SPDX-License-Identifier: GPL-3.0-or-later
"""The geometry of objects as <shape> elements, one for each material, made once for all objects that show it."""

import dataclasses
from xml.etree import ElementTree

from .curves import curve_parts, strand_parts
from .elements import add_value, number, plugin
from .materials import export_material
from .materials.dependencies import is_of_object
from .meshes import colours_of_corners, mesh_of, read_mesh, uvs_of_corners, write_part
from .surfaces import Part
from .volumes import volume_parts


@dataclasses.dataclass(eq=False)
class Geometry:
    """parts: list of Part. made_of: session_uids of the data-blocks that it is made of; it lasts until one changes."""
    parts: list
    made_of: set


def _materials(context, obj):
    """The materials of the slots; at least one, which may be None."""
    override = context.depsgraph.view_layer_eval.material_override
    slots = [slot.material for slot in obj.material_slots] or [None]
    return [override] * len(slots) if override is not None else slots


def differs(materials):
    """Whether materials look different on objects with the same mesh."""
    return any(material is not None and material.node_tree is not None and is_of_object(material.node_tree)
               for material in materials)


def _identity(obj, materials):
    """Equal for objects with the same geometry and materials, and whether that is so in other frames, too."""
    uids = tuple(material.session_uid if material is not None else 0 for material in materials)
    data, original = obj.data, obj.original
    if data.original != original.data:  # made by modifiers, and lives as long as their result
        return ("made", data.as_pointer(), uids)
    is_as_made = not original.modifiers and getattr(original.data, "shape_keys", None) is None
    if is_as_made and not differs(materials) and obj.type == original.type:
        return ("data", original.data.session_uid, uids)
    return ("object", original.session_uid, uids)


def geometry_of(context, obj, has_surface=True, has_strands=True, states=None):
    """The Geometry of an evaluated object: its surface or what it is else, and the hair of its particle systems.
    states: of a mesh that deforms: {seconds: MeshArrays}."""
    materials = _materials(context, obj)
    identity = (*_identity(obj, materials), has_surface, has_strands, tuple(states or ()))
    known = context.geometry.get(identity)
    if known is None:
        made_of = {block.session_uid for block in [obj.original, obj.original.data, *materials] if block is not None}
        known = Geometry(_parts(context, obj, materials, has_surface, has_strands, states), made_of)
        context.geometry[identity] = known
    return known


def _parts(context, obj, materials, has_surface, has_strands, states):
    if obj.type == "CURVES":
        return curve_parts(context, obj, materials)
    if obj.type == "VOLUME":
        return volume_parts(context, obj, materials)
    parts = []
    if has_surface or obj.type != "MESH":
        with mesh_of(obj) as mesh:
            parts = _mesh_parts(context, obj, mesh, materials, states) if mesh is not None else []
    strands = strand_parts(context, obj, materials) if has_strands and obj.type == "MESH" else []
    if strands and states:
        context.report.add("the motion of its hair while the shutter is open is not exported", obj.name)
    return parts + strands


_BY_TANGENTS = {"alpha_u", "specular_roughness_anisotropy"}


def _add_tangents(shape, bsdf):
    """Those of Cycles, for a <bsdf> that needs any."""
    elements = list(bsdf.iter()) if bsdf is not None else []
    bends = any(element.get("type") == "normalmap" for element in elements)
    if bends or any(element.get("name") in _BY_TANGENTS for element in elements):
        add_value(shape, "string", "tangents", "mikktspace")
    if bends:
        add_value(shape, "boolean", "mirrored_maps", True)


def _mesh_parts(context, obj, mesh, materials, states):
    arrays = read_mesh(mesh)
    parts = []
    for index, material in enumerate(materials):
        # Blender shows faces of slots that are not there with the last one.
        chosen = arrays.slots == index if index + 1 < len(materials) else arrays.slots >= index
        triangles = arrays.triangles if chosen.all() else arrays.triangles[chosen]
        if not len(triangles):
            continue
        surface = export_material(material, obj, context)
        uvs = surface.uvs if surface.uvs is not None else uvs_of_corners(mesh, surface.uv_map)
        colours = {name: colours_of_corners(mesh, arrays, name) for name in surface.attributes}
        for name in [name for name, table in colours.items() if table is None]:
            context.report.add(f'the mesh has no colours "{name}"', obj.name)
            del colours[name]
        shape = plugin("shape", "ply")
        _add_files(shape, write_part(context, arrays, triangles, uvs, colours, list((states or {}).values())), states)
        if arrays.normals is None:
            add_value(shape, "boolean", "face_normals", True)
        if uvs is not None:
            _add_tangents(shape, surface.bsdf)
        outline = None
        if surface.interior is not None:
            outline = arrays.positions, arrays.corners[arrays.triangles]
        parts.append(Part(shape, surface, material.name if material is not None else "default", outline))
    return parts


def _add_files(shape, paths, states):
    """The shape's file, or those by time, in seconds."""
    if not states:
        add_value(shape, "string", "filename", paths[0])
        return
    animation = ElementTree.SubElement(shape, "animation", {"name": "filename"})
    for time, path in zip(states, paths, strict=True):
        ElementTree.SubElement(animation, "string", {"time": number(time), "value": path})
