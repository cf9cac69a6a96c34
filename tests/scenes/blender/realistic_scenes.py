"""Scenes as users make them, of many objects, materials and lights, made in bpy: REALISTIC_SCENES[name](scene, folder)
fills an empty_scene; image files go to the folder. All that is random has a fixed seed."""

import math
import os

import bpy
import mathutils
import numpy

from cycles_comparison import add_camera, set_world
from material_scenes import add_node, add_shape, link, material
from unit_scenes import add_light, blurred, diffuse, emission, keyed, particle_system

# Of light sources whose edges are soft in Cycles.
SUN_ANGLE = math.radians(2)
SPOT_RADIUS = 0.05

REALISTIC_SCENES = {}
SAMPLES = {}  # per pixel of a picture, of Penumbra and Cycles, chosen by their noise


def realistic_scene(spp, of_cycles=None):
    def register(make):
        REALISTIC_SCENES[make.__name__] = make
        SAMPLES[make.__name__] = spp, of_cycles or spp
        return make
    return register


def principled(name="principled", **values):
    """A Principled BSDF; its inputs by name with _ for spaces."""
    return material(name, None, {key.replace("_", " "): value for key, value in values.items()})


def plain(**values):
    return principled(**values)[0]


def box(low, high, made):
    """An upright box between two corners."""
    low, high = mathutils.Vector(low), mathutils.Vector(high)
    obj = add_shape(bpy.ops.mesh.primitive_cube_add, made, size=1, location=(low + high) / 2)
    obj.scale = high - low
    return obj


def sphere(radius, location, made, segments=48):
    obj = add_shape(bpy.ops.mesh.primitive_uv_sphere_add, made, segments=segments, ring_count=segments // 2,
                    radius=radius, location=location)
    bpy.ops.object.shade_smooth()
    return obj


def cylinder(radius, depth, location, made, **placement):
    obj = add_shape(bpy.ops.mesh.primitive_cylinder_add, made, vertices=48, radius=radius, depth=depth,
                    location=location, **placement)
    bpy.ops.object.shade_smooth_by_angle(angle=0.6)
    return obj


def lathe(profile, location, made):
    """A body of revolution; profile: (radius, height) from below to above."""
    steps = 64
    vertices = [(r * math.cos(2 * math.pi * i / steps), r * math.sin(2 * math.pi * i / steps), z)
                for r, z in profile for i in range(steps)]
    faces = [(row * steps + i, row * steps + (i + 1) % steps, (row + 1) * steps + (i + 1) % steps, (row + 1) * steps + i)
             for row in range(len(profile) - 1) for i in range(steps)]
    mesh = bpy.data.meshes.new("lathe")
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(made)
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(faces), bool))
    obj = bpy.data.objects.new("lathe", mesh)
    obj.location = location
    bpy.context.scene.collection.objects.link(obj)
    return obj


def image_of(name, texels, colourspace="sRGB"):
    """An image of the (height, width, 3 or 4) texels, whose first row is the lowest."""
    height, width, channels = texels.shape
    image = bpy.data.images.new(name, width, height, alpha=channels == 4)
    image.colorspace_settings.name = colourspace
    rgba = numpy.ones((height, width, 4), numpy.float32)
    rgba[..., :channels] = texels
    image.pixels.foreach_set(rgba.ravel())
    image.pack()
    return image


def grain(size, seed, roughness=2.0):
    """Periodic noise (size, size) in [0, 1], whose amplitudes fall with the frequency to the roughness."""
    rng = numpy.random.default_rng(seed)
    frequency = numpy.hypot(numpy.fft.fftfreq(size)[:, None], numpy.fft.fftfreq(size)[None]) * size
    spectrum = numpy.fft.fft2(rng.standard_normal((size, size))) / numpy.maximum(frequency, 1) ** roughness
    noise = numpy.fft.ifft2(spectrum).real
    return (noise - noise.min()) / numpy.ptp(noise)


