"""Scenes of one feature each, made in bpy: UNIT_SCENES[name](scene) fills an empty_scene.

Their light is direct and simple, so that few samples tell a wrong factor, place or orientation.
"""

import math
import os
import tempfile

import bpy
import mathutils
import numpy

from cycles_comparison import add_camera, set_world
from material_scenes import add_node, link, material

from blender.export.grids import GridError, openvdb_module

UNIT_SCENES = {}


def unit_scene(make):
    UNIT_SCENES[make.__name__] = make
    return make


def diffuse(colour=(0.8, 0.8, 0.8)):
    """A material of one Diffuse BSDF."""
    material = bpy.data.materials.new("diffuse")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*colour, 1)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def emission(colour=(1, 1, 1), strength=1.0):
    """A material that only emits."""
    material = bpy.data.materials.new("emission")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*colour, 1)
    shader.inputs["Strength"].default_value = strength
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def metal(roughness):
    material = bpy.data.materials.new("metal")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Metallic"].default_value, shader.inputs["Roughness"].default_value = 1, roughness
    return material


def active(*materials):
    """The object that was added last, with materials."""
    obj = bpy.context.object
    for material in materials:
        obj.data.materials.append(material)
    return obj


def floor(size=6, colour=(0.8, 0.8, 0.8)):
    bpy.ops.mesh.primitive_plane_add(size=size)
    return active(diffuse(colour))


def add_light(scene, kind, location, target=(0, 0, 0), **settings):
    light = bpy.data.lights.new(kind, kind)
    for name, value in settings.items():
        setattr(light, name, value)
    obj = bpy.data.objects.new(kind, light)
    obj.location = location
    obj.rotation_euler = (mathutils.Vector(target) - obj.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(obj)
    return obj


def sunny(scene, energy=3.0):
    """A sun without width from the left above, and a grey sky, so that no normal is lost in the dark."""
    set_world(scene, (0.2, 0.2, 0.2))
    return add_light(scene, "SUN", (-2, -3, 5), energy=energy, angle=0)


def markers(scene):
    """Three emitting squares of different colours and sizes on a black floor, which tell all mirror images apart."""
    for place, size, colour in (((1.2, 0.5, 0), 0.8, (1, 0.1, 0.1)), ((-0.8, 1.0, 0), 0.5, (0.1, 1, 0.1)),
                                ((-0.4, -0.9, 0), 1.1, (0.1, 0.1, 1))):
        bpy.ops.mesh.primitive_plane_add(size=size, location=place)
        active(emission(colour))


def walls(scene):
    """Six emitting squares around the origin, each of another colour."""
    for axis, colour in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1))):
        place = mathutils.Vector([2 if axis % 3 == i else 0 for i in range(3)]) * (1 if axis < 3 else -1)
        bpy.ops.mesh.primitive_plane_add(size=3, location=place, rotation=place.to_track_quat("Z", "Y").to_euler())
        active(emission(colour))


# Geometry


