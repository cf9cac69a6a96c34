# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of triangles as binary PLY files."""

import re

import numpy


def attribute_name(name):
    """The name of a colour attribute in PLY files and, after "vertex_", in mesh_attribute textures."""
    return re.sub(r"[^A-Za-z0-9]", "_", name)


def ply_bytes(positions, triangles, normals=None, uvs=None, colours=None):
    """The parts of a file, to be joined or hashed one after another.

    positions, normals: (n, 3). uvs: (n, 2). colours: {name: (n, 3)}, linear. triangles: (t, 3) indices of vertices.
    """
    columns = [("x y z", positions)]
    if normals is not None:
        columns.append(("nx ny nz", normals))
    if uvs is not None:
        columns.append(("u v", uvs))
    for name, values in (colours or {}).items():
        stem = attribute_name(name)
        columns.append((f"{stem}_r {stem}_g {stem}_b", values))
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}"]
    header += [f"property float {name}" for names, _ in columns for name in names.split()]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    vertices = numpy.empty((len(positions), sum(values.shape[1] for _, values in columns)), "<f4")
    first = 0
    for _, values in columns:
        vertices[:, first:first + values.shape[1]] = values
        first += values.shape[1]
    faces = numpy.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"] = 3
    faces["corners"] = triangles
    return ["\n".join(header).encode("ascii"), vertices, faces]
