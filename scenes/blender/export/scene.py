# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks the evaluated scene and writes it."""

import copy
import dataclasses

import bpy
import numpy

from ..properties import settings_of
from .cameras import export_camera
from .deformation import has_own_data, meshes_at_keys
from .elements import Element, add_reference, add_value, plugin, write_scene
from .geometry import differs, geometry_of
from .lights import export_light
from .materials import export_world_medium
from .motion import Place, Shutter, blur_of
from .nesting import Regions
from .surfaces import Surfaces
from .world import export_world, shown_world

_SHOWN = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "VOLUME"}
_NOTHING = {"CAMERA", "EMPTY", "LIGHT_PROBE", "ARMATURE", "LATTICE", "SPEAKER"}
_RAYS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")


def _instance_key(instance):
    """What an instance is in other frames, too."""
    parent = instance.parent.name_full if instance.is_instance and instance.parent is not None else ""
    return (instance.object.name_full, instance.object.type, parent, tuple(instance.persistent_id))


def _is_shown(context, instance):
    if context.depsgraph.mode == "VIEWPORT" and instance.object.original.hide_render:
        return False
    return instance.show_self or (instance.show_particles and instance.object.type == "MESH")


def _blur(instance):
    return blur_of(instance.object, instance.parent if instance.is_instance else None)


@dataclasses.dataclass
class _Keyed:
    """What happens while the shutter is open. matrices: {key of an instance: matrix at each key of the shutter}, None
    where it was not there. camera: its matrices. meshes: see meshes_at_keys."""
    matrices: dict = dataclasses.field(default_factory=dict)
    camera: list = dataclasses.field(default_factory=list)
    meshes: dict = dataclasses.field(default_factory=dict)


def _at_keys(context, shutter):
    """The _Keyed of the shutter. Takes the depsgraph through its time."""
    keyed, deformed = _Keyed(), set()
    for index, frame in enumerate(shutter.frames):
        changed = context.go_to(frame)
        if index > 0:
            deformed |= changed
        for instance in context.depsgraph.object_instances:
            known = keyed.matrices.setdefault(_instance_key(instance), [None] * len(shutter.frames))
            known[index] = instance.matrix_world.copy()
        keyed.camera.append(context.camera_now().matrix_world.copy())
    deformed = {name for name in deformed
                if bpy.data.objects[name].type in _SHOWN and blur_of(bpy.data.objects[name]).deforms}
    if deformed:
        keyed.meshes = meshes_at_keys(context, shutter, deformed)
    return keyed