@unit_scene
def smooth_normals(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    bpy.ops.object.shade_smooth()
    active(diffuse())
    sunny(scene)
    add_camera(scene, (0, -5, 1), (0, 0, 0), 26)


@unit_scene
def flat_normals(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    active(diffuse())
    sunny(scene)
    add_camera(scene, (0, -5, 1), (0, 0, 0), 26)


@unit_scene
def custom_normals(scene):
    obj = floor(3)
    tilted = mathutils.Vector((0.5, -0.2, 1)).normalized()
    obj.data.normals_split_custom_set([tilted, (0, 0, 1), (0, 0, 1), tilted])
    sunny(scene)
    add_camera(scene, (0, -1, 5), (0, 0, 0), 40)


@unit_scene
def material_slots(scene):
    bpy.ops.mesh.primitive_cube_add(size=1.5)
    obj = active(diffuse((0.8, 0.1, 0.1)), diffuse((0.1, 0.8, 0.1)), diffuse((0.1, 0.1, 0.8)))
    for index, face in enumerate(obj.data.polygons):
        face.material_index = index % 3
    sunny(scene)
    add_camera(scene, (2, -4, 3), (0, 0, 0), 30)


@unit_scene
def colour_attribute(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=3)
    obj = active(diffuse())
    attribute = obj.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    colours = numpy.random.default_rng(1).uniform(0.1, 0.9, (len(attribute.data), 4)).astype("f")
    attribute.data.foreach_set("color", colours.ravel())
    tree = obj.data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "Paint"
    tree.links.new(node.outputs["Color"], next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE").inputs["Color"])
    sunny(scene)
    add_camera(scene, (0, -1, 5), (0, 0, 0), 40)


@unit_scene
def normal_map_of_a_coarse_mesh(scene):
    """A leaning normal all over three balls of few faces, whose tangents differ at every corner. The texture of the second
    is mirrored at its middle, and the third ball is."""
    made, shader, _ = material("leaning", "ShaderNodeBsdfDiffuse", {"Color": (0.8, 0.8, 0.8)})
    image = bpy.data.images.new("leaning", 1, 1, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels = (0.5 + 0.3, 0.5 + 0.2, 0.5 + 0.3464, 1)
    node, texture = add_node(made, "ShaderNodeNormalMap"), add_node(made, "ShaderNodeTexImage")
    texture.image = image
    link(made, texture.outputs["Color"], node.inputs["Color"])
    link(made, node.outputs["Normal"], shader.inputs["Normal"])
    for index in range(3):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=7, ring_count=5, radius=0.75, location=(1.6 * (index - 1), 0, 0),
                                             rotation=(0.5, 0.3, 0.4))
        obj = active(made)
        bpy.ops.object.shade_smooth()
        if index == 1:
            for uv in obj.data.uv_layers[0].uv:
                uv.vector.x = abs(uv.vector.x - 0.5)
        if index == 2:
            obj.scale = (-1, 0.8, 1.2)
    sunny(scene)
    add_camera(scene, (0, -7, 1.5), (0, 0, 0), 40)


@unit_scene
def collection_instances(scene):
    """Also mirrored, stretched and nested."""
    inner = bpy.data.collections.new("inner")
    bpy.ops.mesh.primitive_torus_add(major_radius=0.4, minor_radius=0.2, location=(0.3, 0, 0.2), rotation=(0.7, 0.5, 0))
    obj = active(diffuse((0.8, 0.4, 0.2)))
    bpy.ops.object.shade_smooth()
    scene.collection.objects.unlink(obj)
    inner.objects.link(obj)
    outer = bpy.data.collections.new("outer")
    for x in (-0.6, 0.6):
        empty = bpy.data.objects.new("inside", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", inner
        empty.location, empty.scale = (x, 0, 0), (1 if x > 0 else -0.7, 1, 0.8)
        outer.objects.link(empty)
    for y, scale in ((-0.5, (1, 1, 1)), (1.2, (1, -1, 1.5))):
        empty = bpy.data.objects.new("outside", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", outer
        empty.location, empty.scale, empty.rotation_euler = (0, y, 0), scale, (0, 0, 0.3)
        scene.collection.objects.link(empty)
    sunny(scene)
    add_camera(scene, (1, -5, 4), (0, 0.3, 0), 32)


@unit_scene
def render_modifiers(scene):
    """The viewport shows fewer subdivisions than renders do."""
    bpy.ops.mesh.primitive_cube_add(size=1.8)
    obj = active(diffuse())
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 3
    bpy.ops.object.shade_smooth()
    sunny(scene)
    add_camera(scene, (2, -4, 2), (0, 0, 0), 30)


@unit_scene
def bevelled_curve(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=1)
    obj = active(diffuse((0.3, 0.8, 0.5)))
    obj.data.bevel_depth, obj.data.bevel_resolution = 0.25, 3
    sunny(scene)
    add_camera(scene, (1, -4, 3), (0, 0, 0), 36)


@unit_scene
def metaballs(scene):
    for x in (-0.5, 0.5):
        bpy.ops.object.metaball_add(radius=0.9, location=(x, 0, 0))
        bpy.context.object.data.render_resolution = 0.1
        active(diffuse())
    sunny(scene)
    add_camera(scene, (0, -5, 2), (0, 0, 0), 30)


@unit_scene
def text(scene):
    bpy.ops.object.text_add(location=(-0.9, -0.5, 0))
    obj = active(diffuse((0.9, 0.8, 0.2)))
    obj.data.body, obj.data.extrude = "R4", 0.1
    obj.data.size = 1.6
    sunny(scene)
    add_camera(scene, (0.3, -1, 5), (0, 0, 0), 30)


@unit_scene
def geometry_nodes_instances(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=2, size=2.5)
    obj = active(diffuse((0.2, 0.5, 0.8)))
    tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    given, result = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    points = tree.nodes.new("GeometryNodeInstanceOnPoints")
    cone = tree.nodes.new("GeometryNodeMeshCone")
    cone.inputs["Radius Bottom"].default_value, cone.inputs["Depth"].default_value = 0.3, 0.8
    points.inputs["Rotation"].default_value = (0.3, 0.2, 0)
    material = tree.nodes.new("GeometryNodeSetMaterial")
    material.inputs["Material"].default_value = obj.data.materials[0]
    for source, target in ((given.outputs[0], points.inputs["Points"]), (cone.outputs[0], points.inputs["Instance"]),
                           (points.outputs[0], material.inputs[0]), (material.outputs[0], result.inputs[0])):
        tree.links.new(source, target)
    obj.modifiers.new("Nodes", "NODES").node_group = tree
    sunny(scene)
    add_camera(scene, (1, -5, 4), (0, 0, 0), 36)


@unit_scene
def hair_curves(scene):
    """Thick straight ones: their silhouettes do not depend on how splines are drawn."""
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "THICK"
    data = bpy.data.hair_curves.new("hair")
    data.add_curves([4] * 5)
    positions = numpy.array([[(x * 0.5, 0, 0.5 * z - 0.75) for z in range(4)] for x in range(-2, 3)], "f")
    data.attributes["position"].data.foreach_set("vector", positions.ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", numpy.full(20, 0.12, "f"))
    data.materials.append(diffuse())
    scene.collection.objects.link(bpy.data.objects.new("hair", data))
    sunny(scene)
    add_camera(scene, (0, -5, 0.5), (0, 0, 0), 30)


@unit_scene
def hair_of_pigments(scene):
    """Its scales lean, which tells the root from the tip."""
    hair_curves(scene)
    made, _, _ = material("hair", "ShaderNodeBsdfHairPrincipled", {"Melanin": 0.5, "Melanin Redness": 0.4, "Offset": 0.1},
                          model="CHIANG", parametrization="MELANIN")
    next(obj for obj in scene.objects if obj.type == "CURVES").data.materials[0] = made


def particle_system(obj, kind, count):
    obj.modifiers.new("Particles", "PARTICLE_SYSTEM")
    system = obj.particle_systems[-1]
    system.seed = 3
    settings = system.settings
    settings.type, settings.count, settings.emit_from = kind, count, "FACE"
    return settings


@unit_scene
def particle_instances(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=10, ring_count=8, location=(0, 0, -9))
    ball = active(diffuse((0.8, 0.3, 0.2)))
    settings = particle_system(floor(3), "EMITTER", 30)
    settings.frame_start, settings.frame_end, settings.physics_type = 0, 0, "NO"
    settings.render_type, settings.instance_object, settings.particle_size = "OBJECT", ball, 0.15
    scene.frame_set(2)
    sunny(scene)
    add_camera(scene, (0, -3, 4), (0, 0, 0), 42)


@unit_scene
def particle_hair(scene):
    """Straight strands: their silhouettes do not depend on how splines are drawn. They do not taper, of which Cycles'
    normals know nothing, and no end is in view, since Cycles never shows the inside of a tube."""
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "THICK"
    settings = particle_system(floor(3), "HAIR", 20)
    settings.hair_length, settings.root_radius, settings.tip_radius = 0.8, 1.0, 1.0
    settings.radius_scale, settings.use_close_tip = 0.2, False
    sunny(scene)
    add_camera(scene, (0, -6, 0.3), (0, 0, 0.3), 30)


@unit_scene
def unit_scale(scene):
    """Scenes in centimetres have the same light and the same lens."""
    scene.unit_settings.system, scene.unit_settings.scale_length = "METRIC", 0.01
    floor()
    camera = add_camera(scene, (0, -4, 4), (0, 0, 0), 40).data
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 3, 0.2
    add_light(scene, "POINT", (0.5, 0, 1.5), energy=100, shadow_soft_size=0)


# Cameras


@unit_scene
def shifted_view(scene):
    markers(scene)
    camera = add_camera(scene, (0, 0, 6), (0, 0, 0), 40).data
    camera.shift_x, camera.shift_y = 0.12, -0.07


@unit_scene
def vertical_fit(scene):
    markers(scene)
    camera = add_camera(scene, (0, 0, 6), (0, 0, 0), 40).data
    camera.sensor_fit, camera.sensor_height, camera.lens, camera.shift_y = "VERTICAL", 20, 35, 0.1


@unit_scene
def tall_pixels(scene):
    markers(scene)
    scene.render.pixel_aspect_y = 1.6
    camera = add_camera(scene, (0, 0, 6), (0, 0, 0), 40).data
    camera.shift_x, camera.shift_y = 0.05, 0.1


@unit_scene
def orthographic(scene):
    markers(scene)
    camera = add_camera(scene, (1, 1, 6), (0, 0, 0), 40).data
    camera.type, camera.ortho_scale, camera.shift_x, camera.shift_y = "ORTHO", 4, 0.1, -0.05


@unit_scene
def depth_of_field(scene):
    markers(scene)
    camera = add_camera(scene, (0, 0, 3), (0, 0, 0), 60).data
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 1.5, 0.1
    camera.dof.aperture_blades, camera.dof.aperture_rotation = 3, 0.4


def panorama(scene, kind, **settings):
    walls(scene)
    camera = add_camera(scene, (0.1, 0.2, 0.1), (0.4, 2, 0.5), 40).data
    camera.type = "PANO"
    owner = camera if hasattr(camera, "panorama_type") else camera.cycles
    owner.panorama_type = kind
    for name, value in settings.items():
        setattr(owner, name, value)


@unit_scene
def equirectangular(scene):
    panorama(scene, "EQUIRECTANGULAR", longitude_min=-2.5, longitude_max=1.5, latitude_min=-1, latitude_max=1.3)


@unit_scene
def all_around(scene):
    panorama(scene, "EQUIRECTANGULAR")


@unit_scene
def fisheye_equidistant(scene):
    scene.render.resolution_x = scene.render.resolution_y
    panorama(scene, "FISHEYE_EQUIDISTANT", fisheye_fov=math.radians(200))


@unit_scene
def fisheye_equisolid(scene):
    panorama(scene, "FISHEYE_EQUISOLID", fisheye_lens=8.0, fisheye_fov=math.radians(170))


@unit_scene
def cylindrical(scene):
    if bpy.app.version < (4, 5):
        return "Blender 4.2 has no cylindrical panorama"
    panorama(scene, "CENTRAL_CYLINDRICAL", central_cylindrical_range_u_min=-2.0, central_cylindrical_range_u_max=1.0,
             central_cylindrical_range_v_min=-0.8, central_cylindrical_range_v_max=1.2, central_cylindrical_radius=1.5)
    return None


# Lights


@unit_scene
def point(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "POINT", (0.5, 0, 1.5), energy=100, shadow_soft_size=0, color=(1, 0.5, 0.2))


@unit_scene
def point_with_radius(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "POINT", (0.5, 0, 3.5), energy=100, shadow_soft_size=0.4, use_soft_falloff=False).scale = (2, 2, 2)


def lamps_in_view(scene):
    """The camera does not see them."""
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "POINT", (0.3, 0, 1), energy=50, shadow_soft_size=0.1, use_soft_falloff=False)


@unit_scene
def point_in_view(scene):
    lamps_in_view(scene)
    set_world(scene, (0.1, 0.1, 0.1))


@unit_scene
def area_in_view(scene):
    lamps_in_view(scene)
    add_light(scene, "AREA", (-0.8, 1, 0.8), (0, -4, 2), energy=30, shape="SQUARE", size=0.5)


@unit_scene
def lamps_that_the_camera_sees(scene):
    area_in_view(scene)
    for obj in scene.objects:
        obj.visible_camera = True


@unit_scene
def lamps_in_a_mirror(scene):
    """Without a floor, on which mirrors would make noise."""
    bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 2, 1), rotation=(math.pi / 2, 0, 0))
    active(metal(0))
    add_camera(scene, (0, -4, 2), (0, 0, 1), 40)
    add_light(scene, "POINT", (0.5, 0, 1), energy=50, shadow_soft_size=0.3, use_soft_falloff=False)
    add_light(scene, "AREA", (-0.8, 0.5, 0.8), (0, 4, 1), energy=30, shape="SQUARE", size=0.5)


@unit_scene
def spot(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "SPOT", (-1, 0, 2), (0.5, 0.3, 0), energy=100, shadow_soft_size=0, spot_size=1.2, spot_blend=0.6)


@unit_scene
def sun(scene):
    floor()
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5))
    active(diffuse())
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "SUN", (-1, -1, 2), energy=3, angle=0)


