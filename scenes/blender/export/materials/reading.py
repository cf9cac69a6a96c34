# SPDX-License-Identifier: GPL-3.0-or-later
"""One material on one object, while it is read."""

import numpy

from . import folded_nodes  # noqa: F401  registers nodes
from .bake import BakeError, Bakes
from .coordinates import render_uv_map
from .dependencies import Dependencies
from .fields import Field, NotFolded, constant
from .images import Images
from .meshes_to_bake import MeshToBake, faces_of
from .nodes import Input, input_socket
from .values import Values, is_linked


class NeedsMesh(Exception):
    """A value needs a bake over coordinates made for it, so that all images of the material must be over these."""


class Reading:
    """The values of a material's sockets, with a report of what is left out.

    over_mesh: all images are baked over coordinates made for them; else they are over one UV map. grids: those of a
    volume, by values(name), or None.
    """

    def __init__(self, material, obj, context, over_mesh=False, grids=None):
        self.material, self.obj, self.context = material, obj, context
        self.over_mesh = over_mesh
        self.grids = grids
        self.mesh = obj.data if obj is not None and obj.type == "MESH" else None
        self.values = Values(_images_of(context), self.mesh)
        self.bakes = Bakes(material, self._mesh_to_bake, self._uv_bounds, context)
        self.uv_maps = set()  # of images so far
        self.attributes = set()

    def note(self, node, message):
        """Adds a line to the report."""
        self.context.report.add(message, self.obj.name if self.obj is not None else None, self.material.name,
                                node.name if node is not None else None)

    def at(self, source, *names):
        """The input of the source's node that has one of the names; its socket may be None."""
        return Input(input_socket(source.node, *names), source.groups)

    def is_linked(self, source, *names):
        return is_linked(self.at(source, *names))

    def number(self, source, *names, default=0.0, low=None, high=None):
        """The value of a number's input, clamped to [low, high]."""
        return self.value(self.at(source, *names), default, low, high)

    def colour(self, source, *names, default=0.0, low=0.0, high=None):
        """The value of a colour's input."""
        return self.value(self.at(source, *names), [default] * 3, low, high)

    def value(self, at, default=0.0, low=None, high=None, signed=False):
        """The value of an Input: folded or baked; signed: it may be negative."""
        if at.socket is None:
            return constant(default)
        try:
            field = self._placed(at, self.values.fold(at), signed)
        except NotFolded as reason:
            field = self._baked(at, reason, default, signed)
        if at.socket.type == "RGBA" and high == 1.0 and float(field.data.max()) > 1 + 1e-4:
            self.note(at.node, f"'{at.socket.name}' is more than 1 and counts as 1")
        return clamped(field, low, high)

    def _placed(self, at, field, signed):
        """The field over the coordinates of all of the material's images."""
        if field.attribute is not None:
            self.attributes.add(field.attribute)
        if field.placement is None:
            return field
        if self.over_mesh:
            return self._baked(at, None, 0.0, signed)
        self._use_uv_map(field.placement.uv_map)
        return field

    def _use_uv_map(self, name):
        if name in {"", render_uv_map(self.mesh)}:
            name = None
        self.uv_maps.add(name)
        if len(self.uv_maps) > 1:
            raise NeedsMesh

    def _baked(self, at, reason, default, signed):
        dependencies = Dependencies(self.mesh)
        dependencies.add(at)
        for node in dependencies.view:
            self.note(node, f"'{at.socket.name}' of '{at.node.name}' depends on it, which is not exported")
        if dependencies.view:
            return constant(default)
        needs_mesh = dependencies.needs_mesh or len(dependencies.uv_maps) > 1 or (self.over_mesh and dependencies.uv_maps)
        try:
            if not needs_mesh and not dependencies.uv_maps:
                return self.bakes.constant(at, dependencies)
            if self.mesh is None or not len(self.mesh.polygons):
                self.note(at.node, f"'{at.socket.name}' varies over an object that is no mesh; it is not exported")
                return constant(default)
            if needs_mesh:
                self._need_mesh()
                return self.bakes.over_mesh(at, dependencies, signed=signed)
            uv_map = next(iter(dependencies.uv_maps))
            self._use_uv_map(uv_map)
            return self.bakes.over_uvs(at, dependencies, uv_map, signed)
        except BakeError as error:
            self.note(at.node, f"'{at.socket.name}' is not exported, since {reason or 'it needs a bake'} and {error}")
            return constant(default)

    def _need_mesh(self):
        if not self.over_mesh:
            raise NeedsMesh

    def normals(self, at, kind="NORMAL"):
        """Normals of a Normal input, or of a Displacement input, in tangent space, as an image over the mesh. None where
        that cannot be."""
        dependencies = Dependencies(self.mesh)
        dependencies.add(at)
        if dependencies.view or self.mesh is None:
            self.note(at.node, f"'{at.socket.name}' is not exported")
            return None
        self._need_mesh()
        try:
            return self.bakes.over_mesh(at, dependencies, kind)
        except BakeError as error:
            self.note(at.node, f"'{at.socket.name}' is not exported: {error}")
            return None

    def uvs(self):
        """(loops of the mesh, 2): coordinates of the images, where over_mesh. None if there are no images."""
        uvs = numpy.zeros((self.bakes.mesh.loop_count, 2), numpy.float32)
        try:
            uvs[self.bakes.mesh.loops] = self.bakes.uvs()
        except BakeError:
            return None  # no image could be baked either, and the report says so
        return uvs

    def _faces(self):
        slots = [slot.material for slot in self.obj.material_slots]
        same = [index for index, material in enumerate(slots) if material == self.material] or [0]
        return numpy.unique(numpy.concatenate([faces_of(self.mesh, slot, max(len(slots), 1)) for slot in same]))

    def _mesh_to_bake(self):
        return MeshToBake(self.obj, self.mesh, self._faces())

    def _uv_bounds(self, name):
        layer = self.mesh.uv_layers.get(name) if name else None
        if layer is None:
            return numpy.zeros(2), numpy.ones(2)
        uvs = numpy.empty(len(self.mesh.loops) * 2, numpy.float32)
        layer.uv.foreach_get("vector", uvs)
        uvs = uvs.reshape(-1, 2)[self.bakes.mesh.loops].astype(float)
        return uvs.min(axis=0), uvs.max(axis=0)


def _images_of(context):
    if not hasattr(context, "material_images"):
        context.material_images = Images(context)
    return context.material_images


def clamped(field, low, high):
    """The field within bounds; itself if it is."""
    if field.attribute is not None or (low is None and high is None):
        return field
    data = numpy.clip(field.data, low, high)
    return field if numpy.array_equal(data, field.data) else Field(data, field.placement)
