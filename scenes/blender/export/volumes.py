# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume objects: a box with a medium whose density is a grid of an OpenVDB file."""

import copy
import os

import bpy
import mathutils

from .elements import Element, add_matrix, add_value, plugin
from .materials import export_material
from .surfaces import Part


def _numbers(medium, name):
    element = next((child for child in medium.findall("rgb") if child.get("name") == name), None)
    return [float(text) for text in element.get("value").split(",")] if element is not None else [0.0] * 3


def medium_of_grid(context, homogeneous, path, name):
    """The medium of a material, with the density of a grid: what it has where the density is 1."""
    scattered, absorbed = _numbers(homogeneous, "sigma_s"), _numbers(homogeneous, "sigma_a")
    extinction = [s + a for s, a in zip(scattered, absorbed)]
    most = max(extinction)
    if most - min(extinction) > 1e-4 * most:
        context.report.add("a grid's extinction is exported as that of the channel with the most", name)
    medium = plugin("medium", "heterogeneous")
    grid = Element("volume", {"type": "gridvolume", "name": "sigma_t"})
    add_value(grid, "string", "filename", path)
    add_value(grid, "boolean", "use_grid_bbox", True)
    medium.append(grid)
    add_value(medium, "float", "scale", most)
    add_value(medium, "rgb", "albedo", [s / e if e > 0 else 0.0 for s, e in zip(scattered, extinction)])
    if any(_numbers(homogeneous, "emission")):
        context.report.add("the emission of a volume object is not exported", name)
    medium.extend(homogeneous.findall("phase"))
    return medium


def volume_parts(context, obj, materials):
    """The parts of an evaluated Volume object."""
    volume, name = obj.data, obj.name
    grids = volume.grids
    if not grids.load():
        context.report.add(f"the volume's file could not be read: {grids.error_message}", name)
        return []
    path = os.path.abspath(bpy.path.abspath(grids.frame_filepath or volume.filepath, library=volume.original.library))
    if not os.path.isfile(path) or "density" not in grids:
        context.report.add("a volume without a file of a grid named density is not exported", name)
        return []
    for grid in grids:
        if grid.name != "density":
            context.report.add(f'the grid "{grid.name}" is not exported', name)
    if len(materials) > 1:
        context.report.add("the volume is exported with the material of the first slot", name)
    surface = export_material(materials[0], obj, context)
    if surface.interior is None:
        return []
    surface.bsdf = surface.emission = None
    surface.interior = medium_of_grid(context, surface.interior, path, name)
    corners = [mathutils.Vector(corner) for corner in obj.bound_box]
    low = mathutils.Vector([min(corner[axis] for corner in corners) for axis in range(3)])
    high = mathutils.Vector([max(corner[axis] for corner in corners) for axis in range(3)])
    half = (high - low) / 2
    within = mathutils.Matrix.Translation((low + high) / 2) @ mathutils.Matrix.Diagonal((*((high - low) / 2), 1))
    return [Part(plugin("shape", "cube"), surface, materials[0].name, within)]


def placed_medium(context, medium, place, name):
    """The medium with its grid in a Place."""
    if place.moves:
        context.report.add("a volume does not move while the shutter is open", name)
    placed = copy.deepcopy(medium)
    add_matrix(placed.find("volume"), place.now)
    return placed