@unit_scene
def spot_with_radius(scene):
    floor()
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.2, 0, 0.5))
    active(diffuse())
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "SPOT", (-1, 0, 2), (0.2, 0.1, 0), energy=100, shadow_soft_size=0.4, spot_size=1.3,
              spot_blend=0.6, use_soft_falloff=False).scale = (2, 2, 2)


@unit_scene
def sun_of_an_angle(scene):
    floor()
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5))
    active(diffuse())
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "SUN", (-1, -1, 2), energy=3, angle=0.5)


@unit_scene
def sun_in_metal(scene):
    """In a mirror and on rough metal; the camera does not see it itself."""
    bpy.ops.mesh.primitive_plane_add(size=6)
    active(metal(0))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.7, location=(1, 0, 0.7))
    bpy.ops.object.shade_smooth()
    active(metal(0.3))
    set_world(scene, (0.1, 0.1, 0.1))
    add_camera(scene, (0, -4, 4), (0, 0, 0.4), 40)
    add_light(scene, "SUN", (0, 4, 3.5), energy=3, angle=0.3)


@unit_scene
def area_rectangle(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    lamp = add_light(scene, "AREA", (-1, 0.5, 2.5), energy=80, shape="RECTANGLE", size=0.5, size_y=1.5)
    lamp.scale = (2, 0.7, 1)


@unit_scene
def area_ellipse(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "AREA", (-1, 0.5, 2.5), energy=80, shape="ELLIPSE", size=0.5, size_y=1.5)


@unit_scene
def area_spread(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "AREA", (-1, 0.5, 2), (-0.2, 0.2, 0), energy=80, shape="RECTANGLE", size=0.5, size_y=1,
              spread=1.2)
    add_light(scene, "AREA", (1, 0.5, 2), (0.7, 0.2, 0), energy=30, shape="DISK", size=0.3, spread=0.5)


@unit_scene
def strength_without_area(scene):
    if bpy.app.version < (4, 5):
        return "lamps of Blender 4.2 always share their power over their area"
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "AREA", (-1, 0.5, 2.5), energy=20, shape="SQUARE", size=0.5, normalize=False, exposure=1.5,
              use_temperature=True, temperature=3500)
    add_light(scene, "POINT", (1, 0.5, 3.5), energy=10, shadow_soft_size=0.3, normalize=False, use_soft_falloff=False)
    return None


