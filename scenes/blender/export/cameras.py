# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's cameras and films as sensors."""

import math

import mathutils

from ..properties import settings_of
from .elements import add_value, plugin

# Blender's cameras look along -z with x to the right; sensors look along +z with x to the left.
_TURN = mathutils.Matrix.Diagonal((-1, 1, -1, 1))


def without_scale(matrix):
    """The 4 × 4 matrix with axes of length 1 at right angles."""
    place, rotation, _ = matrix.decompose()
    return mathutils.Matrix.LocRotScale(place, rotation, None)


class FilmSize:
    """Pixels of the picture, and what the camera's sensor fits to."""

    def __init__(self, render, camera):
        scale = render.resolution_percentage / 100
        self.width = max(1, int(render.resolution_x * scale))
        self.height = max(1, int(render.resolution_y * scale))
        self.pixel_aspect = render.pixel_aspect_y / render.pixel_aspect_x
        tall = self.height * self.pixel_aspect
        fit = camera.sensor_fit
        if fit == "AUTO":
            self.is_horizontal = self.width >= tall
            self.sensor = camera.sensor_width
        else:
            self.is_horizontal = fit == "HORIZONTAL"
            self.sensor = camera.sensor_width if self.is_horizontal else camera.sensor_height
        self.fitted = self.width if self.is_horizontal else tall  # in widths of pixels
        # Shifts are in lengths of the fitted side.
        self.shift_x = camera.shift_x * self.fitted / self.width
        self.shift_y = camera.shift_y * self.fitted / tall


def panorama_type(camera):
    """The kind of panorama: a property of cameras since Blender 5.0, before that of Cycles."""
    return getattr(camera if hasattr(camera, "panorama_type") else camera.cycles, "panorama_type")


def _panorama_value(camera, name):
    """A setting of panoramas, wherever this version has it."""
    return getattr(camera if hasattr(camera, "panorama_type") else camera.cycles, name)


def _panorama(context, camera, size, name):
    """The sensor of a panorama without its place."""
    kind = panorama_type(camera)
    if kind == "EQUIRECTANGULAR":
        sensor = plugin("sensor", "equirectangular")
        for edge in ("longitude_min", "longitude_max", "latitude_min", "latitude_max"):
            # Rounded, since Blender's numbers of single precision are a little beyond a full turn.
            add_value(sensor, "float", edge, round(math.degrees(_panorama_value(camera, edge)), 4))
    elif kind == "FISHEYE_EQUIDISTANT":
        sensor = plugin("sensor", "fisheye_equidistant")
        add_value(sensor, "float", "fisheye_fov", min(360, math.degrees(_panorama_value(camera, "fisheye_fov"))))
        add_value(sensor, "string", "fov_axis", "smaller")
        if size.width != size.height:
            context.report.add("a fisheye's circle is as wide as the shorter side of the film", name)
    elif kind == "FISHEYE_EQUISOLID":
        sensor = plugin("sensor", "fisheye_equisolid")
        add_value(sensor, "float", "fisheye_fov", min(360, math.degrees(_panorama_value(camera, "fisheye_fov"))))
        add_value(sensor, "float", "fisheye_lens", _panorama_value(camera, "fisheye_lens"))
        # The sensor's size is that of the fitted side.
        add_value(sensor, "float", "sensor_width", size.sensor * size.width / size.fitted)
    elif kind == "CENTRAL_CYLINDRICAL":
        sensor = plugin("sensor", "cylindrical")
        radius = _panorama_value(camera, "central_cylindrical_radius")
        for ours, theirs in (("longitude_min", "u_min"), ("longitude_max", "u_max")):
            add_value(sensor, "float", ours,
                      math.degrees(_panorama_value(camera, f"central_cylindrical_range_{theirs}")))
        for ours, theirs in (("height_min", "v_min"), ("height_max", "v_max")):
            add_value(sensor, "float", ours, _panorama_value(camera, f"central_cylindrical_range_{theirs}") / radius)
    else:
        context.report.add(f"a panorama of type {kind} is exported as an equirectangular one", name)
        sensor = plugin("sensor", "equirectangular")
    if kind != "FISHEYE_EQUIDISTANT" and (camera.shift_x or camera.shift_y):
        context.report.add("the shift of a panorama is not exported", name)
    return sensor


def _focus_distance(camera, matrix):
    """The distance along the view that is in focus."""
    dof = camera.dof
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.matrix_world
    bone = dof.focus_object.pose.bones.get(dof.focus_subtarget) if dof.focus_object.pose is not None else None
    place = (target @ bone.matrix if bone is not None else target).translation
    view = without_scale(matrix).to_3x3() @ mathutils.Vector((0, 0, -1))
    return abs(view.dot(place - matrix.translation))