def planks():
    """Boards of wood, four across and two along."""
    size = 256
    fibre = numpy.repeat(grain(size, 4, 1.0)[:, ::16], 16, axis=1)
    board = (numpy.arange(size)[:, None] // 64 * 7 + numpy.arange(size)[None] // 128 * 3) % 5
    tone = 0.45 + 0.25 * fibre + 0.05 * board
    tone *= numpy.where(numpy.arange(size)[:, None] % 64 < 2, 0.4, 1)
    return image_of("planks", tone[..., None] * [0.95, 0.7, 0.45])


def bricks():
    """Rows of bricks with mortar between."""
    size = 256
    y, x = numpy.mgrid[0:size, 0:size]
    row = y // 32
    x = (x + 32 * (row % 2)) % size
    mortar = (y % 32 < 4) | (x % 64 < 4)
    tone = numpy.random.default_rng(8).uniform(0.6, 1, (8, 4))[row, x // 64] * (0.8 + 0.2 * grain(size, 9))
    texels = numpy.where(mortar[..., None], [0.6, 0.6, 0.55], tone[..., None] * [0.75, 0.35, 0.25])
    return image_of("bricks", texels)


def textured(image, scale=(1, 1, 1), shader="ShaderNodeBsdfPrincipled", **values):
    """A material whose colour is an image, repeated by the scale."""
    made, node, _ = material(image.name, None if shader == "ShaderNodeBsdfPrincipled" else shader, values)
    texture, mapping = add_node(made, "ShaderNodeTexImage"), add_node(made, "ShaderNodeMapping", {"Scale": scale})
    texture.image = image
    link(made, add_node(made, "ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    link(made, mapping.outputs[0], texture.inputs["Vector"])
    link(made, texture.outputs["Color"], node.inputs["Base Color" if "Base Color" in node.inputs else "Color"])
    return made


def sky(scene, folder, softboxes=(), horizon=(0.9, 0.95, 1.0), zenith=(0.25, 0.45, 0.9), ground=(0.25, 0.22, 0.2),
        strength=1.0):
    """An HDR image around the scene: a sky, and bright rectangles (longitude, latitude, size, radiance) in degrees."""
    width, height = 256, 128
    latitude = (numpy.arange(height) + 0.5) / height * 180 - 90
    longitude = (numpy.arange(width) + 0.5) / width * 360 - 180
    up = numpy.clip(latitude / 90, 0, 1)[:, None, None] ** 0.5
    texels = numpy.where(latitude[:, None, None] > 0, (1 - up) * numpy.array(horizon) + up * numpy.array(zenith), ground)
    texels = numpy.broadcast_to(texels, (height, width, 3)).copy()
    for at, above, size, radiance in softboxes:
        inside = (abs(longitude[None] - at) < size / 2) & (abs(latitude[:, None] - above) < size / 2)
        texels[inside] = radiance
    image = bpy.data.images.new("sky", width, height, float_buffer=True)
    rgba = numpy.ones((height, width, 4), numpy.float32)
    rgba[..., :3] = texels
    image.pixels.foreach_set(rgba.ravel())
    image.filepath_raw, image.file_format = os.path.join(folder, "sky.exr"), "OPEN_EXR"
    image.save()
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(image.filepath_raw)
    texture.image.colorspace_settings.name = "Linear Rec.709"
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs[0], background.inputs["Color"])


@realistic_scene(384, 1024)
def interior(scene, folder):
    """A living room by day: a window to the sky and the sun, two area lamps, and a standing lamp."""
    wall, white = diffuse((0.75, 0.72, 0.66)), diffuse((0.85, 0.85, 0.85))
    box((-2.5, -3, -0.1), (2.5, 3, 0), textured(planks(), (3, 4, 1), Roughness=0.35))
    box((-2.5, -3, 2.6), (2.5, 3, 2.7), white)
    box((2.5, -3, 0), (2.6, 3, 2.6), wall)
    box((-2.5, 3, 0), (2.5, 3.1, 2.6), wall)
    box((-2.5, -3.1, 0), (2.5, -3, 2.6), wall)
    for low, high in (((-2.6, -3, 0), (-2.5, 3, 0.8)), ((-2.6, -3, 2.2), (-2.5, 3, 2.6)), ((-2.6, -3, 0.8), (-2.5, 0, 2.2)),
                      ((-2.6, 2.2, 0.8), (-2.5, 3, 2.2)), ((-2.6, 1.05, 0.8), (-2.5, 1.15, 2.2))):
        box(low, high, wall)
    cloth = plain(Base_Color=(0.25, 0.35, 0.5), Roughness=0.9)
    box((0.9, 1.9, 0.15), (2.4, 2.9, 0.5), cloth)
    box((0.9, 2.6, 0.5), (2.4, 2.9, 1.0), cloth)
    wood = plain(Base_Color=(0.35, 0.18, 0.08), Roughness=0.4)
    box((-1.0, 0.6, 0.42), (0.6, 1.5, 0.48), wood)
    for x in (-0.95, 0.5):
        for y in (0.65, 1.4):
            box((x, y, 0), (x + 0.05, y + 0.05, 0.42), wood)
    sphere(0.16, (-0.5, 1.1, 0.64), plain(Base_Color=(0.95, 0.7, 0.3), Metallic=1.0, Roughness=0.25))
    lathe([(0.0, 0.48), (0.09, 0.49), (0.13, 0.6), (0.06, 0.75), (0.08, 0.82)], (0.2, 1.0, 0),
          plain(Base_Color=(0.7, 0.15, 0.1), Roughness=0.2))
    box((-0.4, 2.96, 1.2), (0.6, 3, 1.9), textured(image_of("painting", numpy.stack(
        [grain(64, seed) for seed in (1, 2, 3)], axis=-1)), Roughness=0.6))
    cylinder(0.02, 1.5, (-1.9, 2.5, 0.75), plain(Base_Color=(0.6, 0.6, 0.6), Metallic=1.0, Roughness=0.3))
    sphere(0.17, (-1.9, 2.5, 1.6), emission((1, 0.75, 0.45), 6))
    add_light(scene, "AREA", (1.2, -2.7, 2.55), (0.5, 0.5, 0), energy=70, shape="RECTANGLE", size=1.0, size_y=0.4)
    add_light(scene, "AREA", (-2.0, -2.5, 1.8), (0, 2, 1), energy=25, shape="DISK", size=0.5, color=(1, 0.85, 0.7))
    add_light(scene, "SUN", (-4, -0.6, 3.2), energy=4, angle=SUN_ANGLE, color=(1, 0.9, 0.75))
    sky(scene, folder, strength=0.6)
    add_camera(scene, (0.9, -2.8, 1.5), (-0.25, 1.6, 0.85), 66)


@realistic_scene(192)
def product(scene, folder):
    """A bottle, a coated and a metal ball, and a perfume's glass cube on a bent backdrop in a studio's HDRI."""
    ramp = [(4, -3, 0), (4, 2, 0)] + [(4, 2 + 1.5 * math.sin(a), 1.5 - 1.5 * math.cos(a))
                                      for a in numpy.linspace(0, math.pi / 2, 12)[1:]] + [(4, 3.5, 4)]
    mesh = bpy.data.meshes.new("backdrop")
    mesh.from_pydata([(side * x, y, z) for x, y, z in ramp for side in (-1, 1)], [],
                     [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(ramp) - 1)])
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(mesh.polygons), bool))
    mesh.materials.append(plain(Base_Color=(0.55, 0.56, 0.6), Roughness=0.5))
    scene.collection.objects.link(bpy.data.objects.new("backdrop", mesh))
    glass = plain(Base_Color=(0.85, 0.97, 0.9), Roughness=0.0, Transmission_Weight=1.0, IOR=1.45)
    outside = [(0.0, 0.0), (0.3, 0.0), (0.33, 0.04), (0.33, 0.8), (0.28, 0.95), (0.13, 1.1), (0.13, 1.35)]
    inside = [(0.09, 1.35), (0.09, 1.1), (0.24, 0.93), (0.28, 0.78), (0.28, 0.08), (0.0, 0.06)]
    lathe(outside + inside, (-0.75, 0.3, 0.002), glass)
    cylinder(0.15, 0.25, (-0.75, 0.3, 1.42), plain(Base_Color=(0.9, 0.75, 0.4), Metallic=1.0, Roughness=0.2))
    sphere(0.45, (0.25, 0.35, 0.45), plain(Base_Color=(0.7, 0.03, 0.04), Roughness=0.45, Coat_Weight=1.0,
                                          Coat_Roughness=0.02))
    sphere(0.28, (0.95, -0.25, 0.28), plain(Base_Color=(0.9, 0.9, 0.92), Metallic=1.0, Roughness=0.12))
    cube = box((-0.25, -0.75, 0.003), (0.2, -0.4, 0.45), plain(Base_Color=(0.98, 0.9, 0.8), Roughness=0.15,
                                                               Transmission_Weight=1.0, IOR=1.5))
    cube.modifiers.new("Bevel", "BEVEL").width = 0.03
    box((-1.3, -0.9, 0.0), (-0.7, -0.5, 0.12), plain(Base_Color=(0.1, 0.25, 0.5), Roughness=0.3, Coat_Weight=0.5,
                                                     Coat_Roughness=0.2))
    sky(scene, folder, [(-60, 35, 40, (9, 9, 9)), (100, 30, 30, (6, 5, 4)), (180, 60, 30, (3, 4, 6))],
        (0.35, 0.35, 0.38), (0.3, 0.3, 0.32), (0.2, 0.2, 0.2))
    add_camera(scene, (0, -4.2, 1.5), (0, 0.1, 0.5), 36)