@unit_scene
def nodes_of_lamps(scene):
    floor()
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    light = add_light(scene, "POINT", (0.5, 0, 1.5), energy=100, shadow_soft_size=0).data
    light.use_nodes = True
    node = next(node for node in light.node_tree.nodes if node.type == "EMISSION")
    node.inputs["Strength"].default_value, node.inputs["Color"].default_value = 0.5, (0.2, 0.9, 0.4, 1)


# Volumes


def volume(bl_idname, values):
    """A material of one volume shader."""
    made, shader, output = material("volume", "ShaderNodeBsdfDiffuse")
    made.node_tree.nodes.remove(shader)
    link(made, add_node(made, bl_idname, values).outputs[0], output.inputs["Volume"])
    return made


@unit_scene
def media_within_each_other(scene):
    """The camera is in the outer one."""
    floor()
    for size, place, values in ((8, (0, -1, 2), {"Color": (0.9, 0.6, 0.3), "Density": 0.3}),
                                (1, (0.3, 0, 0.7), {"Color": (0.2, 0.6, 0.8)})):
        bpy.ops.mesh.primitive_cube_add(size=size, location=place)
        active(volume("ShaderNodeVolumeAbsorption", values))
    set_world(scene, (1, 1, 1))
    add_camera(scene, (0, -4, 2), (0, 0, 0.3), 40)


