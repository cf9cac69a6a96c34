"""Arrays of meshes and curves, and how long a large mesh takes."""

import pathlib
import re
import tempfile
import time
import types
import unittest

import bpy
import numpy

from cycles_comparison import add_camera, empty_scene

from blender.export import curves, meshes, ply
from blender.export.context import Context
from blender.export.shot import export_shot


class Splines(unittest.TestCase):
    def test_pass_through_their_points(self):
        points = numpy.random.default_rng(1).normal(size=(5, 7, 4))
        control = curves.spline_points(points)
        self.assertEqual(control.shape, (5, 9, 4))
        at_knots = (control[:, :-2] + 4 * control[:, 1:-1] + control[:, 2:]) / 6
        numpy.testing.assert_allclose(at_knots, points, atol=1e-12)
        ends = [control[:, i] - 2 * control[:, i + 1] + control[:, i + 2] for i in (0, -3)]
        numpy.testing.assert_allclose(ends, 0, atol=1e-12)

    def test_of_two_points_are_straight(self):
        control = curves.spline_points(numpy.array([[[0.0, 0, 0, 1], [3, 6, 9, 2]]]))
        numpy.testing.assert_allclose(control[0, :, 0], [-3, 0, 3, 6])


class Strands(unittest.TestCase):
    def test_radii(self):
        settings = types.SimpleNamespace(shape=0.0, root_radius=1.0, tip_radius=0.2, radius_scale=0.1,
                                         use_close_tip=False)
        numpy.testing.assert_allclose(curves.strand_radii(settings, 5), [0.05, 0.04, 0.03, 0.02, 0.01])
        settings.use_close_tip, settings.shape = True, 0.5  # (1 - t)²
        numpy.testing.assert_allclose(curves.strand_radii(settings, 3), [0.05, 0.02, 0])


class Vertices(unittest.TestCase):
    def test_become_several_only_where_corners_differ(self):
        corners = numpy.array([0, 1, 2, 2, 1, 3, 3, 3])
        values = numpy.array([[1.0], [2], [3], [3], [5], [6], [7], [6]])
        vertex, chosen = meshes.split_vertices(corners, values)
        self.assertEqual(len(chosen), 6)
        numpy.testing.assert_array_equal(corners[chosen[vertex]], corners)
        numpy.testing.assert_array_equal(values[chosen[vertex]], values)

    def test_may_have_many_different_corners(self):
        """More than are compared one after another."""
        generator = numpy.random.default_rng(2)
        corners = generator.integers(0, 4, 400)
        values = generator.integers(0, 30, (400, 2)).astype(numpy.float32)
        vertex, chosen = meshes.split_vertices(corners, values)
        self.assertEqual(len(chosen), len({(corner, *pair) for corner, pair in zip(corners.tolist(), values.tolist())}))
        numpy.testing.assert_array_equal(corners[chosen[vertex]], corners)
        numpy.testing.assert_array_equal(values[chosen[vertex]], values)


class PlyFiles(unittest.TestCase):
    def test_names_have_no_spaces(self):
        corners = numpy.zeros((3, 3))
        header = ply.ply_bytes(corners, numpy.array([[0, 1, 2]]), colours={"my paint": corners})[0]
        self.assertIn(b"property float my_paint_r\n", header)

    def test_flat_meshes_share_vertices(self):
        scene = empty_scene()
        bpy.ops.mesh.primitive_cube_add()
        mesh = bpy.context.object.data
        while mesh.uv_layers:
            mesh.uv_layers.remove(mesh.uv_layers[0])
        add_camera(scene, (0, -5, 0), (0, 0, 0))
        with tempfile.TemporaryDirectory() as folder:
            export_shot(folder, scene, [1])
            path, = pathlib.Path(folder, "meshes").iterdir()
            self.assertIn(b"element vertex 8\n", path.read_bytes())


class LargeMeshes(unittest.TestCase):

    def test_a_million_triangles(self):
        empty_scene()
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=708, y_subdivisions=708)
        bpy.ops.object.shade_smooth()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        mesh = bpy.context.object.evaluated_get(depsgraph).data
        with tempfile.TemporaryDirectory() as folder:
            began = time.process_time()
            arrays = meshes.read_mesh(mesh)
            meshes.write_part(Context(folder, depsgraph), arrays, arrays.triangles, meshes.uvs_of_corners(mesh, None))
            took = time.process_time() - began
            path, = pathlib.Path(folder, "meshes").iterdir()
            header = path.read_bytes()[:1000]
        print(f"{len(arrays.triangles)} triangles in {took:.2f} s of a core")
        self.assertIn(b"element face %d\n" % (2 * 708**2), header)
        vertices = int(re.search(rb"element vertex (\d+)", header)[1])
        self.assertLess(vertices, 1.02 * 709**2, "corners are shared, but where Blender's coordinates are not quite equal")


if __name__ == "__main__":
    unittest.main()
