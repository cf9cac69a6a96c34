# SPDX-License-Identifier: GPL-3.0-or-later
"""Media within each other: light meets all whose surfaces are around it, as in Cycles, where their densities add up."""

import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .materials.media import Medium
from .volumes import GridMedium

_UP = Vector((0.0118, 0.0231, 1.0)).normalized()  # hardly along an edge
_MOST_HITS = 1000
_PROBES = 8  # vertices of a surface that tell whether it is within another


class _Outline:
    """The closed surface of a part, in the space of its object."""

    def __init__(self, vertices, triangles):
        self.triangles = triangles.tolist()
        self.all_vertices = vertices.astype(float)
        self.tree = BVHTree.FromPolygons(vertices.tolist(), self.triangles, all_triangles=True)
        self.vertices = vertices[numpy.unique(triangles)].astype(float)
        self.probes = self.vertices[:: max(1, len(self.vertices) // _PROBES)]

    def contains(self, point):
        """Whether a ray from the point leaves the surface an odd number of times."""
        hits = 0
        while hits < _MOST_HITS:
            place, _, _, _ = self.tree.ray_cast(point, _UP)
            if place is None:
                break
            hits += 1
            point = place + 1e-5 * max(1.0, place.length) * _UP
        return hits % 2 == 1


class _Region:
    """Where a part is, in the world. box: its (least, most) corners."""

    def __init__(self, part, place, outline):
        self.part, self.place, self.outline = part, place, outline
        self.inverse = place.now.inverted_safe()
        matrix = numpy.array(place.now)
        vertices = outline.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        self.box = vertices.min(axis=0), vertices.max(axis=0)
        self.probes = outline.probes @ matrix[:3, :3].T + matrix[:3, 3]
        self._tree = None

    @property
    def tree(self):
        """Of the triangles in the world."""
        if self._tree is None:
            matrix = numpy.array(self.place.now)
            vertices = self.outline.all_vertices @ matrix[:3, :3].T + matrix[:3, 3]
            self._tree = BVHTree.FromPolygons(vertices.tolist(), self.outline.triangles, all_triangles=True)
        return self._tree


class Regions:
    """All regions of a scene. placed: {Geometry: [Place]}. everywhere: the Medium of the world, or None."""

    def __init__(self, context, placed, everywhere=None):
        self.everywhere = everywhere
        self.report = context.report
        outlines = {id(part): _Outline(*part.outline) for geometry in placed for part in geometry.parts
                    if part.outline is not None}
        self.regions = [_Region(part, place, outlines[id(part)]) for geometry, places in placed.items()
                        for place in places for part in geometry.parts if part.outline is not None]
        self._of = {(id(region.part), id(region.place)): region for region in self.regions}
        self._least, self._most = (numpy.array([region.box[side] for region in self.regions]).reshape(-1, 3)
                                   for side in (0, 1))

    def around(self, point):
        """The regions that contain a point of the world."""
        near = ((self._least <= point) & (point <= self._most)).all(axis=1)
        found = (self.regions[index] for index in numpy.flatnonzero(near))
        return [region for region in found if region.outline.contains(region.inverse @ Vector(point))]

    def around_part(self, part, place):
        """The regions that contain a part in its Place."""
        own = self._of[id(part), id(place)]
        near = ((self._least <= own.box[1]) & (own.box[0] <= self._most)).all(axis=1)
        for other in (self.regions[index] for index in numpy.flatnonzero(near)):
            if other is not own and own.tree.overlap(other.tree):
                self.report.add(f'its surface crosses that of the volume "{other.part.name}"; where both are, one counts',
                                material=part.name)
        found = [self.around(probe) for probe in own.probes]
        return [region for region in found[0] if region is not own and all(region in regions for regions in found)]

    def element(self, regions):
        """The <medium> of what is within all of these; None if nothing is there. A grid does not add up with others."""
        media = [(region.part.surface.interior, region) for region in regions]
        grids = [(medium, region) for medium, region in media if isinstance(medium, GridMedium)]
        if grids:
            medium, region = grids[-1]
            if len(media) > 1 or self.everywhere is not None:
                self.report.add("within the box of the grid there is no other medium", material=region.part.name)
            if region.place.moves:
                self.report.add("a volume does not move while the shutter is open", material=region.part.name)
            return medium.element(region.place.now)
        added = [medium for medium, _ in media]
        if self.everywhere is not None:
            added.append(self.everywhere)
        if not added:
            return None
        total = Medium()
        for medium in added:
            total.add(medium)
        if media and len(added) > 1 and total.mixes_colours:
            self.report.add("phase functions are mixed alike for all colours", material=regions[0].part.name)
        return total.element()

    def sides(self, part, place):
        """The <medium> elements inside and outside of a part in its Place; None where there is none."""
        around = self.around_part(part, place)
        return self.element([*around, self._of[id(part), id(place)]]), self.element(around)