@realistic_scene(96)
def night_street(scene, folder):
    """Houses of bricks with lit windows, street lamps, and a car with its lights on a wet street."""
    box((-4, -3, -0.1), (4, 14, 0), plain(Base_Color=(0.06, 0.06, 0.065), Roughness=0.3))
    pavement = diffuse((0.25, 0.25, 0.24))
    wall, dark = textured(bricks(), (2, 3, 1), "ShaderNodeBsdfDiffuse"), plain(Base_Color=(0.05, 0.06, 0.08), Roughness=0.1)
    windows = [emission((1, 0.7, 0.35), 1.2), emission((0.7, 0.85, 1), 0.8)]
    rng = numpy.random.default_rng(12)
    for side in (-1, 1):
        box((min(side * 2, side * 4), -3, 0), (max(side * 2, side * 4), 14, 0.12), pavement)
        for house in range(4):
            y, height = -1 + 3.6 * house, 3 + 2 * rng.random()
            box((min(side * 3, side * 6), y, 0.12), (max(side * 3, side * 6), y + 3.2, height), wall)
            for column in range(2):
                for row in range(2):
                    pane = windows[rng.integers(2)] if rng.random() < 0.6 else dark
                    at = y + 0.5 + 1.4 * column
                    box((side * 3 - 0.02, at, 0.9 + 1.3 * row), (side * 3 + 0.02, at + 0.8, 1.7 + 1.3 * row), pane)
    pole = plain(Base_Color=(0.15, 0.17, 0.15), Metallic=1.0, Roughness=0.5)
    for side, y in ((-1, 0.5), (1, 3.0), (-1, 6.0), (1, 9.0)):
        cylinder(0.05, 3, (side * 2.2, y, 1.5), pole)
        box((min(side * 2.2, side * 1.5), y - 0.04, 2.95), (max(side * 2.2, side * 1.5), y + 0.04, 3.03), pole)
        add_light(scene, "SPOT", (side * 1.5, y, 2.9), (side * 1.3, y, 0), energy=600, shadow_soft_size=SPOT_RADIUS,
                  spot_size=2.0, spot_blend=0.5, color=(1, 0.7, 0.4))
    paint = plain(Base_Color=(0.05, 0.15, 0.4), Roughness=0.4, Coat_Weight=1.0)
    box((-0.9, 3.6, 0.2), (0.5, 6.2, 0.75), paint)
    box((-0.75, 4.2, 0.75), (0.35, 5.8, 1.2), dark)
    for x in (-0.75, 0.35):
        box((x - 0.12, 3.57, 0.45), (x + 0.12, 3.6, 0.6), emission((1, 0.05, 0.03), 6))
        add_light(scene, "SPOT", (x, 6.25, 0.5), (x, 12, 0), energy=60, shadow_soft_size=SPOT_RADIUS, spot_size=0.9,
                  spot_blend=0.3)
        for y in (4.0, 5.7):
            cylinder(0.28, 0.2, (x, y, 0.28), diffuse((0.03, 0.03, 0.03)), rotation=(0, math.pi / 2, 0))
    set_world(scene, (0.01, 0.015, 0.035))
    add_camera(scene, (-0.3, -2.6, 1.6), (0, 4, 1.0), 58)


