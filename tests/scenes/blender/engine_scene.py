"""A small scene and the enabled extension, for tests of the engine. PENUMBRA_PROGRAM names the program."""

import os
import pathlib
import tempfile
import unittest
import unittest.mock

import bpy
import numpy

import blender
from blender.exr import read as read_exr
from cycles_comparison import add_camera, empty_scene, program, set_world

WIDTH, HEIGHT = 40, 24


class EngineTest(unittest.TestCase):
    """Has the extension enabled, a scene with a cube on a floor under a lamp, and a folder."""

    def setUp(self):
        if program() is None:
            self.skipTest("there is no program penumbra: PENUMBRA_PROGRAM does not name it, and PATH lacks it")
        environment = unittest.mock.patch.dict(os.environ, PENUMBRA=program())
        environment.start()
        self.addCleanup(environment.stop)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = empty_scene(WIDTH, HEIGHT)  # before registering, since it resets Blender
        blender.register()
        self.addCleanup(blender.unregister)
        scene = self.scene
        scene.render.engine = "PENUMBRA"
        scene.penumbra.samples = 4
        set_world(scene, (0.2, 0.3, 0.4))
        add_camera(scene, (6, -5, 4), (0, 0, 0))
        self.cube = self.add_mesh("Cube", bpy.ops.mesh.primitive_cube_add, size=2)
        self.add_mesh("Floor", bpy.ops.mesh.primitive_plane_add, size=4, location=(0, 0, -1))
        lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        lamp.data.energy = 500
        lamp.location = (2, -3, 4)
        scene.collection.objects.link(lamp)

    def add_mesh(self, name, operator, **arguments):
        operator(**arguments)
        obj = bpy.context.active_object
        obj.name = name
        return obj

    def render(self, name="image", **arguments):
        """Renders to a file with all passes. Returns it as exr.Image."""
        settings = self.scene.render.image_settings
        if bpy.app.version >= (5, 0):
            settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format = "OPEN_EXR_MULTILAYER"
        settings.color_depth = "32"
        settings.exr_codec = "ZIP"
        if hasattr(settings, "use_exr_interleave"):
            settings.use_exr_interleave = True  # one part
        self.scene.render.filepath = str(self.folder / f"{name}.exr")
        bpy.ops.render.render(write_still=True, **arguments)
        return read_exr(self.scene.render.filepath)

    def combined(self, image, layer="ViewLayer"):
        """(height, width, 4)."""
        return pass_of(image, "Combined", "RGBA", layer)


def pass_of(image, name, channels, layer="ViewLayer"):
    """A pass of a multilayer file of Blender: (height, width, channels)."""
    values = image.stack([f"{layer}.{name}.{channel}" for channel in channels])
    if values is None:
        raise KeyError(f"{layer}.{name} is not among {sorted(image.channels)}")
    return values


def is_same(a, b):
    """Whether arrays have the same shape and values."""
    return a.shape == b.shape and numpy.array_equal(a, b)
