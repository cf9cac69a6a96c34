# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of Blender as BSDFs, emitters and media."""

import dataclasses

from . import microfacets, principled  # noqa: F401  register nodes
from .closures import BLACK, Leaf, bent
from .elements_of import bsdf_element, emission_element
from .fields import constant
from .media import medium_of
from .nodes import Input, source_of
from .normals import displacement_bend
from .reading import NeedsMesh, Reading
from .shaders import closure_of


@dataclasses.dataclass
class Surface:
    """A material as elements of a scene file.

    bsdf: without an id; None: the surface shows nothing (if it emits, it is black else).
    emission: <emitter type="area">, or None. interior: a Medium, or None.
    uv_map: the UV map that the textures use; None: the active one for renders.
    uvs: (loops, 2), coordinates of the evaluated mesh's loops that are used instead, or None.
    attributes: names of the colour attributes that the mesh must carry.
    """
    bsdf: object = None
    emission: object = None
    interior: object = None
    uv_map: str | None = None
    uvs: object = None
    attributes: set = dataclasses.field(default_factory=set)


def export_material(material, obj, context, grids=None):
    """The Surface of a material on an evaluated object. Without a material: Blender's default grey. grids: those of a
    volume object, see Reading."""
    if material is None or material.node_tree is None:
        colour = constant([0.8] * 3 if material is None else material.diffuse_color[:3])
        return Surface(bsdf_element(Leaf("diffuse", {"reflectance": colour}, ("reflectance",)), context))
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        return Surface(bsdf_element(BLACK, context))
    try:
        return _surface(Reading(material, obj, context, grids=grids), output)
    except NeedsMesh:
        return _surface(Reading(material, obj, context, over_mesh=True, grids=grids), output)


def export_world_medium(world, context):
    """The Medium of an evaluated world, or None."""
    output = world.node_tree.get_output_node("CYCLES") if world is not None and world.node_tree is not None else None
    return medium_of(Reading(world, None, context), Input(output.inputs["Volume"])) if output is not None else None


def _surface(reading, output):
    context = reading.context
    surface = Surface(interior=medium_of(reading, Input(output.inputs["Volume"])), attributes=reading.attributes)
    at = Input(output.inputs["Surface"])
    if source_of(at) is None or source_of(at).is_constant:
        # Nothing is linked: a boundary of the volume, or else black.
        surface.bsdf = bsdf_element(BLACK, context) if surface.interior is None else None
        return surface
    closure = closure_of(reading, at)
    bsdf = bent(closure.bsdf, displacement_bend(reading, Input(output.inputs["Displacement"])))
    if closure.bsdf is not None or closure.emission is None:
        surface.bsdf = bsdf_element(bsdf, context)
    if closure.emission is not None:
        surface.emission = emission_element(closure.emission, context)
    if reading.over_mesh:
        surface.uvs = reading.uvs()
    else:
        surface.uv_map = next(iter(reading.uv_maps), None)
    return surface
