# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume objects: a box with a medium whose density is a grid of an OpenVDB file."""

import dataclasses
import os
import pathlib
import tempfile

import bpy
import mathutils
import numpy

from .elements import Element, add_matrix, add_value, plugin
from .materials import export_material
from .surfaces import Part

_HEADER_BYTES = 57  # of OpenVDB's files: numbers of the format, and 36 characters for the file
_BOX = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_SIDES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                      [0, 6, 4], [1, 5, 7], [1, 7, 3]])


@dataclasses.dataclass
class GridMedium:
    """The Medium that is where the grid of a file has the density 1. shift: of the grid in the space of the object.
    in_object: whether it is as dense on the whole when the object is scaled, not for a unit of length."""
    medium: object
    path: str
    shift: object
    in_object: bool

    def element(self, matrix):
        """The <medium> in an object's matrix."""
        scattered = self.medium.scattering
        extinction = scattered + self.medium.absorbed
        most = float(extinction.max())
        element = plugin("medium", "heterogeneous")
        grid = Element("volume", {"type": "gridvolume", "name": "sigma_t"})
        add_value(grid, "string", "filename", self.path)
        add_value(grid, "boolean", "use_grid_bbox", True)
        add_matrix(grid, matrix @ mathutils.Matrix.Translation(self.shift))
        element.append(grid)
        add_value(element, "float", "scale", most / (_scale(matrix) if self.in_object else 1))
        add_value(element, "rgb", "albedo", numpy.divide(scattered, extinction, out=numpy.zeros(3), where=extinction > 0))
        if scattered.any():
            element.append(self.medium.phase())
        return element


def _scale(matrix):
    """By which Cycles thins the volumes of scaled objects: that along their diagonal."""
    return (matrix.to_3x3() @ mathutils.Vector((1, 1, 1)).normalized()).length


def _note_losses(context, medium, name):
    extinction = medium.scattering + medium.absorbed
    if extinction.max() - extinction.min() > 1e-4 * extinction.max():
        context.report.add("a grid's extinction is exported as that of the channel with the most", name)
    if medium.emitted.any():
        context.report.add("the emission of a volume object is not exported", name)


def _shift_of(grid):
    """Before Blender 5.0, Cycles shows values half a cell further along all axes than OpenVDB has them."""
    half = 0.5 if bpy.app.version < (5, 0) else 0.0
    return grid.matrix_object.to_3x3() @ mathutils.Vector((half, half, half))


def _box_of(obj, grid):
    """The matrix from the cube between -1 and 1 to the object's box, and a cell of the grid around it."""
    corners = numpy.array(obj.bound_box)
    cell = numpy.abs(numpy.array(grid.matrix_object)[:3, :3]).sum(axis=1)
    low, high = corners.min(axis=0) - cell, corners.max(axis=0) + cell
    return mathutils.Matrix.Translation((low + high) / 2) @ mathutils.Matrix.Diagonal((*(high - low) / 2, 1))


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
    if "density" not in grids:
        context.report.add("a volume without a grid named density is not exported", name)
        return []
    for grid in grids:
        if grid.name != "density":
            context.report.add(f'the grid "{grid.name}" is not exported', name)
    if len(materials) > 1:
        context.report.add("the volume is exported with the material of the first slot", name)
    surface = export_material(materials[0], obj, context)
    if surface.interior is None:
        return []
    path = _file_of(context, obj)
    if path is None:
        context.report.add(f"the volume's grids could not be saved: {grids.error_message}", name)
        return []
    surface.bsdf = surface.emission = None
    _note_losses(context, surface.interior, name)
    surface.interior = GridMedium(surface.interior, path, _shift_of(grids["density"]), volume.render.space == "OBJECT")
    within = _box_of(obj, grids["density"])
    outline = _BOX @ numpy.array(within.to_3x3()).T + numpy.array(within.translation), _SIDES
    return [Part(plugin("shape", "cube"), surface, materials[0].name, outline, within)]