def _add_lens(context, sensor, camera, matrix, name):
    dof = camera.dof
    # Millimetres of the lens over the f-number are the diameter; an orthographic camera has no lens's length.
    length = 1.0 if camera.type == "ORTHO" else camera.lens * 1e-3
    add_value(sensor, "float", "aperture_radius", length / (2 * dof.aperture_fstop))
    add_value(sensor, "float", "focus_distance", max(_focus_distance(camera, matrix), 1e-5))
    if dof.aperture_blades >= 3:
        add_value(sensor, "integer", "blades", dof.aperture_blades)
        add_value(sensor, "float", "blade_rotation", math.degrees(dof.aperture_rotation))
    if abs(dof.aperture_ratio - 1) > 1e-3:
        context.report.add("the ratio of an anamorphic aperture is not exported", name)


def export_camera(context, scene, camera_object, place):
    """The <sensor> with its film, of the evaluated object in a Place."""
    camera, name = camera_object.data, camera_object.name
    size = FilmSize(scene.render, camera)
    has_lens = camera.dof.use_dof and camera.dof.aperture_fstop < 1e5
    stretch = mathutils.Matrix()
    if camera.type == "PANO":
        sensor = _panorama(context, camera, size, name)
    elif camera.type == "ORTHO":
        sensor = plugin("sensor", "telecentric" if has_lens else "orthographic")
        half_width = 0.5 * camera.ortho_scale * size.width / size.fitted
        stretch = mathutils.Matrix.Diagonal((half_width, half_width * size.pixel_aspect, 1, 1))
    else:
        sensor = plugin("sensor", "thinlens" if has_lens else "perspective")
        half_width = 0.5 * size.width / size.fitted * size.sensor / camera.lens
        add_value(sensor, "float", "fov", math.degrees(2 * math.atan(half_width)))
        add_value(sensor, "string", "fov_axis", "x")
        if size.pixel_aspect != 1:
            add_value(sensor, "float", "pixel_aspect", size.pixel_aspect)
    if has_lens:
        _add_lens(context, sensor, camera, place.now, name)
    if camera.type != "PANO":
        add_value(sensor, "float", "near_clip", camera.clip_start)
        add_value(sensor, "float", "far_clip", camera.clip_end)
        if size.shift_x or size.shift_y:
            add_value(sensor, "float", "principal_point_offset_x", size.shift_x)
            add_value(sensor, "float", "principal_point_offset_y", -size.shift_y)
    if place.shutter.is_open:
        add_value(sensor, "float", "shutter_open", place.shutter.seconds[0])
        add_value(sensor, "float", "shutter_close", place.shutter.seconds[-1])
    place.then(lambda matrix: without_scale(matrix) @ _TURN @ stretch).add_to(sensor)
    sensor.append(export_film(context, scene, size))
    settings = settings_of(scene)
    sampler = plugin("sampler", "independent")
    add_value(sampler, "integer", "sample_count", settings.samples)
    add_value(sampler, "integer", "seed", settings.seed)
    sensor.append(sampler)
    return sensor


def _filter(kind, width):
    """The reconstruction filter of a kind of Cycles'."""
    if kind == "BOX":
        return plugin("rfilter", "box")
    made = plugin("rfilter", "gaussian")
    # Cycles' Gaussian is exp(-8 (x / width)²). A Blackman-Harris window of length L has nearly the shape of a Gaussian
    # with a standard deviation of 0.1385 L (the square root of its second moment); Cycles' is 2 widths long.
    add_value(made, "float", "stddev", width / 4 if kind == "GAUSSIAN" else 0.1385 * 2 * width)
    return made


def export_film(context, scene, size):
    """The <film>."""
    render = scene.render
    film = plugin("film", "hdrfilm")
    add_value(film, "integer", "width", size.width)
    add_value(film, "integer", "height", size.height)
    if render.use_border:
        left, right = int(render.border_min_x * size.width), int(render.border_max_x * size.width)
        low, high = int(render.border_min_y * size.height), int(render.border_max_y * size.height)
        add_value(film, "integer", "crop_offset_x", left)
        add_value(film, "integer", "crop_offset_y", size.height - high)
        add_value(film, "integer", "crop_width", max(1, right - left))
        add_value(film, "integer", "crop_height", max(1, high - low))
    if render.film_transparent:
        add_value(film, "string", "pixel_format", "rgba")
    cycles = getattr(scene, "cycles", None)
    if getattr(cycles, "film_exposure", 1) != 1:
        context.report.add("the film's exposure is not exported; multiply the picture by it")
    film.append(_filter(getattr(cycles, "pixel_filter_type", "BLACKMAN_HARRIS"), settings_of(scene).filter_width))
    return film
