# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume objects: a box with a medium on the grids of an OpenVDB file."""

import dataclasses
import os
import pathlib
import tempfile

import bpy
import mathutils
import numpy

from .elements import Element, add_matrix, add_value, plugin
from .grids import GridError, Grids, Probe, write_volume
from .materials import export_material
from .surfaces import Part

_HEADER_BYTES = 57  # of OpenVDB's files: numbers of the format, and 36 characters for the file
_BOX = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_SIDES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                      [0, 6, 4], [1, 5, 7], [1, 7, 3]])


@dataclasses.dataclass
class GridMedium:
    """A medium on grids. density: the path of the grid of extinctions, in units of `scale`. albedo: a
    colour or the path of a grid. emission: gives such a one times its argument, or None. shift: of the grids in the space of the object. in_object:
    whether it is as dense on the whole when the object is scaled, not for a unit of length."""
    density: str
    scale: float
    albedo: object
    emission: object
    phase: object
    shift: object
    in_object: bool

    def element(self, matrix):
        """The <medium> in an object's matrix."""
        element = plugin("medium", "heterogeneous")
        density = 1 / _scale(matrix) if self.in_object else 1.0
        emission = None if self.emission is None else self.emission(density)
        colours = {"albedo": self.albedo, "emission": emission}
        for name, path in {"sigma_t": self.density, **colours}.items():
            if not isinstance(path, str):
                continue
            grid = Element("volume", {"type": "gridvolume", "name": name})
            add_value(grid, "string", "filename", path)
            add_value(grid, "boolean", "use_grid_bbox", True)
            add_value(grid, "string", "wrap_mode", "zero")
            add_matrix(grid, matrix @ mathutils.Matrix.Translation(self.shift))
            element.append(grid)
        add_value(element, "float", "scale", self.scale * density)
        for name, colour in colours.items():
            if colour is not None and not isinstance(colour, str):
                add_value(element, "rgb", name, colour)
        if self.phase is not None:
            element.append(self.phase)
        return element


def _scale(matrix):
    """By which Cycles thins the volumes of scaled objects: that along their diagonal."""
    return (matrix.to_3x3() @ mathutils.Vector((1, 1, 1)).normalized()).length


def _is_constant(values):
    rows = values.reshape(-1, values.shape[-1])
    return numpy.allclose(rows, rows[0], rtol=1e-4, atol=1e-12)


def _extinction_of(context, medium, name):
    """The extinction, (…, 1), and the albedo, which where nothing is is the mean."""
    scattered = medium.scattering
    extinction = scattered + medium.absorbed
    most = extinction.max(axis=-1, keepdims=True)
    if (most - extinction.min(axis=-1, keepdims=True) > 1e-4 * most).any():
        context.report.add("a grid's extinction is exported as that of the channel with the most", name)
    albedo = numpy.divide(scattered, extinction, out=numpy.zeros(extinction.shape), where=extinction > 0)
    is_there = most[..., 0] > 0
    mean = albedo[is_there].mean(axis=0) if is_there.any() else numpy.zeros(3)
    return most, numpy.where(is_there[..., None], albedo, mean)


def _density_of_file(context, medium, grid, name):
    """Of a Medium that looked up the Probe's grid alone: by how much its extinction is a multiple of the grid, and the
    albedo. None if that is not all that there is."""
    extinction, albedo = _extinction_of(context, medium, name)
    ratio = extinction / numpy.maximum(grid, 1e-30)
    if medium.emitted.any() or not (_is_constant(ratio) and _is_constant(albedo)):
        return None
    return float(ratio.mean()), albedo.reshape(-1, 3)[0]


def _on_grids(context, medium, grids, name):
    """The density, scale, albedo and emission of a GridMedium."""
    extinction, albedo = _extinction_of(context, medium, name)

    def shown(values):
        """A colour, or the path of a grid."""
        if _is_constant(values) and values.shape[-1] == 3:
            return values.reshape(-1, 3)[0]
        return write_volume(context, numpy.broadcast_to(values, (*grids.cells, values.shape[-1])), grids.low, grids.high)

    emission = (lambda factor: shown(factor * medium.emitted)) if medium.emitted.any() else None
    return shown(extinction), 1.0, shown(albedo), emission


def _shift_of(grid):
    """Before Blender 5.0, Cycles shows values half a cell further along all axes than OpenVDB has them."""
    half = 0.5 if bpy.app.version < (5, 0) else 0.0
    return grid.matrix_object.to_3x3() @ mathutils.Vector((half, half, half))


def _box_of(obj, grid):
    """The matrix from the cube between -1 and 1 to the object's box, and a cell of the grid around it."""
    corners = numpy.array(obj.bound_box)
    cell = numpy.abs(numpy.array(grid.matrix_object)[:3, :3]).sum(axis=1)
    return _box(corners.min(axis=0) - cell, corners.max(axis=0) + cell)


def _box(low, high):
    """The matrix from the cube between -1 and 1."""
    return mathutils.Matrix.Translation((low + high) / 2) @ mathutils.Matrix.Diagonal((*((high - low) / 2), 1))


def _file_of(context, obj):
    """The path of a file with the grids: the volume's own, or what its modifiers make, saved. None where that fails."""
    volume = obj.data
    path = volume.grids.frame_filepath or volume.filepath
    path = os.path.abspath(bpy.path.abspath(path, library=volume.original.library))
    if os.path.isfile(path) and not obj.modifiers:
        return path
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "grids.vdb")
        if not volume.grids.save(path):
            return None
        content = pathlib.Path(path).read_bytes()
    # The header ends with a random number.
    return context.file("volumes", ".vdb", content[_HEADER_BYTES:], lambda to: to.write_bytes(content))


def volume_parts(context, obj, materials):
    """The parts of an evaluated Volume object."""
    volume, name = obj.data, obj.name
    grids = volume.grids
    if not grids.load():
        context.report.add(f"the volume's file could not be read: {grids.error_message}", name)
        return []
    if len(materials) > 1:
        context.report.add("the volume is exported with the material of the first slot", name)
    probe = Probe([grid.name for grid in grids])
    surface = export_material(materials[0], obj, context, probe)
    medium = surface.interior
    if medium is None:
        return []
    if not probe.used:
        context.report.add("a volume whose material looks up none of its grids is not exported", name)
        return []
    path = _file_of(context, obj)
    if path is None:
        context.report.add(f"the volume's grids could not be saved: {grids.error_message}", name)
        return []
    shift = _shift_of(grids[probe.used[0]])
    single = None
    if len(probe.used) == 1:
        single = _density_of_file(context, medium, probe.values(probe.used[0]), name)
    if single is not None and (probe.used == ["density"] or len(grids) == 1):
        found, within = (path, *single, None), _box_of(obj, grids[probe.used[0]])
    else:
        try:
            arrays = Grids(path, probe.used)
        except GridError as error:
            context.report.add(f"the volume is not exported: {error}", name)
            return []
        if not arrays.is_fine:
            context.report.add("products and black bodies of its large grids are interpolated", name)
        medium = export_material(materials[0], obj, context, arrays).interior
        if medium is None:
            return []
        found, within = _on_grids(context, medium, arrays, name), _box(arrays.low, arrays.high)
    phase = medium.phase() if medium.scattering.any() else None
    surface.bsdf = surface.emission = None
    surface.interior = GridMedium(*found, phase, shift, volume.render.space == "OBJECT")
    outline = _BOX @ numpy.array(within.to_3x3()).T + numpy.array(within.translation), _SIDES
    return [Part(plugin("shape", "cube"), surface, materials[0].name, outline, within)]
