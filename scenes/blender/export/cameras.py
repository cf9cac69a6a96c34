# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's cameras as sensors."""

import math

import mathutils

from .elements import add_matrix, add_value, plugin

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


def export_camera(context, scene, camera_object):
    """The <sensor> with its film, of the evaluated object."""
    camera = camera_object.data
    size = FilmSize(scene.render, camera)
    to_world = without_scale(camera_object.matrix_world) @ _TURN
    sensor = plugin("sensor", "perspective")
    half_width = 0.5 * size.width / size.fitted * size.sensor / camera.lens
    add_value(sensor, "float", "fov", math.degrees(2 * math.atan(half_width)))
    add_value(sensor, "string", "fov_axis", "x")
    add_value(sensor, "float", "pixel_aspect", size.pixel_aspect)
    add_value(sensor, "float", "near_clip", camera.clip_start)
    add_value(sensor, "float", "far_clip", camera.clip_end)
    add_matrix(sensor, to_world)
    film = plugin("film", "hdrfilm")
    add_value(film, "integer", "width", size.width)
    add_value(film, "integer", "height", size.height)
    sensor.append(film)
    return sensor
