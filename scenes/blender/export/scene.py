# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks the evaluated scene and writes it."""

from .cameras import export_camera
from .elements import Element, add_matrix, add_reference, add_value, plugin, write_scene
from .lights import export_light
from .meshes import colours_of_corners, read_mesh, values_of, write_part
from .surfaces import Surfaces
from .world import export_world

_SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


def uvs_of_corners(mesh, name):
    """Coordinates of the UV map, or of the one that is active for rendering: (loops, 2). None without any."""
    layer = mesh.uv_layers.get(name) if name else next((uv for uv in mesh.uv_layers if uv.active_render), None)
    return None if layer is None else values_of(layer.uv, "vector", 2)


class SceneWriter:
    """One scene file in the making."""

    def __init__(self, context):
        self.context = context
        self.surfaces = Surfaces(context)
        self.placed = {}  # (key, matrices): geometry that is shown, in the order of the depsgraph
        self.parts = {}  # key: [(plugin type, path, surface, name)]
        self.lights = []

    def walk(self):
        """Collects what the depsgraph shows."""
        for instance in self.context.depsgraph.object_instances:
            obj = instance.object
            if obj.original.hide_render or not instance.show_self:
                continue
            matrix = instance.matrix_world.copy()
            if obj.type == "LIGHT":
                self.lights += export_light(self.context, obj, matrix)
            elif obj.type in _SURFACES:
                key = self.geometry(obj)
                if self.parts[key]:
                    self.placed.setdefault(key, []).append(matrix)
            elif obj.type not in {"CAMERA", "EMPTY", "LIGHT_PROBE", "ARMATURE", "LATTICE", "SPEAKER"}:
                self.context.report.add(f"objects of type {obj.type} are not exported", obj.name)

    def geometry(self, obj):
        """The key of the parts of an evaluated object, which are written on the first call."""
        materials = tuple(slot.material.as_pointer() if slot.material else 0 for slot in obj.material_slots)
        key = (obj.data.as_pointer(), materials)
        if key not in self.parts:
            mesh = obj.to_mesh()
            self.parts[key] = self.mesh_parts(obj, mesh) if mesh is not None else []
            obj.to_mesh_clear()
        return key

    def mesh_parts(self, obj, mesh):
        arrays = read_mesh(mesh)
        slots = [slot.material for slot in obj.material_slots] or [None]
        parts = []
        for index, material in enumerate(slots):
            # Blender shows faces of slots that are not there with the last one.
            chosen = arrays.slots == index if index + 1 < len(slots) else arrays.slots >= index
            triangles = arrays.triangles[chosen]
            if not len(triangles):
                continue
            surface = self.surfaces.of(material, obj)
            uvs = surface.uvs if surface.uvs is not None else uvs_of_corners(mesh, surface.uv_map)
            colours = {name: colours_of_corners(mesh, name) for name in surface.attributes}
            path = write_part(self.context, arrays, triangles, uvs,
                              {name: table for name, table in colours.items() if table is not None})
            parts.append((path, arrays.normals is None, surface, material.name if material else "default"))
        return parts

    def shapes(self, key, matrix):
        """The <shape> elements of the parts; without a matrix they are in their own space."""
        for path, is_flat, surface, name in self.parts[key]:
            shape = plugin("shape", "ply")
            add_value(shape, "string", "filename", path)
            if is_flat:
                add_value(shape, "boolean", "face_normals", True)
            if matrix is not None:
                add_matrix(shape, matrix)
            self.surfaces.add_to(shape, surface, name)
            yield shape

    def all_shapes(self):
        """Shapes of what is shown once; groups and instances of what is shown several times."""
        shapes = []
        for number, (key, matrices) in enumerate(self.placed.items()):
            if len(matrices) == 1:
                shapes += self.shapes(key, matrices[0])
                continue
            group = plugin("shape", "shapegroup", f"group {number}")
            group.extend(self.shapes(key, None))
            shapes.append(group)
            for matrix in matrices:
                instance = plugin("shape", "instance")
                add_matrix(instance, matrix)
                add_reference(instance, group.get("id"))
                shapes.append(instance)
        return shapes


def export_scene(context, scene, name="scene"):
    """Writes NAME.xml in the context's folder: the scene as its depsgraph has it. Returns the path."""
    writer = SceneWriter(context)
    writer.walk()
    shapes = writer.all_shapes()
    element = Element("scene", {"version": "3.0.0"})
    integrator = plugin("integrator", "path")
    element.append(integrator)
    if scene.camera is None:
        context.report.add("the scene has no camera")
    else:
        element.append(export_camera(context, scene, scene.camera.evaluated_get(context.depsgraph)))
    element.extend(export_world(context, scene.world))
    element.extend(writer.surfaces.elements)
    element.extend(writer.lights)
    element.extend(shapes)
    path = context.folder / f"{name}.xml"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_scene(element, path)
    return path
