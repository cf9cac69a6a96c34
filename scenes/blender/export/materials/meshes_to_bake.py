# SPDX-License-Identifier: GPL-3.0-or-later
"""The faces of a material as arrays, for a bake in another process."""

import hashlib

import numpy

_WIDTHS = {"FLOAT": ("value", 1, numpy.float32), "INT": ("value", 1, numpy.int32), "BOOLEAN": ("value", 1, bool),
           "FLOAT_VECTOR": ("vector", 3, numpy.float32), "FLOAT_COLOR": ("color", 4, numpy.float32),
           "BYTE_COLOR": ("color", 4, numpy.float32), "FLOAT2": ("vector", 2, numpy.float32)}
_OWN = {"position", "material_index", "sharp_face", "sharp_edge"}
GENERATED = "penumbra generated"  # attribute of generated coordinates


def _values(collection, name, width, kind=numpy.float32):
    values = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def faces_of(mesh, slot, slots):
    """The indices of the polygons that show a material slot, of `slots`; those beyond show the last one."""
    attribute = mesh.attributes.get("material_index")
    if attribute is None:
        return numpy.arange(len(mesh.polygons)) if slot == 0 else numpy.arange(0)
    indices = _values(attribute.data, "value", 1, numpy.int32)[:, 0]
    return numpy.flatnonzero(indices == slot if slot + 1 < slots else indices >= slot)


class MeshToBake:
    """arrays: for numpy.savez. loops: the mesh's loops of the faces, in the order of the arrays. key: of their content."""

    def __init__(self, obj, mesh, faces):
        starts = _values(mesh.polygons, "loop_start", 1, numpy.int32)[faces, 0]
        totals = _values(mesh.polygons, "loop_total", 1, numpy.int32)[faces, 0]
        ends = numpy.cumsum(totals)
        self.loops = numpy.repeat(starts - (ends - totals), totals) + numpy.arange(ends[-1] if len(ends) else 0)
        self.loop_count = len(mesh.loops)
        corners = _values(mesh.loops, "vertex_index", 1, numpy.int32)[:, 0][self.loops]
        self.arrays = {"positions": _values(mesh.vertices, "co", 3), "corners": corners, "starts": ends - totals,
                       "normals": _values(mesh.corner_normals, "vector", 3)[self.loops],
                       "matrix": numpy.array(obj.matrix_world), "colour": numpy.array(obj.color),
                       "index": numpy.array([obj.pass_index]), "object": numpy.array([obj.original.name]),
                       "smooth": numpy.array([mesh.normals_domain != "FACE"])}
        low = numpy.array(mesh.texspace_location) - numpy.array(mesh.texspace_size)
        size = 2 * numpy.array(mesh.texspace_size)
        generated = (_values(mesh.vertices, "undeformed_co", 3) - low) / numpy.where(size != 0, size, 1)
        self.arrays[f"POINT FLOAT_VECTOR {GENERATED}"] = generated.astype(numpy.float32)
        for attribute in mesh.attributes:
            if attribute.name.startswith(".") or attribute.name in _OWN or attribute.data_type not in _WIDTHS:
                continue
            if attribute.domain not in {"POINT", "CORNER", "FACE"}:
                continue
            values = _values(attribute.data, *_WIDTHS[attribute.data_type])
            if attribute.domain == "CORNER":
                values = values[self.loops]
            elif attribute.domain == "FACE":
                values = values[faces]
            self.arrays[f"{attribute.domain} {attribute.data_type} {attribute.name}"] = values
        self.names = numpy.array([next((uv.name for uv in mesh.uv_layers if uv.active_render), ""),
                                  mesh.color_attributes[mesh.color_attributes.render_color_index].name
                                  if mesh.color_attributes.render_color_index >= 0 else ""])
        digest = hashlib.sha256()
        for name, values in self.arrays.items():
            digest.update(name.encode() + numpy.ascontiguousarray(values).tobytes())
        self.key = digest.digest()
