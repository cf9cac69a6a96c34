# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps as emitters and emitting shapes.

A lamp of P watts emits the flux P in all, or would as a point without its cone. Lamps let rays pass.
"""

import math

import mathutils

from .cameras import without_scale
from .elements import Element, add_value, plugin

# Lamps shine along their -z axis, emitters along z.
_TURN = mathutils.Matrix.Diagonal((1, -1, -1, 1))
_LEAST_SPREAD = 0.1  # degrees


def _colour_of_nodes(context, light, name):
    """The factor that the lamp's nodes have, if they are a constant emission."""
    if not light.use_nodes or light.node_tree is None:
        return [1.0] * 3
    output = light.node_tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output is not None else []
    if not links:
        return [0.0] * 3
    node = links[0].from_node
    if node.type == "EMISSION":
        strength, colour = node.inputs["Strength"], node.inputs["Color"]
        if strength.is_linked or colour.is_linked:
            context.report.add("what is linked to the emission of a lamp is not exported", name, node=node.name)
        return [(1.0 if strength.is_linked else strength.default_value) * (1.0 if colour.is_linked else channel)
                for channel in colour.default_value[:3]]
    context.report.add("the node is not exported; the lamp has no other colour than its own", name, node=node.name)
    return [1.0] * 3


def power_of(context, light, name):
    """Watts in each channel; of a sun, W/m²."""
    power = [light.energy * channel * factor
             for channel, factor in zip(light.color, _colour_of_nodes(context, light, name))]
    if getattr(light, "use_temperature", False):
        power = [channel * factor for channel, factor in zip(power, light.temperature_color)]
    return [channel * 2 ** getattr(light, "exposure", 0) for channel in power]


def _scaled(power, factor):
    return [factor * channel for channel in power]


def _add_visibility(emitter, light_object):
    if not light_object.visible_camera:
        add_value(emitter, "boolean", "seen_by_camera", False)


def _shining_shape(kind, radiance, place, light_object, spread=math.pi):
    """A shape that only emits, into a cone of an angle."""
    shape = plugin("shape", kind)
    place.add_to(shape)
    shape.append(Element("bsdf", {"type": "null"}))
    emitter = plugin("emitter", "area")
    add_value(emitter, "rgb", "radiance", radiance)
    _add_visibility(emitter, light_object)
    if spread < math.pi - 1e-4:
        add_value(emitter, "float", "spread", max(math.degrees(spread), _LEAST_SPREAD))
    shape.append(emitter)
    return shape


def _point(light, power, place, light_object):
    radius = light.shadow_soft_size
    normalized = getattr(light, "normalize", True)
    if radius > 0:
        radiance = _scaled(power, 1 / (4 * math.pi ** 2 * radius ** 2) if normalized else 1 / math.pi)
        size = mathutils.Matrix.Diagonal((radius, radius, radius, 1))
        return _shining_shape("sphere", radiance, place.then(lambda m: without_scale(m) @ size), light_object)
    emitter = plugin("emitter", "point")
    place.then(without_scale).add_to(emitter)
    add_value(emitter, "rgb", "intensity", _scaled(power, 1 / (4 * math.pi) if normalized else 1 / math.pi))
    return emitter


def _spot(context, light, power, place, name):
    stretch = place.now.to_scale()
    if max(stretch) - min(stretch) > 1e-3 * max(stretch):
        context.report.add("the elliptic cone of a stretched spot lamp is exported as a round one", name)
    radius = light.shadow_soft_size
    emitter = plugin("emitter", "spot")
    place.then(lambda matrix: without_scale(matrix) @ _TURN).add_to(emitter)
    factor = 1 / (4 * math.pi)
    if not getattr(light, "normalize", True):
        factor = radius ** 2 if radius > 0 else 1 / math.pi
    add_value(emitter, "rgb", "intensity", _scaled(power, factor))
    edge = math.cos(light.spot_size / 2)
    add_value(emitter, "float", "cutoff_angle", math.degrees(light.spot_size / 2))
    add_value(emitter, "float", "beam_width", math.degrees(math.acos(min(1, edge + (1 - edge) * light.spot_blend))))
    add_value(emitter, "string", "falloff", "smoothstep")
    if radius > 0:
        add_value(emitter, "float", "radius", radius)
    return emitter


def _sun(light, power, place, light_object):
    emitter = plugin("emitter", "directional")
    place.then(lambda matrix: without_scale(matrix) @ _TURN).add_to(emitter)
    if not getattr(light, "normalize", True) and light.angle > 0:
        power = _scaled(power, math.pi * math.sin(light.angle / 2) ** 2)  # it was a radiance
    add_value(emitter, "rgb", "irradiance", power)
    if light.angle > 0:
        add_value(emitter, "float", "angle", math.degrees(light.angle))
        _add_visibility(emitter, light_object)
    return emitter


def _area(context, light, power, place, light_object):
    width, height = light.size, light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    is_round = light.shape in {"DISK", "ELLIPSE"}
    axes = place.now.to_3x3().col
    area = axes[0].cross(axes[1]).length * width * height * (math.pi / 4 if is_round else 1)
    if not area > 0:
        context.report.add("an area lamp without area is not exported", light_object.name)
        return None
    normalized = getattr(light, "normalize", True)
    size = mathutils.Matrix.Diagonal((width / 2, height / 2, 1, 1))
    radiance = _scaled(power, 1 / (math.pi * (area if normalized else 1)))
    return _shining_shape("disk" if is_round else "rectangle", radiance, place.then(lambda m: m @ size @ _TURN),
                          light_object, light.spread)


def export_light(context, light_object, place):
    """The elements of an evaluated light object in a Place, a list."""
    light, name = light_object.data, light_object.name
    if getattr(light.cycles, "is_portal", False):
        return []  # it only guides the samples of the world
    power = power_of(context, light, name)
    if not any(power):
        return []
    if any(channel < 0 for channel in power):
        context.report.add("a lamp of negative strength is not exported", name)
        return []
    if not light.use_shadow:
        context.report.add("a lamp without shadows casts them", name)
    for ray in ("diffuse", "glossy", "transmission", "volume_scatter"):
        if not getattr(light_object, f"visible_{ray}"):
            context.report.add(f"a lamp that is invisible to {ray.replace('_', ' ')} rays is visible to them", name)
    linking = getattr(light_object, "light_linking", None)
    if linking is not None and (linking.receiver_collection or linking.blocker_collection):
        context.report.add("light linking is not exported; the lamp lights all", name)
    if light.type == "POINT":
        made = _point(light, power, place, light_object)
    elif light.type == "SPOT":
        made = _spot(context, light, power, place, name)
    elif light.type == "SUN":
        made = _sun(light, power, place, light_object)
    else:
        made = _area(context, light, power, place, light_object)
    return [made] if made is not None else []
