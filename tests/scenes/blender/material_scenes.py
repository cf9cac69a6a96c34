"""Scenes of one material each: it is on a sphere above a plane, below a square light, in a coloured world."""

import pathlib
import sys

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from cycles_comparison import add_camera, empty_scene, set_world  # noqa: E402


def material(name, bl_idname=None, values=None, **properties):
    """A new material with one shader: the Principled BSDF or a node of that name; values: {input: value}."""
    made = bpy.data.materials.new(name)
    if hasattr(made, "use_nodes"):
        made.use_nodes = True
    tree = made.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    if bl_idname is not None:
        tree.nodes.remove(shader)
        shader = tree.nodes.new(bl_idname)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    for key, value in properties.items():
        setattr(shader, key, value)
    set_inputs(shader, values or {})
    return made, shader, output


def set_inputs(node, values):
    """Sets values of inputs by name or identifier; colours may have three channels."""
    for name, value in values.items():
        socket = next(each for each in node.inputs if name in {each.name, each.identifier} and each.enabled)
        socket.default_value = (*value, 1.0) if socket.type == "RGBA" and len(value) == 3 else value


def add_node(made, bl_idname, values=None, **properties):
    """A new node of a material."""
    node = made.node_tree.nodes.new(bl_idname)
    for key, value in properties.items():
        setattr(node, key, value)
    set_inputs(node, values or {})
    return node


def link(made, output, to):
    made.node_tree.links.new(output, to)


def add_shape(make, made, **placement):
    """An object of a mesh operator with a material."""
    make(**placement)
    obj = bpy.context.object
    obj.data.materials.append(made)
    return obj


def fill(scene, made):
    """Adds camera, world, plane, light and the sphere of the material."""
    set_world(scene, (0.3, 0.35, 0.45))
    add_camera(scene, (0, -5, 2.2), (0, 0, 0.9), 35)
    floor, _, _ = material("floor", "ShaderNodeBsdfDiffuse", {"Color": (0.4, 0.4, 0.4)})
    lamp, _, _ = material("lamp", "ShaderNodeEmission", {"Color": (1.0, 0.9, 0.8), "Strength": 3.0})
    add_shape(bpy.ops.mesh.primitive_plane_add, floor, size=8)
    add_shape(bpy.ops.mesh.primitive_plane_add, lamp, size=3, location=(1.5, -1.5, 4), rotation=(0.5, 0.4, 0))
    sphere = add_shape(bpy.ops.mesh.primitive_uv_sphere_add, made, segments=64, ring_count=32, radius=0.9,
                       location=(0, 0, 0.9))
    bpy.ops.object.shade_smooth()
    return sphere


def picture(size=256, seed=1, smooth=True, colourspace="sRGB", alpha=False):
    """A generated image of smooth random colours (rows of texels change slowly), or of noise."""
    rng = numpy.random.default_rng(seed)
    x = (numpy.arange(size) + 0.5) / size * 2 * numpy.pi
    texels = numpy.ones((size, size, 4), numpy.float32)
    for channel in range(4 if alpha else 3):
        a, b = rng.integers(1, 4, 2)
        texels[..., channel] = 0.5 + 0.4 * numpy.sin(a * x[None, :] + channel) * numpy.cos(b * x[:, None] + seed)
    image = bpy.data.images.new(f"picture {seed}", size, size, alpha=alpha)
    image.colorspace_settings.name = colourspace
    image.pixels.foreach_set(texels.ravel())
    image.update()
    return image


_COLOUR = (0.7, 0.4, 0.2)


def _one(bl_idname=None, values=None, **properties):
    return lambda: material("material", bl_idname, values, **properties)[0]


def _two(mixer, first, second, factor=None):
    """A Mix or Add Shader of two (bl_idname, values, properties)."""
    def make():
        made, shader, output = material("material", first[0], first[1])
        other, both = add_node(made, second[0], second[1]), add_node(made, mixer)
        if factor is not None:
            both.inputs[0].default_value = factor
        link(made, shader.outputs[0], both.inputs[-2])
        link(made, other.outputs[0], both.inputs[-1])
        link(made, both.outputs[0], output.inputs["Surface"])
        return made
    return make