def leaf_material():
    """A leaf cut out of a card by the alpha of its image; light shines through it."""
    size = 64
    y, x = (numpy.mgrid[0:size, 0:size] + 0.5) / size - 0.5
    inside = abs(x) < 0.38 * numpy.cos(numpy.pi * y) ** 1.2
    vein = numpy.minimum(abs(x), abs((y - 0.8 * abs(x)) % 0.15 - 0.075) * 0.6) < 0.012
    tone = 0.5 + 0.3 * grain(size, 20)
    texels = numpy.where(vein[..., None], [0.65, 0.75, 0.35], tone[..., None] * [0.45, 0.8, 0.2])
    made, front, output = material("leaf", "ShaderNodeBsdfDiffuse")
    texture = add_node(made, "ShaderNodeTexImage", extension="EXTEND")
    texture.image = image_of("leaf", numpy.concatenate([texels, inside[..., None]], axis=-1))
    through, clear = add_node(made, "ShaderNodeBsdfTranslucent"), add_node(made, "ShaderNodeBsdfTransparent")
    both, cut = add_node(made, "ShaderNodeMixShader"), add_node(made, "ShaderNodeMixShader")
    both.inputs[0].default_value = 0.35
    for shader in (front, through):
        link(made, texture.outputs["Color"], shader.inputs["Color"])
    link(made, texture.outputs["Alpha"], cut.inputs[0])
    for to, feeds in ((both, (front, through)), (cut, (clear, both))):
        for socket, feed in zip(to.inputs[1:], feeds):
            link(made, feed.outputs[0], socket)
    link(made, cut.outputs[0], output.inputs["Surface"])
    return made


def scattered(obj, instance, count, seed, scale):
    """Instances of an object in the box of another, instead of it, by geometry nodes, turned and scaled at random."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes = {name: tree.nodes.new(kind) for name, kind in (
        ("given", "NodeGroupInput"), ("result", "NodeGroupOutput"), ("points", "GeometryNodeMeshToPoints"),
        ("line", "GeometryNodeMeshLine"),
        ("place", "FunctionNodeRandomValue"), ("set", "GeometryNodeSetPosition"), ("turn", "FunctionNodeRandomValue"),
        ("size", "FunctionNodeRandomValue"), ("instances", "GeometryNodeInstanceOnPoints"),
        ("object", "GeometryNodeObjectInfo"), ("join", "GeometryNodeJoinGeometry"))}
    nodes["line"].inputs["Count"].default_value = count
    half = [side / 2 for side in obj.dimensions]
    for name, kind, low, high, at in (("place", "FLOAT_VECTOR", [-side for side in half], half, seed),
                                      ("turn", "FLOAT_VECTOR", (-1.2, -1.2, 0), (1.2, 1.2, 2 * math.pi), seed + 1),
                                      ("size", "FLOAT", 0.6 * scale, 1.4 * scale, seed + 2)):
        nodes[name].data_type = kind
        sockets = [socket for socket in nodes[name].inputs if socket.enabled]
        next(socket for socket in sockets if socket.name == "Min").default_value = low
        next(socket for socket in sockets if socket.name == "Max").default_value = high
        next(socket for socket in sockets if socket.name == "Seed").default_value = at
    nodes["object"].inputs["Object"].default_value = instance
    nodes["object"].inputs["As Instance"].default_value = True

    def value(name):
        return next(socket for socket in nodes[name].outputs if socket.enabled)

    for source, to in ((nodes["line"].outputs[0], nodes["points"].inputs[0]),
                       (nodes["points"].outputs[0], nodes["set"].inputs[0]),
                       (value("place"), nodes["set"].inputs["Position"]),
                       (nodes["set"].outputs[0], nodes["instances"].inputs["Points"]),
                       (nodes["object"].outputs["Geometry"], nodes["instances"].inputs["Instance"]),
                       (value("turn"), nodes["instances"].inputs["Rotation"]),
                       (value("size"), nodes["instances"].inputs["Scale"]),
                       (nodes["instances"].outputs[0], nodes["join"].inputs[0]),
                       (nodes["join"].outputs[0], nodes["result"].inputs[0])):
        tree.links.new(source, to)
    obj.modifiers.new("Scatter", "NODES").node_group = tree
    obj.show_instancer_for_render = True


def card(name, made, size=1.0):
    """A square upon its lower edge, out of sight, with a UV map."""
    obj = add_shape(bpy.ops.mesh.primitive_grid_add, made, x_subdivisions=2, y_subdivisions=4, size=size,
                    location=(0, 0, -50))
    for vertex in obj.data.vertices:
        vertex.co.y += size / 2
        vertex.co.z = 0.3 * vertex.co.y ** 2 / size
    obj.name = name
    bpy.ops.object.shade_smooth()
    return obj


@realistic_scene(96)
def foliage(scene, folder):
    """10 000 leaves in two trees' crowns and a hedge, cut out of cards by the alpha of an image."""
    box((-12, -4, -0.2), (12, 20, 0), textured(image_of("soil", grain(128, 30)[..., None] * [0.45, 0.4, 0.25]),
                                                (6, 6, 1), "ShaderNodeBsdfDiffuse"))
    leaf = card("leaf", leaf_material())
    bark = plain(Base_Color=(0.2, 0.13, 0.08), Roughness=0.9)
    crowns = (((-1.6, 1.0, 2.6), (2.2, 2.0, 1.9), 4000), ((1.7, 2.2, 2.9), (2.4, 2.2, 2.2), 4000),
              ((0.2, -0.2, 0.45), (4.4, 0.6, 0.8), 2000))
    for number, (place, size, count) in enumerate(crowns):
        crown = add_shape(bpy.ops.mesh.primitive_cube_add, bark, size=1, location=place)
        for vertex in crown.data.vertices:
            vertex.co = [coordinate * side for coordinate, side in zip(vertex.co, size)]
        crown.data.update()
        bpy.context.view_layer.update()
        scattered(crown, leaf, count, 10 * number + 1, 0.22 if number < 2 else 0.16)
        if number < 2:
            cylinder(0.12, place[2], (place[0], place[1], place[2] / 2), bark)
    add_light(scene, "SUN", (-3, -4, 5), energy=3.5, angle=SUN_ANGLE, color=(1, 0.95, 0.85))
    sky(scene, folder, strength=0.8)
    add_camera(scene, (0.3, -6.5, 1.7), (0.1, 1, 1.9), 50)


