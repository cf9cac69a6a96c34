"""The reader of OpenEXR files against Blender's own."""

import pathlib
import tempfile
import unittest

import bpy
import numpy

from blender import exr

WIDTH, HEIGHT = 37, 41  # more than two blocks of 16 lines, and odd


class Reader(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "image.exr"
        pixels = numpy.random.default_rng(1).exponential(1, (HEIGHT, WIDTH, 4)).astype(numpy.float32)
        pixels[:20, :, 1] = 0.25  # something that compresses
        pixels[..., 3] = 0.5
        self.pixels = pixels

    def written(self, codec, depth):
        """The image that Blender writes of the pixels."""
        image = bpy.data.images.new("image", WIDTH, HEIGHT, alpha=True, float_buffer=True)
        self.addCleanup(bpy.data.images.remove, image)
        image.alpha_mode = "PREMUL"
        image.pixels.foreach_set(self.pixels[::-1].ravel())
        settings = bpy.context.scene.render.image_settings
        if bpy.app.version >= (5, 0):
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
        settings.color_depth, settings.exr_codec = depth, codec
        image.save_render(str(self.path))
        return exr.read(self.path)

    def test_floats(self):
        for codec in ("NONE", "ZIP", "ZIPS"):
            with self.subTest(codec):
                read = self.written(codec, "32").stack("RGBA")
                self.assertTrue(numpy.array_equal(read, self.pixels))

    def test_half_floats(self):
        for codec in ("NONE", "ZIP", "ZIPS"):
            with self.subTest(codec):
                read = self.written(codec, "16").stack("RGBA")
                # Half floats have 11 bits.
                numpy.testing.assert_allclose(read, self.pixels, rtol=2.0 ** -11, atol=2.0 ** -24)

    def test_what_is_not_read_is_named(self):
        self.assertRaisesRegex(ValueError, "compression 4", self.written, "PIZ", "32")
        self.written("ZIP", "32")
        data = self.path.read_bytes()
        self.path.write_bytes(data[:len(data) // 2])
        self.assertRaisesRegex(ValueError, "image.exr", exr.read, self.path)
        self.path.write_bytes(b"\x89PNG\r\n\x1a\n")
        self.assertRaisesRegex(ValueError, "no OpenEXR file", exr.read, self.path)


if __name__ == "__main__":
    unittest.main()