def density_grid(scene, name, density=3.0):
    """A ball's fog of a modifier in a Volume object, which fades within its surface."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    ball = bpy.context.object
    ball.hide_render = True
    obj = bpy.data.objects.new(name, bpy.data.volumes.new(name))
    scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("Fog", "MESH_TO_VOLUME")
    modifier.object, modifier.density, modifier.interior_band_width = ball, density, 0.5
    modifier.resolution_mode, modifier.voxel_size = "VOXEL_SIZE", 0.2
    obj.data.materials.append(volume("ShaderNodeVolumePrincipled", {"Color": (0, 0, 0), "Absorption Color": (0, 0, 0),
                                                                    "Density": 1.0}))
    return obj


def scaled_density_grid(scene, scale, space):
    obj = density_grid(scene, "grid")
    obj.scale, obj.data.render.space = scale, space
    set_world(scene, (1, 1, 1))
    add_camera(scene, (0, -5, 1), (0, 0, 0), 40)


@unit_scene
def stretched_grid(scene):
    """It is as opaque as before along its diagonal."""
    scaled_density_grid(scene, (1.6, 0.7, 0.5), "OBJECT")


@unit_scene
def scaled_grid(scene):
    """It is less opaque as a whole."""
    scaled_density_grid(scene, (0.6, 0.6, 0.6), "WORLD")


def grid_volume(scene, grids, **inputs):
    """An object of a file with grids, {name: (x, y, z) or (x, y, z, 3)}, and a Principled Volume. Returns why it cannot
    be made, or None."""
    try:
        openvdb = openvdb_module()
    except GridError as reason:
        return str(reason)
    made = []
    for name, values in grids.items():
        grid = openvdb.FloatGrid() if values.ndim == 3 else openvdb.Vec3SGrid()
        grid.name = name
        grid.copyFromArray(values.astype("f"))
        grid.transform = openvdb.createLinearTransform(voxelSize=0.1)
        made.append(grid)
    data = bpy.data.volumes.new("volume")
    data.filepath = os.path.join(_FOLDER.name, f"{'-'.join(grids)}.vdb")
    openvdb.write(data.filepath, made)
    obj = bpy.data.objects.new("volume", data)
    obj.scale, obj.location = (1.5, 1.5, 1.5), (-1.5, -1.8, -1.2)
    scene.collection.objects.link(obj)
    data.materials.append(volume("ShaderNodeVolumePrincipled", inputs))
    if hasattr(scene.cycles, "volume_unbiased"):  # its steps let more light through
        scene.cycles.volume_unbiased = True
    else:
        scene.cycles.volume_step_rate = 0.1
    add_camera(scene, (3, -8, 3), (0, 0, 0), 30)
    return None


def waves(cells=(16, 24, 16)):
    """Values between 0 and 1 on a grid."""
    x, y, z = numpy.meshgrid(*(numpy.arange(count) / count for count in cells), indexing="ij")
    return 0.5 + 0.5 * numpy.sin(7 * x + 2) * numpy.cos(9 * y) * numpy.cos(5 * z + 1)


@unit_scene
def absorbing_grid(scene):
    set_world(scene, (0.9, 0.8, 0.7))
    return grid_volume(scene, {"density": waves()}, **{"Color": (0, 0, 0), "Absorption Color": (0, 0, 0), "Density": 1.0})


def fire(scene, grids, absorption=(1, 1, 1)):
    """Only red: at these temperatures Cycles' green and blue are small or below 0, which other programs cut off."""
    why_not = grid_volume(scene, grids, **{"Color": (0, 0, 0), "Absorption Color": absorption, "Density": 1.0,
                                           "Blackbody Intensity": 1.0, "Blackbody Tint": (1, 0, 0), "Temperature": 1.0})
    if hasattr(scene.cycles, "volume_biased"):  # much faster
        scene.cycles.volume_biased, scene.cycles.volume_step_rate = True, 0.1
    return why_not


