# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of OpenVDB files as arrays, and as volume files."""

import glob
import importlib
import os
import struct
import sys

import bpy
import numpy

_FINER = (5, 3)  # odd: centres of cells stay centres
_MOST_CELLS = 1 << 22  # of grids with finer cells


def filters_after_shading():
    """Whether Cycles interpolates what shaders make of voxels, not voxels. From Blender 5.0 on it evaluates the shader
    at one voxel, by the weights of interpolation (Pharr et al. 2024, "Filtering After Shading")."""
    return bpy.app.version >= (5, 0)


class GridError(Exception):
    """Grids that cannot be exported, with the reason."""


def openvdb_module():
    """Blender's module for OpenVDB. bpy as a module of Python leaves it out of its path. Errors: GridError."""
    folders = glob.glob(os.path.join(bpy.utils.resource_path("LOCAL"), "python", "lib", "python3*", "site-packages"))
    for name in ("openvdb", "pyopenvdb"):
        kept = list(sys.path)
        try:
            sys.path += folders
            return importlib.import_module(name)
        except ImportError:
            pass
        finally:
            sys.path[:] = kept
    raise GridError("this Blender has no Python module for OpenVDB")


class Probe:
    """Stands for the grids while a shader tells which it looks up. Their values are numbers of no meaning."""

    def __init__(self, names):
        self._names = list(names)
        self.used = []

    def values(self, name):
        if name not in self._names:
            return None
        if name not in self.used:
            self.used.append(name)
        return numpy.random.default_rng(self._names.index(name)).uniform(0.5, 1, (7, 1, 1, 1))

    def mapped(self, name, function):
        values = self.values(name)
        return None if values is None else function(values)


class _Grid:
    """The active voxels of a grid and its background around them. first: the index of the first. scale, origin: from
    index to object space."""

    def __init__(self, grid):
        low, high = (numpy.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
        if (high < low).any():
            low = high = numpy.zeros(3, int)
        origin = numpy.array(grid.transform.indexToWorld((0, 0, 0)))
        axes = numpy.array([grid.transform.indexToWorld(tuple(axis)) for axis in numpy.eye(3, dtype=int)]) - origin
        self.scale, self.origin = axes.diagonal(), origin
        if (self.scale <= 0).any() or not numpy.allclose(axes, numpy.diag(self.scale), atol=1e-6 * self.scale.max()):
            raise GridError(f'the grid "{grid.name}" is turned or mirrored')
        if grid.gridClass == "level set":
            raise GridError(f'the grid "{grid.name}" is a level set')
        self.first = low - 1
        channels = 3 if "vec3" in grid.valueTypeName else 1
        shape = tuple(high - low + 3)
        self.values = numpy.zeros(shape if channels == 1 else (*shape, 3), "f8" if "d" in grid.valueTypeName[-1] else "f4")
        grid.copyToArray(self.values, ijk=tuple(int(index) for index in self.first))
        self.values = self.values.reshape(*shape, channels).astype(numpy.float32)

    def box(self):
        """Of its outermost centres, which have the background: (2, 3), in object space."""
        ends = numpy.array([self.first, self.first + self.values.shape[:3] - 1])
        return ends * self.scale + self.origin

    def at(self, centres, function=None):
        """Interpolated at the points of a lattice, an array of coordinates for each axis; or a function of voxels."""
        values = self.values if function is None else function(self.values).astype(numpy.float32)
        for axis, points in enumerate(centres):
            place = (points - self.origin[axis]) / self.scale[axis] - self.first[axis]
            place = numpy.clip(place, 0, values.shape[axis] - 1)
            before = numpy.minimum(place.astype(int), max(values.shape[axis] - 2, 0))
            share = (place - before).astype(numpy.float32).reshape([-1 if i == axis else 1 for i in range(4)])
            after = numpy.minimum(before + 1, values.shape[axis] - 1)
            values = values.take(before, axis) * (1 - share) + values.take(after, axis) * share
        return values


class Grids:
    """Grids of a file, interpolated to the same cells, which are so fine that products of them, and functions where
    Cycles interpolates voxels, may be interpolated. low, high: the box of the cells in object space."""

    def __init__(self, path, names):
        openvdb = openvdb_module()
        grids = {}
        for name in names:
            try:
                grids[name] = _Grid(openvdb.read(path, name))
            except (KeyError, RuntimeError, TypeError, ValueError) as error:
                raise GridError(f'the grid "{name}" could not be read: {error}') from error
        scale = numpy.min([grid.scale for grid in grids.values()], axis=0)
        boxes = numpy.array([grid.box() for grid in grids.values()])
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        finest = next(grid for grid in grids.values() if (grid.scale == scale).all() or len(grids) == 1)
        low = (numpy.floor((low - finest.origin) / scale + 1e-3) - 0.5) * scale + finest.origin
        cells = numpy.ceil((high - low) / scale - 1e-3).astype(int)
        self.low, self.high = low, low + cells * scale
        of_voxels = len(grids) == 1 and filters_after_shading()
        fits = [] if of_voxels else [n for n in _FINER if numpy.prod(cells, dtype=float) * n ** 3 <= _MOST_CELLS]
        self.is_fine = of_voxels or bool(fits)
        self.cells = cells * (fits[0] if fits else 1)
        centres = [low[axis] + (numpy.arange(count) + 0.5) * (self.high - low)[axis] / count
                   for axis, count in enumerate(self.cells)]
        self._values = {name: grid.at(centres) for name, grid in grids.items()}
        self._grids, self._centres = grids, centres

    def values(self, name):
        """(x, y, z, 1 or 3), or None."""
        return self._values.get(name)

    def mapped(self, name, function):
        """A function of values(name) alone, as Cycles interpolates it."""
        if name not in self._grids:
            return None
        if filters_after_shading():
            return self._grids[name].at(self._centres, function)
        return function(self._values[name])


def write_volume(context, values, low, high):
    """Writes an array (x, y, z, 1 or 3) over a box as Mitsuba's volume file, and returns its path in the folder."""
    head = b"VOL\x03" + struct.pack("<5i6f", 1, *values.shape, *low, *high)
    body = numpy.ascontiguousarray(values.transpose(2, 1, 0, 3), "<f4")

    def write(path):
        with open(path, "wb") as file:
            file.write(head)
            file.write(body)

    return context.file("volumes", ".vol", head + body.tobytes(), write)