def _diffuse_of(feed):
    """A Diffuse BSDF; feed(material) gives the socket of its colour."""
    def make():
        made, shader, _ = material("material", "ShaderNodeBsdfDiffuse")
        link(made, feed(made), shader.inputs["Color"])
        return made
    return make


def _bent(feed):
    """A Diffuse BSDF; feed(material) gives the socket of its normal."""
    def make():
        made, shader, _ = material("material", "ShaderNodeBsdfDiffuse", {"Color": _COLOUR})
        link(made, feed(made), shader.inputs["Normal"])
        return made
    return make


def _coated(values, below=None, coat=None):
    """A Principled BSDF with a coat; each function(material) gives the socket of a normal, or is None."""
    def make():
        made, shader, _ = material("material", None, {"Coat Weight": 1.0, **values})
        for feed, name in ((below, "Normal"), (coat, "Coat Normal")):
            if feed is not None:
                link(made, feed(made), shader.inputs[name])
        return made
    return make


def _brushed(bl_idname, values, **properties):
    """A BSDF with the tangent of the UV map."""
    def make():
        made, shader, _ = material("material", bl_idname, values, **properties)
        link(made, add_node(made, "ShaderNodeTangent", direction_type="UV_MAP").outputs[0], shader.inputs["Tangent"])
        return made
    return make