@unit_scene
def fire_on_a_grid(scene):
    """It fades from hot voxels to the cold around it."""
    return fire(scene, {"temperature": 800 + 1200 * waves()})


@unit_scene
def fire_in_smoke(scene):
    """Black bodies of one of two grids."""
    return fire(scene, {"temperature": 800 + 1200 * waves(), "density": waves()[::-1]}, absorption=(0, 0, 0))


@unit_scene
def world_volume(scene):
    floor()
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(0, 0, 0.6))
    active(diffuse((0.8, 0.3, 0.1)))
    tree = scene.world.node_tree
    shader = add_node(scene.world, "ShaderNodeVolumePrincipled", {
        "Density": 0.15, "Color": (0.3, 0.5, 0.7), "Emission Strength": 0.02, "Emission Color": (0.2, 1, 0.2)})
    tree.links.new(shader.outputs[0], next(node for node in tree.nodes if node.type == "OUTPUT_WORLD").inputs["Volume"])
    add_camera(scene, (0, -4, 4), (0, 0, 0), 40)
    add_light(scene, "POINT", (1, -1, 2.5), energy=100, shadow_soft_size=0)


# The world


@unit_scene
def world_colour(scene):
    bpy.ops.mesh.primitive_uv_sphere_add()
    active(diffuse())
    set_world(scene, (0.3, 0.6, 0.9), 1.7)
    add_camera(scene, (0, -4, 1), (0, 0, 0), 40)


