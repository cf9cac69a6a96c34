# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: Curves objects and the strands of particle systems."""

import hashlib

import numpy

from .elements import add_value, plugin
from .materials import export_material
from .meshes import values_of
from .surfaces import Part

_DEFAULT_RADIUS = 0.01  # Blender's, of curves without radii


def spline_points(points):
    """Control points of uniform cubic B-splines that pass through the points; the second derivative is 0 at the ends.

    points: (curves, n, k) with n >= 2. Returns (curves, n + 2, k).
    """
    count = points.shape[1]
    inner = numpy.array(points, float)
    # At point i a spline is (c[i - 1] + 4 c[i] + c[i + 1]) / 6, and c[i] at its ends. Thomas's algorithm.
    factors = numpy.zeros(count)
    right = 6 * inner
    right[:, [0, -1]] = inner[:, [0, -1]]
    for i in range(1, count - 1):
        divisor = 4 - factors[i - 1]
        factors[i] = 1 / divisor
        right[:, i] = (right[:, i] - right[:, i - 1]) / divisor
    for i in range(count - 2, 0, -1):
        right[:, i] -= factors[i] * right[:, i + 1]
    first = 2 * right[:, :1] - right[:, 1:2]
    last = 2 * right[:, -1:] - right[:, -2:-1]
    return numpy.concatenate([first, right, last], axis=1)


def _text(curves):
    """The file of curves, each (n, 4): positions and radii."""
    row = "%.9g %.9g %.9g %.9g\n"
    return "\n".join((row * len(curve)) % tuple(curve.ravel()) for curve in curves)


def _write(context, curves, linear):
    text = _text(curves).encode("ascii")
    shape = plugin("shape", "linearcurve" if linear else "bsplinecurve")
    path = context.file("curves", ".txt", hashlib.sha256(text).digest(), lambda path: path.write_bytes(text))
    add_value(shape, "string", "filename", path)
    return shape


def curve_shape(context, points, lengths):
    """The <shape> of curves through points. points: (n, 4) positions and radii. lengths: points of each curve.

    Curves of one point are left out. None without any other.
    """
    scene = context.depsgraph.scene
    kind = getattr(getattr(scene, "cycles_curves", None), "shape", "RIBBONS")
    linear = kind == "THICK_LINEAR"
    starts = numpy.cumsum(lengths) - lengths
    curves = {}
    for length in numpy.unique(lengths[lengths >= 2]):
        chosen = numpy.flatnonzero(lengths == length)
        table = points[starts[chosen][:, None] + numpy.arange(length)]
        if not linear:
            table = spline_points(table)
            table[:, :, 3] = numpy.maximum(table[:, :, 3], 0)
        curves.update(zip(chosen, table))
    if not curves:
        return None
    shape = _write(context, [curves[index] for index in sorted(curves)], linear)
    if kind == "RIBBONS":
        add_value(shape, "string", "form", "cylinder")
    return shape


def curve_parts(context, obj, materials):
    """The parts of an evaluated Curves object. All curves have the material of the first slot."""
    curves = obj.data
    positions = values_of(curves.attributes["position"].data, "vector", 3)
    radii = curves.attributes.get("radius")
    points = numpy.column_stack([positions, values_of(radii.data, "value", 1) if radii is not None
                                 else numpy.full(len(positions), _DEFAULT_RADIUS)])
    shape = curve_shape(context, points, values_of(curves.curves, "points_length", 1, numpy.int32))
    if shape is None:
        return []
    if len(materials) > 1:
        context.report.add("curves are exported with the material of the first slot", obj.name)
    material = materials[0]
    return [Part(shape, export_material(material, obj, context), material.name if material else "default")]


def strand_radii(settings, count):
    """Radii along a strand of `count` points, by the hair shape of ParticleSettings."""
    rest = 1 - numpy.arange(count) / (count - 1)
    rest = rest ** (1 + settings.shape if settings.shape < 0 else 1 / (1 - min(settings.shape, 0.999999)))
    radii = rest * (settings.root_radius - settings.tip_radius) + settings.tip_radius
    if settings.use_close_tip:
        radii[-1] = 0
    return radii * settings.radius_scale * 0.5


def strand_parts(context, obj, materials):
    """The parts of an evaluated object's particle systems that are hair, in the object's space."""
    parts = []
    to_object = numpy.array(obj.matrix_world.inverted_safe())
    for modifier in obj.modifiers:
        if modifier.type != "PARTICLE_SYSTEM":
            continue
        system = modifier.particle_system
        settings = system.settings
        render = context.depsgraph.mode == "RENDER"
        if settings.type != "HAIR" or settings.render_type != "PATH" or not (
                modifier.show_render if render else modifier.show_viewport):
            continue
        steps = 2 ** (settings.render_step if render else settings.display_step) + 1
        parents = 0 if settings.child_type != "NONE" and not settings.use_parent_particles else len(system.particles)
        first = 0 if parents else len(system.particles)
        strands = []
        for number in range(first, len(system.particles) + len(system.child_particles)):
            strand = [system.co_hair(obj, particle_no=number, step=step) for step in range(steps)]
            strands.append(strand)
        if not strands:
            continue
        points = numpy.array(strands) @ to_object[:3, :3].T + to_object[:3, 3]
        radii = numpy.broadcast_to(strand_radii(settings, steps), points.shape[:2])
        table = numpy.concatenate([points, radii[..., None]], axis=2).reshape(-1, 4)
        shape = curve_shape(context, table, numpy.full(len(strands), steps))
        material = materials[min(settings.material, len(materials)) - 1]
        parts.append(Part(shape, export_material(material, obj, context), material.name if material else "default"))
    return parts
