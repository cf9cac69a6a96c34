# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that deform while the shutter is open."""

import numpy

from .meshes import mesh_of, read_mesh

_SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


def has_own_data(context, obj):
    """Whether the data of an evaluated object or instance is its object's, and not one of several that its geometry
    nodes made."""
    return obj.data.as_pointer() == obj.original.evaluated_get(context.depsgraph).data.as_pointer()


def _same(first, other, tables):
    return all(numpy.array_equal(getattr(first, name), getattr(other, name)) for name in tables)


def meshes_at_keys(context, shutter, names):
    """{session_uid of an object: MeshArrays at each key of the shutter}, of the named objects that deform with the same
    faces. Takes the depsgraph to all keys. What deforms otherwise is reported."""
    found, known = {}, set()
    for index, frame in enumerate(shutter.frames):
        context.go_to(frame)
        for instance in context.depsgraph.object_instances:
            obj = instance.object
            if obj.original.name not in names or obj.type not in _SURFACES or not has_own_data(context, obj):
                continue
            known.add(obj.original.name)
            keys = found.setdefault(obj.original.session_uid, [])
            if len(keys) == index:
                with mesh_of(obj) as mesh:
                    keys.append((obj.original.name, read_mesh(mesh) if mesh is not None else None))
    for name in sorted(names - known):
        context.report.add("its deformation while the shutter is open is not exported", name)
    deforming = {}
    for uid, keys in found.items():
        name, first = keys[0]
        meshes = [mesh for _, mesh in keys]
        if len(meshes) < len(shutter.frames) or any(mesh is None for mesh in meshes) or \
                not all(_same(first, mesh, ("corners", "slots")) and len(mesh.positions) == len(first.positions)
                        and (mesh.normals is None) == (first.normals is None) for mesh in meshes):
            context.report.add("its faces change while the shutter is open; they are those of the frame", name)
        elif not all(_same(first, mesh, ("positions", "normals")) for mesh in meshes):
            deforming[uid] = meshes
    return deforming