def environment(scene, folder):
    """An image of the sphere whose colours tell all directions apart, and its nodes."""
    width, height = 128, 64
    image = bpy.data.images.new("sphere", width, height, float_buffer=True)
    pixels = numpy.ones((height, width, 4), "f")
    pixels[..., 0] = (numpy.arange(width) / width)[None]
    pixels[..., 1] = (numpy.arange(height) / height)[:, None]
    pixels[..., 2] = 0.2
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = os.path.join(folder, "sphere.exr"), "OPEN_EXR"
    image.save()
    tree = scene.world.node_tree
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    place = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = bpy.data.images.load(image.filepath_raw)
    texture.image.colorspace_settings.name = "Linear Rec.709"
    texture.interpolation = "Linear"
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value = 2.5
    for source, target in ((place.outputs["Generated"], mapping.inputs["Vector"]),
                           (mapping.outputs[0], texture.inputs[0]), (texture.outputs[0], background.inputs["Color"])):
        tree.links.new(source, target)
    mapping.inputs["Rotation"].default_value = (0.3, -0.2, 1.1)
    return mapping


_FOLDER = tempfile.TemporaryDirectory()


@unit_scene
def world_image(scene):
    environment(scene, _FOLDER.name)
    add_camera(scene, (0, 0, 0), (0.5, 1, 0.3), 80)


@unit_scene
def world_image_turned_back(scene):
    environment(scene, _FOLDER.name).vector_type = "TEXTURE"
    add_camera(scene, (0, 0, 0), (-0.5, -1, 0.3), 80)