@realistic_scene(512)
def hair(scene, folder):
    """A head with hair of particles, and a brush of hair curves. They are thin: Cycles sees fibres that overlap from
    inside, too, and they absorb more there."""
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "THICK"
    set_world(scene, (0.25, 0.28, 0.33))
    brown = material("brown", "ShaderNodeBsdfHairPrincipled", {"Melanin": 0.65, "Melanin Redness": 0.4, "Roughness": 0.3,
                                                              "Radial Roughness": 0.35},
                     model="CHIANG", parametrization="MELANIN")[0]
    box((-4, -4, -0.2), (4, 4, 0), diffuse((0.5, 0.5, 0.5)))
    skin = plain(Base_Color=(0.8, 0.55, 0.42), Roughness=0.5)
    head = sphere(0.8, (-0.4, 0, 1.0), skin)
    head.data.materials.append(brown)
    crown = head.vertex_groups.new(name="crown")
    crown.add([vertex.index for vertex in head.data.vertices if vertex.co.z > 0.1 or vertex.co.y > 0.3], 1.0, "REPLACE")
    settings = particle_system(head, "HAIR", 3000)
    head.particle_systems[-1].vertex_group_density = "crown"
    settings.hair_length, settings.hair_step, settings.material = 0.55, 4, 2
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.6, 0.004
    settings.use_close_tip = False
    settings.brownian_factor, settings.tangent_factor = 0.01, 0.06
    rng = numpy.random.default_rng(41)
    count, points = 500, 6
    roots = rng.uniform(-0.35, 0.35, (count, 2))
    lean = rng.normal(0, 0.12, (count, 2)) + roots * 0.8
    along = numpy.linspace(0, 1, points)
    table = numpy.zeros((count, points, 3), "f")
    table[..., :2] = roots[:, None] + lean[:, None] * along[None, :, None] ** 2
    table[..., 2] = along * (0.7 + 0.1 * rng.random((count, 1)))
    data = bpy.data.hair_curves.new("brush")
    data.add_curves([points] * count)
    data.attributes["position"].data.foreach_set("vector", table.ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", numpy.full(count * points, 0.003, "f"))
    data.materials.append(material("straw", "ShaderNodeBsdfHairPrincipled", {"Color": (0.8, 0.6, 0.3), "Roughness": 0.4},
                                   model="CHIANG", parametrization="COLOR")[0])
    brush = bpy.data.objects.new("brush", data)
    brush.location = (1.1, -0.3, 0.25)
    scene.collection.objects.link(brush)
    box((0.7, -0.7, 0.0), (1.5, 0.1, 0.26), plain(Base_Color=(0.4, 0.2, 0.1), Roughness=0.3))
    add_light(scene, "AREA", (2.5, -3, 3.5), (0, 0, 1), energy=220, shape="SQUARE", size=1.5)
    add_light(scene, "AREA", (-3, 2.5, 3), (0, 0, 1), energy=120, shape="SQUARE", size=1.0, color=(0.8, 0.9, 1))
    add_camera(scene, (0.3, -4.6, 1.5), (0.15, 0, 0.9), 34)


@realistic_scene(1024, 192)
def volume(scene, folder):
    """A hall whose rear is in thin fog, with beams of spots; before it a block of milky liquid, and a cloud of a grid.
    The box of a grid must be outside of the fog: within it there is no other medium."""
    box((-4, -3, -0.1), (4, 5, 0), diffuse((0.45, 0.42, 0.4)))
    box((-4, 4, 0), (4, 4.1, 4), textured(bricks(), (4, 4, 1), "ShaderNodeBsdfDiffuse"))
    fog, shader, output = material("fog", "ShaderNodeBsdfDiffuse")
    fog.node_tree.nodes.remove(shader)
    scatter = add_node(fog, "ShaderNodeVolumeScatter", {"Color": (0.9, 0.92, 1.0), "Density": 0.1, "Anisotropy": 0.3})
    link(fog, scatter.outputs[0], output.inputs["Volume"])
    box((-3.9, 1.2, 0.01), (3.9, 3.9, 3.8), fog)
    for x in (-1.6, 0.2, 1.9):
        cylinder(0.22, 3.6, (x, 2.6, 1.8), diffuse((0.6, 0.55, 0.5)))
    milk, _, output = material("milk", "ShaderNodeBsdfGlass", {"IOR": 1.33, "Roughness": 0.0})
    body = add_node(milk, "ShaderNodeVolumePrincipled", {"Color": (0.9, 0.6, 0.35), "Density": 1.5, "Anisotropy": 0.2})
    link(milk, body.outputs[0], output.inputs["Volume"])
    box((0.5, -0.6, 0.02), (1.3, 0.1, 0.9), milk)
    sphere(0.35, (-0.2, 0.3, 0.35), plain(Base_Color=(0.2, 0.5, 0.25), Roughness=0.3))
    cloud(scene, folder, (-1.5, 0, 0.9))
    for x, colour in ((-2.6, (1, 0.6, 0.3)), (2.8, (0.4, 0.6, 1))):
        add_light(scene, "SPOT", (x, 1.9, 3.6), (0.1 * x, 2.0, 0), energy=400, shadow_soft_size=SPOT_RADIUS, spot_size=0.7,
                  spot_blend=0.3, color=colour)
    add_light(scene, "AREA", (0, -2.4, 3.5), (0, 1, 0.5), energy=60, shape="SQUARE", size=1.0)
    set_world(scene, (0.02, 0.02, 0.025))
    add_camera(scene, (0, -6.0, 1.7), (0, 1, 1.2), 42)


def cloud(scene, folder, location):
    """A ball's fog, which a modifier makes and a file keeps."""
    ball = sphere(0.55, location, diffuse())
    made = bpy.data.objects.new("made", bpy.data.volumes.new("made"))
    scene.collection.objects.link(made)
    modifier = made.modifiers.new("Mesh to Volume", "MESH_TO_VOLUME")
    modifier.object, modifier.density, modifier.interior_band_width = ball, 6.0, 0.4
    modifier.resolution_mode, modifier.voxel_size = "VOXEL_SIZE", 0.05
    evaluated = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    path = os.path.join(folder, "cloud.vdb")
    if not evaluated.grids.save(path):
        raise RuntimeError(f"{path} cannot be written")
    bpy.data.objects.remove(made)
    bpy.data.objects.remove(ball)
    data = bpy.data.volumes.new("cloud")
    data.filepath = path
    smoke, shader, output = material("smoke", "ShaderNodeBsdfDiffuse")
    smoke.node_tree.nodes.remove(shader)
    body = add_node(smoke, "ShaderNodeVolumePrincipled", {"Color": (0.85, 0.85, 0.85), "Density": 1.0, "Anisotropy": 0.3})
    link(smoke, body.outputs[0], output.inputs["Volume"])
    data.materials.append(smoke)
    scene.collection.objects.link(bpy.data.objects.new("cloud", data))


@realistic_scene(192)
def depth_of_field(scene, folder):
    """A table's glasses and balls at several distances, in focus on an empty, with small lights behind."""
    box((-3, -2, -0.1), (3, 8, 0), textured(planks(), (4, 6, 1), Roughness=0.3))
    rng = numpy.random.default_rng(50)
    for number in range(9):
        colour = tuple(0.15 + 0.75 * rng.random(3))
        at = (-0.9 + 0.9 * (number % 3) + 0.1 * number, -0.6 + 0.75 * number, 0.25)
        if number % 3 == 0:
            sphere(0.25, at, plain(Base_Color=colour, Roughness=0.3, Coat_Weight=1.0))
        elif number % 3 == 1:
            box((at[0] - 0.2, at[1] - 0.2, 0), (at[0] + 0.2, at[1] + 0.2, 0.4 + 0.1 * number),
                plain(Base_Color=colour, Metallic=1.0, Roughness=0.3))
        else:
            lathe([(0.0, 0), (0.2, 0.01), (0.24, 0.3), (0.14, 0.5), (0.17, 0.6)], (at[0], at[1], 0.002),
                  plain(Base_Color=colour, Roughness=0.5))
    for number in range(14):
        sphere(0.04, (rng.uniform(-2.5, 2.5), rng.uniform(6, 8), rng.uniform(0.5, 2.2)),
               emission(tuple(0.3 + 0.7 * rng.random(3)), 25), 16)
    set_world(scene, (0.12, 0.13, 0.18))
    add_light(scene, "AREA", (-2, -2.5, 3), (0, 1, 0), energy=150, shape="SQUARE", size=1.2)
    focus = bpy.data.objects.new("focus", None)
    focus.location = (0.3, 1.6, 0.4)
    scene.collection.objects.link(focus)
    camera = add_camera(scene, (0.1, -3.2, 1.1), (0.1, 2, 0.45), 40).data
    camera.dof.use_dof, camera.dof.focus_object, camera.dof.aperture_fstop = True, focus, 0.25
    camera.dof.aperture_blades, camera.dof.aperture_rotation = 6, 0.3


@realistic_scene(96)
def panorama(scene, folder):
    """A court all around: an arcade, a fountain, trees and benches."""
    stone, bench = textured(bricks(), (3, 1, 1), "ShaderNodeBsdfDiffuse"), plain(Base_Color=(0.4, 0.22, 0.1), Roughness=0.5)
    box((-8, -8, -0.1), (8, 8, 0), textured(image_of("paving", 0.3 + 0.5 * grain(128, 60)[..., None] * [1, 0.95, 0.85]),
                                            (8, 8, 1), "ShaderNodeBsdfDiffuse"))
    for x, y, across, along in ((0, 6, 6, 0.3), (0, -6, 6, 0.3), (6, 0, 0.3, 6), (-6, 0, 0.3, 6)):
        box((x - across, y - along, 2.4), (x + across, y + along, 3.2), stone)
    for number in range(28):
        at = -6 + 12 * (number // 4) / 7
        x, y = ((at, -6), (6, at), (-at, 6), (-6, -at))[number % 4]
        cylinder(0.2, 2.4, (x, y, 1.2), diffuse((0.7, 0.66, 0.58)))
    cylinder(1.0, 0.4, (1.2, 2.5, 0.2), diffuse((0.6, 0.6, 0.58)))
    cylinder(0.85, 0.02, (1.2, 2.5, 0.42), plain(Base_Color=(0.05, 0.15, 0.2), Roughness=0.05))
    sphere(0.3, (1.2, 2.5, 0.9), plain(Base_Color=(0.95, 0.7, 0.4), Metallic=1.0, Roughness=0.25))
    for x, y in ((-3, 2), (3, -3), (-2.5, -3.5), (4, 3.5)):
        cylinder(0.12, 1.4, (x, y, 0.7), bench)
        sphere(0.8, (x, y, 2.0), diffuse((0.12, 0.35, 0.08)), 16)
        box((x - 1.3, y - 0.2, 0.35), (x - 0.4, y + 0.2, 0.42), bench)
    add_light(scene, "SUN", (-3, 2, 4), energy=3, angle=SUN_ANGLE, color=(1, 0.93, 0.8))
    add_light(scene, "POINT", (1.2, 2.5, 2.2), energy=80, shadow_soft_size=0, color=(1, 0.5, 0.3))
    sky(scene, folder, strength=0.7)
    camera = add_camera(scene, (0, 0, 1.6), (0.3, 1, 1.6)).data
    camera.type = "PANO"
    (camera if hasattr(camera, "panorama_type") else camera.cycles).panorama_type = "EQUIRECTANGULAR"


def robot(scene, made):
    """A rig whose bones carry rigid parts. Returns its pose bones."""
    bpy.ops.object.armature_add(enter_editmode=True, location=(0, 0, 0))
    rig = bpy.context.object
    bones = rig.data.edit_bones
    bones.remove(bones[0])
    for name, head, tail, parent in (("body", (0, 0, 0.9), (0, 0, 1.7), None), ("head", (0, 0, 1.7), (0, 0, 2.1), "body"),
                                     ("arm.L", (0.35, 0, 1.6), (0.95, 0, 1.5), "body"),
                                     ("hand.L", (0.95, 0, 1.5), (1.4, 0, 1.5), "arm.L"),
                                     ("arm.R", (-0.35, 0, 1.6), (-0.95, 0, 1.5), "body"),
                                     ("leg.L", (0.18, 0, 0.9), (0.2, 0, 0.1), "body"),
                                     ("leg.R", (-0.18, 0, 0.9), (-0.2, 0, 0.1), "body")):
        bone = bones.new(name)
        bone.head, bone.tail = head, tail
        bone.parent = bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in rig.data.bones:
        length = bone.length
        half = 0.3 if bone.name == "body" else 0.11
        part = box((-half, 0, -0.12), (half, length * 0.96, 0.12), made)
        # Children of bones are placed from the tail.
        part.location.y -= length
        part.parent, part.parent_type, part.parent_bone = rig, "BONE", bone.name
    for bone in rig.pose.bones:
        bone.rotation_mode = "XYZ"
    return rig


@realistic_scene(96)
def animated_rig(scene, folder):
    """A robot that walks and waves, a ball that rolls, and a camera that follows, while the shutter is open."""
    box((-5, -4, -0.1), (5, 6, 0), textured(planks(), (4, 4, 1), Roughness=0.4))
    box((-5, 5, 0), (5, 5.1, 4), diffuse((0.5, 0.55, 0.6)))
    rig = robot(scene, plain(Base_Color=(0.75, 0.5, 0.15), Roughness=0.4, Coat_Weight=0.6))
    for name, axis, first, last in (("arm.L", 2, -0.2, 0.5), ("hand.L", 2, -0.3, 1.0), ("arm.R", 0, -0.5, 0.4),
                                    ("leg.L", 0, 0.5, -0.4), ("leg.R", 0, -0.5, 0.4), ("head", 1, -0.3, 0.4)):
        bone = rig.pose.bones[name]
        keyed(bone, "rotation_euler", [first if i == axis else 0 for i in range(3)],
              [last if i == axis else 0 for i in range(3)])
    keyed(rig, "location", (-0.35, 0, 0), (0.25, 0.1, 0))
    colours = image_of("ball", numpy.stack([grain(64, 70 + i) for i in range(3)], axis=-1))
    ball = sphere(0.35, (0, 0, 0.35), textured(colours, Roughness=0.3))
    keyed(ball, "location", (-1.5, -1.0, 0.35), (-0.9, -1.1, 0.35))
    keyed(ball, "rotation_euler", (0, 0, 0), (0, 1.7, 0))
    camera = add_camera(scene, (0.4, -5.5, 1.7), (0, 0, 1.1), 38)
    keyed(camera, "location", (0.3, -5.5, 1.7), (0.5, -5.4, 1.7))
    add_light(scene, "AREA", (2.5, -3, 3.8), (0, 0, 1), energy=250, shape="SQUARE", size=1.5)
    add_light(scene, "SUN", (-3, -2, 4), energy=1.5, angle=SUN_ANGLE)
    set_world(scene, (0.2, 0.24, 0.3))
    blurred(scene)


def ramp(made, factor, *stops):
    """The colour of a ColorRamp; stops: (position, colour)."""
    node = add_node(made, "ShaderNodeValToRGB")
    elements = node.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(0.5)
    for element, (position, colour) in zip(elements, stops):
        element.position, element.color = position, (*colour, 1)
    link(made, factor, node.inputs["Fac"])
    return node.outputs["Color"]


def marble():
    """Veins: noise that bends waves, through a ramp; it is rougher where it is dark."""
    made, shader, _ = principled("marble", Roughness=0.2)
    place = add_node(made, "ShaderNodeTexCoord").outputs["Object"]
    noise = add_node(made, "ShaderNodeTexNoise", {"Scale": 2.5, "Detail": 5.0})
    moved = add_node(made, "ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    moved.inputs[1].default_value = (1.5, 1.5, 1.5)
    wave = add_node(made, "ShaderNodeTexWave", {"Scale": 1.4, "Distortion": 3.0, "Detail": 2.0})
    link(made, place, noise.inputs["Vector"])
    link(made, noise.outputs["Color"], moved.inputs[0])
    link(made, place, moved.inputs[2])
    link(made, moved.outputs[0], wave.inputs["Vector"])
    factor = wave.outputs["Fac"] if "Fac" in wave.outputs else wave.outputs["Factor"]
    link(made, ramp(made, factor, (0.0, (0.12, 0.14, 0.16)), (0.35, (0.6, 0.58, 0.55)), (1.0, (0.85, 0.83, 0.8))),
         shader.inputs["Base Color"])
    rough = add_node(made, "ShaderNodeMapRange")
    rough.inputs["To Min"].default_value, rough.inputs["To Max"].default_value = 0.55, 0.2
    link(made, factor, rough.inputs["Value"])
    link(made, rough.outputs[0], shader.inputs["Roughness"])
    return made


def rust():
    """Metal under rust, whose edge a noise makes, with bumps of Voronoi cells."""
    made, shader, _ = principled("rust")
    noise = add_node(made, "ShaderNodeTexNoise", {"Scale": 3.0, "Detail": 4.0})
    cells = add_node(made, "ShaderNodeTexVoronoi", {"Scale": 9.0})
    bump = add_node(made, "ShaderNodeBump", {"Strength": 0.5, "Distance": 0.05})
    factor = noise.outputs[0]
    link(made, ramp(made, factor, (0.45, (0.75, 0.76, 0.78)), (0.55, (0.45, 0.2, 0.08)), (0.8, (0.2, 0.08, 0.04))),
         shader.inputs["Base Color"])
    for socket, low, high in (("Metallic", 1.0, 0.0), ("Roughness", 0.3, 0.9)):
        between = add_node(made, "ShaderNodeMapRange")
        for name, value in (("From Min", 0.45), ("From Max", 0.55), ("To Min", low), ("To Max", high)):
            between.inputs[name].default_value = value
        link(made, factor, between.inputs["Value"])
        link(made, between.outputs[0], shader.inputs[socket])
    link(made, cells.outputs["Distance"], bump.inputs["Height"])
    link(made, bump.outputs[0], shader.inputs["Normal"])
    return made


def tiles():
    """Brick texture over a UV map, with a checker in it."""
    made, shader, _ = principled("tiles", Roughness=0.35)
    brick = add_node(made, "ShaderNodeTexBrick", {"Color1": (0.55, 0.3, 0.2), "Color2": (0.4, 0.4, 0.45),
                                                  "Mortar": (0.75, 0.75, 0.7), "Scale": 6.0})
    link(made, add_node(made, "ShaderNodeTexCoord").outputs["UV"], brick.inputs["Vector"])
    link(made, brick.outputs["Color"], shader.inputs["Base Color"])
    return made


@realistic_scene(192)
def procedural(scene, folder):
    """Marble, rust and tiles, which are baked."""
    add_shape(bpy.ops.mesh.primitive_plane_add, tiles(), size=6)
    stone = marble()
    add_shape(bpy.ops.mesh.primitive_torus_add, stone, major_radius=0.5, minor_radius=0.22, location=(-0.9, 0.3, 0.6),
              rotation=(1.2, 0.2, 0.4))
    bpy.ops.object.shade_smooth()
    lathe([(0.0, 0), (0.3, 0.01), (0.2, 0.15), (0.35, 0.5), (0.3, 0.85), (0.12, 1.0), (0.17, 1.15)], (0.15, 0.9, 0.002),
          stone)
    sphere(0.5, (0.9, -0.1, 0.5), rust())
    box((-0.4, -1.0, 0), (0.15, -0.55, 0.4), rust())
    add_light(scene, "AREA", (2, -2.5, 3.5), (0, 0, 0.5), energy=200, shape="SQUARE", size=1.5)
    add_light(scene, "SUN", (-3, -2, 4), energy=1.5, angle=SUN_ANGLE)
    sky(scene, folder, strength=0.5)
    add_camera(scene, (0.1, -4.5, 2.3), (0, 0.1, 0.4), 36)