class _SceneWriter:
    """One scene file in the making."""

    def __init__(self, context, shutter):
        self.context = context
        self.shutter = shutter
        self.surfaces = Surfaces()
        self.placed = {}  # geometry by identity, and its Places, in the order of the depsgraph
        self.lights = []
        self.looked_at = set()  # names of objects
        self.regions = None  # with media, once all are collected

    def walk(self, keyed):
        """Collects what the depsgraph shows. keyed: a _Keyed."""
        for instance in self.context.depsgraph.object_instances:
            obj = instance.object
            if obj.type in _NOTHING or not _is_shown(self.context, instance):
                continue
            now, blur = instance.matrix_world.copy(), _blur(instance)
            matrices = [now]
            if blur.keys > 1:
                known = keyed.matrices.get(_instance_key(instance), [now])
                matrices = [matrix or now for matrix in self.shutter.some(known, blur.keys)]
            place = Place(self.shutter, matrices)
            if obj.type == "LIGHT":
                self.lights += export_light(self.context, obj, place)
            elif obj.type in _SHOWN:
                self._report(obj, instance.is_instance)
                self.context.go_on()
                states = keyed.meshes.get(obj.original.session_uid) if blur.deforms else None
                if states and not has_own_data(self.context, obj):
                    states = None
                if states:
                    states = dict(zip(self.shutter.some(self.shutter.seconds, blur.keys),
                                      self.shutter.some(states, blur.keys), strict=True))
                geometry = geometry_of(self.context, obj, instance.show_self, instance.show_particles, states)
                if geometry.parts:
                    self.placed.setdefault(geometry, []).append(place)
            else:
                self.context.report.add(f"objects of type {obj.type} are not exported", obj.name)

    def _report(self, obj, is_instance):
        if obj.name_full in self.looked_at:
            return
        self.looked_at.add(obj.name_full)
        report = self.context.report
        if obj.is_holdout or obj.is_shadow_catcher:
            report.add("a holdout or shadow catcher is exported as any other object", obj.name)
        if is_instance and differs(slot.material for slot in obj.material_slots):
            report.add("what its material has of the object and its place is the same for all instances", obj.name)
        hidden = [ray.replace("_", " ") for ray in _RAYS if not getattr(obj, f"visible_{ray}")]
        if hidden:
            report.add(f"invisible to {', '.join(hidden)} rays, but exported as visible", obj.name)

    def _shapes(self, geometry, place, media_of):
        """The <shape> elements of the parts; without a place they are in their own space. media_of: the Place where their
        media are."""
        for part in geometry.parts:
            shape = copy.deepcopy(part.shape)
            sides = self.regions.sides(part, media_of) if part.outline is not None else ()
            if part.within is not None:
                place.then(lambda matrix, within=part.within: matrix @ within).add_to(shape)
            elif place is not None:
                place.add_to(shape)
            self.surfaces.add_to(shape, part.surface, part.name, *sides)
            yield shape

    def _is_alike(self, geometry, places):
        """Whether the parts are the same in all places: with no grid, and no medium around them."""
        return not any(part.within is not None or any(self.regions.around_part(part, place) for place in places)
                       for part in geometry.parts if part.outline is not None)

    def shapes(self):
        """Shapes of what is shown once; groups and instances of what is shown several times."""
        shapes = []
        self.regions = Regions(self.context, self.placed,
                               export_world_medium(shown_world(self.context), self.context))
        for geometry, places in self.placed.items():
            if len(places) == 1 or not self._is_alike(geometry, places):
                for place in places:
                    shapes += self._shapes(geometry, place, place)
                continue
            group = plugin("shape", "shapegroup", f"group {len(shapes)}")
            group.extend(self._shapes(geometry, None, places[0]))
            shapes.append(group)
            for place in places:
                instance = plugin("shape", "instance")
                place.add_to(instance)
                add_reference(instance, group.get("id"))
                shapes.append(instance)
        return shapes

    def add_camera_medium(self, sensor, camera):
        """Refers to what is around the evaluated camera."""
        medium = self.regions.element(self.regions.around(numpy.array(camera.matrix_world.translation)))
        if medium is not None:
            self.surfaces.add_medium_to(sensor, medium, camera.name, "medium")


def _integrator(scene, has_media):
    settings = settings_of(scene)
    kind = settings.integrator if settings.integrator != "auto" else "volpathmis" if has_media else "path"
    integrator = plugin("integrator", "path" if kind == "path_mis" else kind)
    if kind not in {"ao", "normals"}:
        add_value(integrator, "integer", "max_depth", settings.max_depth)
        if scene.render.film_transparent:  # the world lights, but is not seen
            add_value(integrator, "boolean", "hide_emitters", True)
    return integrator


def export_scene(context, scene, name="scene"):
    """Writes NAME.xml in the context's folder: the scene as its depsgraph has it. Returns the path.

    With motion blur the depsgraph is taken through the time of the shutter, and back, if the context can do so.
    """
    context.note_updates()
    camera = context.camera_now()
    keys = 1
    if context.frame_set is not None and camera is not None and scene.render.use_motion_blur:
        keys = max([blur_of(camera).keys, *(_blur(instance).keys for instance in context.depsgraph.object_instances)])
    shutter, keyed, now = Shutter(scene, keys), _Keyed(), scene.frame_current
    if shutter.is_open:
        keyed = _at_keys(context, shutter)
        context.go_to(shutter.middle)
        camera = context.camera_now()
    writer = _SceneWriter(context, shutter)
    writer.walk(keyed)
    shapes = writer.shapes()
    element = Element("scene", {"version": "3.0.0"})
    element.append(_integrator(scene, bool(writer.regions.regions) or writer.regions.everywhere is not None))
    if camera is None:
        context.report.add("the scene has no camera")
    else:
        keys = blur_of(camera).keys
        blurred = shutter.is_open and keys > 1
        place = Place(shutter, shutter.some(keyed.camera, keys) if blurred else [camera.matrix_world.copy()])
        sensor = export_camera(context, scene, camera, place)
        writer.add_camera_medium(sensor, camera)
        element.append(sensor)
    element.extend(export_world(context, shown_world(context)))
    element.extend(writer.surfaces.elements)
    element.extend(writer.lights)
    element.extend(shapes)
    if shutter.is_open:
        context.go_to(now)
    path = context.folder / f"{name}.xml"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_scene(element, path)
    return path