@unit_scene
def world_sky(scene):
    """Baked, with the sun's disk, which lights the floor."""
    floor()
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type = "NISHITA" if bpy.app.version < (5, 0) else "SINGLE_SCATTERING"
    sky.sun_elevation, sky.sun_rotation = 0.6, 0.8
    tree.links.new(sky.outputs[0], next(node for node in tree.nodes if node.type == "BACKGROUND").inputs["Color"])
    add_camera(scene, (0, -4, 2), (0, 0, 0), 70)


# Motion


def keyed(obj, path, first, last, frames=(0, 4)):
    """The property goes evenly from the first to the last value."""
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    for frame, value in zip(frames, (first, last)):
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)


def blurred(scene):
    scene.frame_set(2)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0


@unit_scene
def moving_object(scene):
    markers(scene)
    add_camera(scene, (0, 0, 6), (0, 0, 0), 40)
    keyed(bpy.context.object, "location", (-2, -0.9, 0), (2, -0.5, 0))
    blurred(scene)


@unit_scene
def moving_camera(scene):
    markers(scene)
    keyed(add_camera(scene, (0, 0, 6), (0, 0, 0), 40), "location", (-2, 0, 6), (1, 1, 6))
    blurred(scene)
    scene.render.motion_blur_position = "START"


def strip(scene):
    """A row of emitting squares over a floor, lit from above, so that shading tells normals, too."""
    floor(8, (0.5, 0.5, 0.5))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=12, size=1, location=(0, 0, 0.3))
    obj = active(diffuse((0.9, 0.3, 0.1)), emission((0.1, 0.4, 0.9), 0.5))
    obj.scale = (0.8, 3, 1)
    for index, face in enumerate(obj.data.polygons):
        face.material_index = index % 3 == 0
    sunny(scene)
    add_camera(scene, (0, -1, 7), (0, 0, 0), 40)
    return obj


@unit_scene
def armature(scene):
    """Bones that turn, by 69 degrees while the shutter is open, in an object that turns, too."""
    obj = strip(scene)
    bpy.ops.object.shade_smooth()
    bpy.ops.object.transform_apply(location=False, rotation=False)
    bpy.ops.object.armature_add(location=(0, -1.5, 0.3))
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    lower = rig.data.edit_bones[0]
    lower.head, lower.tail = (0, 0, 0), (0, 1.5, 0)
    upper = rig.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 1.5, 0), (0, 3, 0), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in rig.data.bones:
        group = obj.vertex_groups.new(name=bone.name)
        for vertex in obj.data.vertices:
            share = min(max(0.5 + vertex.co.y / 0.8, 0), 1)
            group.add([vertex.index], share if bone.name == "upper" else 1 - share, "REPLACE")
    obj.modifiers.new("rig", "ARMATURE").object = rig
    bone = rig.pose.bones["upper"]
    bone.rotation_mode = "XYZ"
    keyed(bone, "rotation_euler", (0, 0, -2.4), (0.6, 0, 2.4))
    keyed(obj, "rotation_euler", (0, 0, 0), (0, 0, 0.8))
    obj.cycles.motion_steps = 3
    blurred(scene)


@unit_scene
def shape_key(scene):
    obj = strip(scene)
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="wide")
    for point in key.data:
        point.co.x *= 3
        point.co.y *= 0.4
        point.co.z += 0.5 * point.co.x
    keyed(key, "value", 0.0, 2.0)
    blurred(scene)
    scene.render.motion_blur_position = "START"


@unit_scene
def without_deformation_blur(scene):
    """A shape key that is not blurred, for its object's settings, and an object that is not."""
    shape_key(scene)
    bpy.context.object.cycles.use_deform_motion = False
    bpy.ops.mesh.primitive_cube_add(size=0.6)
    cube = active(diffuse((0.2, 0.8, 0.2)))
    keyed(cube, "location", (-2, 0, 0.5), (4, 1, 0.5))
    cube.cycles.use_motion_blur = False


@unit_scene
def region(scene):
    markers(scene)
    add_camera(scene, (0, 0, 6), (0, 0, 0), 40)
    render = scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.25, 1.0