def _placed_image(made):
    image = add_node(made, "ShaderNodeTexImage")
    image.image = picture()
    mapping = add_node(made, "ShaderNodeMapping", {"Scale": (2, 1.5, 1), "Rotation": (0, 0, 0.5), "Location": (0.1, 0.2, 0)})
    link(made, add_node(made, "ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    link(made, mapping.outputs[0], image.inputs["Vector"])
    return image.outputs["Color"]


def _changed_image(made):
    image = add_node(made, "ShaderNodeTexImage")
    image.image = picture()
    hue = add_node(made, "ShaderNodeHueSaturation", {"Hue": 0.6, "Saturation": 1.3})
    gamma = add_node(made, "ShaderNodeGamma", {"Gamma": 1.4})
    link(made, image.outputs["Color"], hue.inputs["Color"])
    link(made, hue.outputs[0], gamma.inputs["Color"])
    return gamma.outputs[0]


def _procedure(bl_idname, coordinates=None):
    def feed(made):
        texture = add_node(made, bl_idname)
        if coordinates:
            link(made, add_node(made, "ShaderNodeTexCoord").outputs[coordinates], texture.inputs["Vector"])
        return texture.outputs["Color"]
    return feed


def _normal_map(made, flat=0.6):
    image, flatter = add_node(made, "ShaderNodeTexImage"), add_node(made, "ShaderNodeMixRGB", {"Color2": (0.5, 0.5, 1.0)})
    image.image = picture(colourspace="Non-Color")
    flatter.inputs["Fac"].default_value = flat
    link(made, image.outputs["Color"], flatter.inputs["Color1"])
    node = add_node(made, "ShaderNodeNormalMap")
    link(made, flatter.outputs[0], node.inputs["Color"])
    return node.outputs[0]


def _faint_normal_map(made, flat=0.95):
    return _normal_map(made, flat)


def _bump(made):
    image, node = add_node(made, "ShaderNodeTexImage"), add_node(made, "ShaderNodeBump", {"Strength": 1.0, "Distance": 0.2})
    image.image = picture(colourspace="Non-Color")
    link(made, image.outputs["Color"], node.inputs["Height"])
    return node.outputs[0]


def _bump_of_noise(made):
    noise = add_node(made, "ShaderNodeTexNoise", {"Scale": 3.0})
    node = add_node(made, "ShaderNodeBump", {"Strength": 1.0, "Distance": 0.1})
    link(made, noise.outputs[0], node.inputs["Height"])
    return node.outputs[0]


def _displacement():
    """Noise over the object, which moves nothing, but bends the normals."""
    made, _, output = material("material", _DIFFUSE, {"Color": _COLOUR})
    noise = add_node(made, "ShaderNodeTexNoise", {"Scale": 3.0})
    node = add_node(made, "ShaderNodeDisplacement", {"Scale": 0.1})
    link(made, noise.outputs[0], node.inputs["Height"])
    link(made, node.outputs[0], output.inputs["Displacement"])
    if hasattr(made, "displacement_method"):
        made.displacement_method = "BUMP"
    return made


def _volume(bl_idname, values, surface=True):
    """A volume in glass, or alone."""
    def make():
        made, shader, output = material("material", "ShaderNodeBsdfGlass", {"IOR": 1.3, "Roughness": 0.0})
        if not surface:
            made.node_tree.nodes.remove(shader)
        link(made, add_node(made, bl_idname, values).outputs[0], output.inputs["Volume"])
        return made
    return make


_GLOSSY, _GLASS, _DIFFUSE = "ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfGlass", "ShaderNodeBsdfDiffuse"

# Materials by name: functions that make them.
MATERIALS = {
    "diffuse": _one(_DIFFUSE, {"Color": _COLOUR}),
    "glossy mirror": _one(_GLOSSY, {"Color": _COLOUR, "Roughness": 0.0}, distribution="GGX"),
    "glossy GGX": _one(_GLOSSY, {"Color": _COLOUR, "Roughness": 0.5}, distribution="GGX"),
    "glossy Beckmann": _one(_GLOSSY, {"Color": _COLOUR, "Roughness": 0.5}, distribution="BECKMANN"),
    "glossy Multiscatter GGX": _one(_GLOSSY, {"Color": _COLOUR, "Roughness": 0.6}, distribution="MULTI_GGX"),
    "glass": _one(_GLASS, {"Color": (0.9, 0.8, 0.7), "Roughness": 0.0}),
    "glass GGX": _one(_GLASS, {"Color": (0.9, 0.8, 0.7), "Roughness": 0.3}, distribution="GGX"),
    "glass Beckmann": _one(_GLASS, {"Color": (0.9, 0.8, 0.7), "Roughness": 0.3}, distribution="BECKMANN"),
    "translucent": _one("ShaderNodeBsdfTranslucent", {"Color": _COLOUR}),
    "transparent": _one("ShaderNodeBsdfTransparent", {"Color": (0.5, 0.5, 0.5)}),
    "principled": _one(None, {"Base Color": _COLOUR, "Roughness": 0.4}),
    "principled specular": _one(None, {"Base Color": _COLOUR, "Roughness": 0.3, "Specular IOR Level": 1.0,
                                       "Specular Tint": (0.9, 0.3, 0.3)}),
    "principled metal": _one(None, {"Base Color": (0.9, 0.6, 0.3), "Roughness": 0.3, "Metallic": 1.0,
                                    "Specular Tint": (0.5, 0.8, 1.0)}),
    "principled half metal": _one(None, {"Base Color": (0.9, 0.6, 0.3), "Roughness": 0.3, "Metallic": 0.5}),
    "principled coat": _one(None, {"Base Color": _COLOUR, "Coat Weight": 0.5, "Coat Roughness": 0.3}),
    "principled tinted coat": _one(None, {"Base Color": _COLOUR, "Coat Weight": 1.0, "Coat Tint": (0.9, 0.7, 0.5)}),
    "principled transmission": _one(None, {"Base Color": _COLOUR, "Roughness": 0.0, "Transmission Weight": 1.0}),
    "principled half transmission": _one(None, {"Base Color": _COLOUR, "Roughness": 0.2, "Transmission Weight": 0.5}),
    "principled alpha": _one(None, {"Base Color": _COLOUR, "Alpha": 0.4}),
    "principled emission": _one(None, {"Base Color": _COLOUR, "Emission Color": (1, 0.5, 0.2), "Emission Strength": 0.7}),
    "principled sheen": _one(None, {"Base Color": _COLOUR, "Sheen Weight": 0.7, "Sheen Roughness": 0.4,
                                    "Sheen Tint": (0.9, 0.6, 0.8)}),
    "sheen": _one("ShaderNodeBsdfSheen", {"Color": _COLOUR, "Roughness": 0.6}, distribution="MICROFIBER"),
    "principled anisotropic": _brushed(None, {"Base Color": (0.9, 0.6, 0.3), "Metallic": 1.0, "Roughness": 0.3,
                                              "Anisotropic": 0.8, "Anisotropic Rotation": 0.1}),
    "glossy anisotropic": _brushed(_GLOSSY, {"Color": _COLOUR, "Roughness": 0.4, "Anisotropy": 0.6, "Rotation": 0.15},
                                   distribution="GGX"),
    "mix": _two("ShaderNodeMixShader", (_DIFFUSE, {"Color": _COLOUR}), (_GLOSSY, {"Roughness": 0.2}), 0.3),
    "mix with emission": _two("ShaderNodeMixShader", (_DIFFUSE, {"Color": _COLOUR}),
                              ("ShaderNodeEmission", {"Color": _COLOUR, "Strength": 2.0}), 0.3),
    "mix with transparency": _two("ShaderNodeMixShader", ("ShaderNodeBsdfTransparent", {}),
                                  (_DIFFUSE, {"Color": _COLOUR}), 0.6),
    "add": _two("ShaderNodeAddShader", (_DIFFUSE, {"Color": (0.5, 0.2, 0.1)}),
                (_GLOSSY, {"Color": (0.3, 0.3, 0.3), "Roughness": 0.2})),
    "add emission": _two("ShaderNodeAddShader", (_DIFFUSE, {"Color": _COLOUR}),
                         ("ShaderNodeEmission", {"Color": _COLOUR, "Strength": 0.5})),
    "absorption": _volume("ShaderNodeVolumeAbsorption", {"Color": _COLOUR, "Density": 1.0}),
    "scattering": _volume("ShaderNodeVolumeScatter", {"Color": _COLOUR, "Density": 1.5, "Anisotropy": 0.4}, False),
    "principled volume": _volume("ShaderNodeVolumePrincipled", {
        "Color": _COLOUR, "Density": 1.5, "Absorption Color": (0.2, 0.1, 0.4), "Emission Strength": 0.2,
        "Emission Color": (0.1, 0.4, 1.0)}, False),
    "image": _diffuse_of(_placed_image), "image through nodes": _diffuse_of(_changed_image),
    "noise over generated coordinates": _diffuse_of(_procedure("ShaderNodeTexNoise")),
    "Voronoi cells over a UV map": _diffuse_of(_procedure("ShaderNodeTexVoronoi", "UV")),
    "checker over the object": _diffuse_of(_procedure("ShaderNodeTexChecker", "Object")),
    "normal map": _bent(_normal_map), "bump": _bent(_bump), "bump of noise": _bent(_bump_of_noise),
    "displacement of noise": _displacement,
    "smooth coat over bumps": _coated({"Base Color": _COLOUR, "Specular IOR Level": 0.0, "Coat Roughness": 0.1},
                                      below=_normal_map),
    # Faint ones: Cycles tilts normals whose mirror directions would be below the surface.
    "coat with bumps": _coated({"Base Color": _COLOUR, "Coat Roughness": 0.1}, coat=_faint_normal_map),
    "coat and base with bumps of their own": _coated(
        {"Base Color": _COLOUR, "Metallic": 1.0, "Roughness": 0.4}, below=lambda made: _faint_normal_map(made, 0.9),
        coat=_faint_normal_map),
}
if bpy.app.version >= (4, 3, 0):
    MATERIALS["metallic anisotropic"] = _brushed("ShaderNodeBsdfMetallic", {
        "Base Color": _COLOUR, "Edge Tint": (0.8, 0.9, 1.0), "Roughness": 0.3, "Anisotropy": 0.5, "Rotation": 0.05},
        fresnel_type="F82")
    MATERIALS["metallic F82"] = _one("ShaderNodeBsdfMetallic", {
        "Base Color": _COLOUR, "Edge Tint": (0.8, 0.9, 1.0), "Roughness": 0.3}, fresnel_type="F82")
    MATERIALS["metallic conductor"] = _one("ShaderNodeBsdfMetallic", {"Roughness": 0.3}, fresnel_type="PHYSICAL_CONDUCTOR",
                                           distribution="GGX")
