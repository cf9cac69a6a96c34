# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays, and their parts of one material each as PLY files."""

import contextlib
import dataclasses
import hashlib

import numpy

from .ply import ply_bytes


def values_of(collection, name, width, kind=numpy.float32):
    """The property of all items: (n, width), or (n,) for a width of 1."""
    values = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


@dataclasses.dataclass
class MeshArrays:
    """positions: (vertices, 3). corners: (loops,) vertex of each. triangles: (t, 3) loops. slots: (t,) material slot.
    normals: (loops, 3), or None where all faces are flat."""
    positions: numpy.ndarray
    corners: numpy.ndarray
    triangles: numpy.ndarray
    slots: numpy.ndarray
    normals: object


@contextlib.contextmanager
def mesh_of(obj):
    """The bpy.types.Mesh of an evaluated object with a surface, or None."""
    if obj.type == "MESH":
        yield obj.data
        return
    try:
        yield obj.to_mesh()
    finally:
        obj.to_mesh_clear()


def read_mesh(mesh):
    """The arrays of a bpy.types.Mesh."""
    mesh.calc_loop_triangles()
    corners = values_of(mesh.loops, "vertex_index", 1, numpy.int32)
    triangles = values_of(mesh.loop_triangles, "loops", 3, numpy.int32)
    slots = numpy.zeros(len(triangles), numpy.int32)
    indices = mesh.attributes.get("material_index")
    if indices is not None:
        slots = values_of(indices.data, "value", 1, numpy.int32)[
            values_of(mesh.loop_triangles, "polygon_index", 1, numpy.int32)]
    normals = None
    if mesh.normals_domain == "POINT":
        normals = values_of(mesh.vertex_normals, "vector", 3)[corners]
    elif mesh.normals_domain == "CORNER":
        normals = values_of(mesh.corner_normals, "vector", 3)
    return MeshArrays(values_of(mesh.vertices, "co", 3), corners, triangles, slots, normals)


def uvs_of_corners(mesh, name):
    """Coordinates of the UV map, or of the one that is active for rendering: (loops, 2). None without any."""
    layer = mesh.uv_layers.get(name) if name else next((uv for uv in mesh.uv_layers if uv.active_render), None)
    return None if layer is None else values_of(layer.uv, "vector", 2)


def colours_of_corners(mesh, arrays, name):
    """Linear colours of the attribute: (loops, 3). None if the mesh has no such colours."""
    attribute = mesh.color_attributes.get(name)
    if attribute is None:
        return None
    colours = values_of(attribute.data, "color", 4)[:, :3]
    if attribute.domain == "POINT":
        return colours[arrays.corners]
    return colours


def split_vertices(corners, values):
    """Vertices that differ in the values at their corners become several.

    corners: (n,) vertex of each corner. values: (n, k). Returns, for each corner, its new vertex, and for each new
    vertex a corner of it.
    """
    vertex = numpy.empty(len(corners), numpy.int64)
    chosen = []
    count = 0
    rest = numpy.arange(len(corners))
    for _ in range(8):  # few corners of a vertex differ, usually
        if not len(rest):
            break
        first = numpy.full(corners.max() + 1, -1, numpy.int64)
        first[corners[rest][::-1]] = rest[::-1]  # the first of equal ones is written last
        used = first >= 0
        number = numpy.cumsum(used) - 1 + count
        same = (values[rest] == values[first[corners[rest]]]).all(axis=1)
        vertex[rest[same]] = number[corners[rest[same]]]
        chosen.append(first[used])
        count += len(chosen[-1])
        rest = rest[~same]
    if len(rest):
        rows = numpy.column_stack([corners[rest], numpy.ascontiguousarray(values[rest]).view(numpy.int32)])
        _, index, inverse = numpy.unique(rows, axis=0, return_index=True, return_inverse=True)
        vertex[rest] = inverse.reshape(-1) + count
        chosen.append(rest[index])
    return vertex, numpy.concatenate(chosen) if chosen else rest


def write_part(context, arrays, triangles, uvs=None, colours=None, states=None):
    """Writes the triangles (indices of loops) and returns the paths of files in the folder, one for each state.

    uvs: (loops, 2) or None. colours: {name: (loops, 3)}. states: MeshArrays of a mesh that deforms, at several times;
    without them there is one, `arrays`.
    """
    states = states or [arrays]
    colours = colours or {}
    tables = [table for table in [*(state.normals for state in states), uvs, *colours.values()] if table is not None]
    corners = triangles.reshape(-1)
    is_used = numpy.zeros(len(arrays.corners), bool)
    is_used[corners] = True
    loops = numpy.flatnonzero(is_used)
    values = numpy.column_stack([table[loops] for table in tables]) if tables else numpy.empty((len(loops), 0))
    vertex, chosen = split_vertices(arrays.corners[loops], values)
    place = numpy.empty(len(arrays.corners), numpy.int64)
    place[loops] = vertex
    source = loops[chosen]
    return [_write(context, ply_bytes(state.positions[arrays.corners[source]], place[triangles],
                                      None if state.normals is None else state.normals[source],
                                      None if uvs is None else uvs[source],
                                      {name: table[source] for name, table in colours.items()})) for state in states]


def _write(context, parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)

    def write(path):
        with open(path, "wb") as file:
            for part in parts:
                file.write(part)

    return context.file("meshes", ".ply", digest.digest(), write)
