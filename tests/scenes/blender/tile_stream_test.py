"""Receiving tiles: what tev's protocol says arrives, what it does not say is refused; `penumbra` sends the former."""

import socket
import struct
import unittest

import numpy

from blender import program
from blender.tile_stream import TileStream
from engine_scene import EngineTest, read_exr


def packet(operation, *parts):
    """As tev's README describes: length with itself, operation, arguments."""
    body = struct.pack("<B", operation) + b"".join(parts)
    return struct.pack("<I", len(body) + 4) + body


def image(width, height):
    return packet(4, b"\1", b"render\0", struct.pack("<iii", width, height, 3), b"R\0G\0B\0")


def tile(x, y, values, names=("R", "G", "B")):
    """values: (height, width, channels)."""
    height, width, count = values.shape
    numbers = struct.pack(f"<iiii{2 * count}q", x, y, width, height, *range(count), *[count] * count)
    return packet(6, b"\0", b"render\0", struct.pack("<i", count), b"".join(name.encode() + b"\0" for name in names),
                  numbers, values.astype("<f4").tobytes())


class Packets(unittest.TestCase):

    def received(self, *packets):
        """The stream after these packets."""
        stream = TileStream()
        self.addCleanup(stream.close)
        host, port = stream.address.split(":")
        with socket.create_connection((host, int(port))) as connection:
            data = b"".join(packets)
            try:
                for first in range(0, len(data), 7):  # in pieces that no packet fits
                    connection.sendall(data[first:first + 7])
            except (BrokenPipeError, ConnectionResetError):
                pass  # the stream has ended at what is wrong; it says so in `problem`
        stream.drain(5)
        return stream

    def test_tiles_are_placed(self):
        values = numpy.arange(2 * 3 * 3, dtype=float).reshape(2, 3, 3)
        stream = self.received(image(5, 4), tile(1, 2, values))
        expected = numpy.zeros((4, 5, 4))
        expected[2:4, 1:4] = numpy.concatenate([values, numpy.ones((2, 3, 1))], axis=-1)
        numpy.testing.assert_array_equal(stream.image(), expected)
        numpy.testing.assert_array_equal(stream.image((1, 1, 3, 4)), expected[1:4, 1:3])
        self.assertIsNone(stream.problem)

    def test_where_no_tile_is_the_background_shows(self):
        background = numpy.full((2, 2, 4), 0.5, numpy.float32)
        background[1, 1] = 0.25
        stream = self.received(image(4, 4), tile(0, 0, numpy.ones((1, 2, 3))))
        shown = stream.image_over(background)
        numpy.testing.assert_array_equal(shown[0, :2], 1)
        numpy.testing.assert_array_equal(shown[0, 2:], 0.5)
        numpy.testing.assert_array_equal(shown[2:, 2:], 0.25)

    def test_other_channels_are_left_out(self):
        names = ("difference.R", "difference.G", "difference.B")
        stream = self.received(image(2, 2), tile(0, 0, numpy.ones((2, 2, 3)), names))
        self.assertEqual(stream.image()[..., :3].max(), 0)

    def test_what_is_wrong_ends_the_stream(self):
        ones = numpy.ones((2, 2, 3))
        for name, packets in (("outside", [image(2, 2), tile(1, 1, ones)]), ("no image", [tile(0, 0, ones)]),
                              ("short", [image(2, 2), tile(0, 0, ones)[:-8] + image(2, 2)]),
                              ("size", [image(-1, 2)]), ("length", [struct.pack("<I", 2)]),
                              ("long", [struct.pack("<I", 1 << 30)]), ("text", [packet(4, b"\1", b"endless")])):
            with self.subTest(name):
                stream = self.received(*packets)
                self.assertIsNotNone(stream.problem)

    def test_closing_ends_a_stream_that_nobody_uses(self):
        TileStream().close()


class FromPenumbra(EngineTest):

    def test_the_tiles_are_the_image(self):
        from blender.export.shot import export_shot
        paths, _ = export_shot(self.folder, self.scene, [1])
        stream = TileStream()
        self.addCleanup(stream.close)
        program.run(["render", paths[0], "-o", self.folder / "image.exr", "--quiet", "--tile", "16", "--tev",
                     stream.address, "--set", "film.compression=zip"])
        stream.drain()
        self.assertGreater(stream.version, 3)
        file = read_exr(self.folder / "image.exr").stack("RGB")
        numpy.testing.assert_allclose(stream.image()[..., :3], file, rtol=1e-6,
                                      err_msg="tiles are the same means")


if __name__ == "__main__":
    unittest.main()
