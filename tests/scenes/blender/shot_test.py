"""The frames of a shot share what stays the same, and Blender's data is read again only where it changes."""

import pathlib
import tempfile
import unittest
from unittest import mock
from xml.etree import ElementTree

import bpy
import numpy

from cycles_comparison import add_camera, empty_scene
from unit_scenes import add_light, diffuse, keyed, particle_system

from blender.export import geometry
from blender.export.shot import export_shot

STILL = 6
FRAMES = range(1, 25)


def ply_positions(path):
    """(n, 3)"""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split()[0])
    width = header.split(b"element face")[0].count(b"property float")
    return numpy.frombuffer(body, "<f4", count * width).reshape(count, width)[:, :3]


class Shots(unittest.TestCase):
    def setUp(self):
        self.scene = empty_scene()
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for index in range(STILL):
            bpy.ops.mesh.primitive_uv_sphere_add(segments=8 + index, ring_count=6, location=(index, 0, 0))
            bpy.context.object.data.materials.append(diffuse())
        bpy.ops.mesh.primitive_cube_add()
        self.moving = bpy.context.object
        keyed(self.moving, "location", (0, 1, 0), (3, 1, 0), (1, 24))
        add_camera(self.scene, (0, -5, 1), (0, 0, 0))
        add_light(self.scene, "POINT", (0, 0, 3), shadow_soft_size=0)

    def export(self, frames=FRAMES, **options):
        """The paths, and how often a mesh was read from Blender."""
        with mock.patch.object(geometry, "read_mesh", wraps=geometry.read_mesh) as read:
            paths, self.report = export_shot(self.folder.name, self.scene, frames, **options)
        return paths, read.call_count

    def meshes(self):
        return list(pathlib.Path(self.folder.name, "meshes").glob("*.ply"))

    def matrices(self, path):
        """The to_world of all shapes."""
        return [tuple(matrix.get("value") for matrix in shape.iter("matrix"))
                for shape in ElementTree.parse(path).getroot().findall("shape")]

    def test_what_stays_is_exported_once(self):
        paths, reads = self.export()
        self.assertEqual([path.name for path in paths], [f"frame.{frame:04d}.xml" for frame in FRAMES])
        self.assertEqual(len(self.meshes()), STILL + 1)
        self.assertEqual(reads, STILL + 1)
        first, last = self.matrices(paths[0]), self.matrices(paths[-1])
        self.assertEqual(sum(a != b for a, b in zip(first, last)), 1)
        self.assertEqual(len(first), STILL + 1)

    def test_only_what_deforms_is_exported_again(self):
        key = self.moving.shape_key_add(name="Basis")
        key = self.moving.shape_key_add(name="taller")
        key.data[0].co.z -= 2
        keyed(key, "value", 0.0, 1.0, (1, 24))
        _, reads = self.export()
        self.assertEqual(len(self.meshes()), STILL + len(FRAMES))
        self.assertEqual(reads, STILL + len(FRAMES))

    def test_materials_may_change(self):
        material = bpy.data.objects["Sphere"].data.materials[0]
        socket = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE").inputs["Color"]
        keyed(socket, "default_value", (0, 0, 0, 1), (1, 1, 1, 1), (1, 24))
        paths, _ = self.export([1, 24])
        self.assertEqual(len(self.meshes()), STILL + 1)
        colours = [[rgb.get("value") for rgb in ElementTree.parse(path).getroot().iter("rgb")
                    if rgb.get("name") == "reflectance"] for path in paths]
        self.assertIn("0.0, 0.0, 0.0", colours[0])
        self.assertIn("1.0, 1.0, 1.0", colours[1])

    def test_several_of_one_mesh_are_instances(self):
        for x in range(3):
            copy = bpy.data.objects["Sphere"].copy()
            copy.location = (x, 2, 0)
            self.scene.collection.objects.link(copy)
        root = ElementTree.parse(self.export([1])[0][0]).getroot()
        kinds = [shape.get("type") for shape in root.findall("shape")]
        self.assertEqual(kinds.count("shapegroup"), 1)
        self.assertEqual(kinds.count("instance"), 4)
        self.assertEqual(kinds.count("ply"), STILL)
        self.assertEqual(len(self.meshes()), STILL + 1)

    def test_what_renders_do_not_show_is_left_out(self):
        bpy.data.objects["Sphere"].hide_render = True
        hidden = bpy.data.collections.new("hidden")
        hidden.hide_render = True
        self.scene.collection.children.link(hidden)
        other = bpy.data.objects["Sphere.001"]
        self.scene.collection.objects.unlink(other)
        hidden.objects.link(other)
        bpy.data.objects["Sphere.002"].hide_viewport = True
        root = ElementTree.parse(self.export([1])[0][0]).getroot()
        self.assertEqual(len(root.findall("shape")), STILL + 1 - 2)

    def test_hair_of_a_hidden_emitter_is_shown(self):
        particle_system(self.moving, "HAIR", 5)
        self.moving.show_instancer_for_render = False
        root = ElementTree.parse(self.export([1])[0][0]).getroot()
        kinds = [shape.get("type") for shape in root.findall("shape")]
        self.assertEqual((kinds.count("ply"), kinds.count("bsplinecurve")), (STILL, 1))

    def test_what_is_left_out_is_named(self):
        bpy.data.objects["Sphere"].is_holdout = True
        bpy.data.objects["Sphere.001"].visible_shadow = False
        self.export([1])
        self.assertEqual(self.report.lines, [
            'object "Sphere": a holdout or shadow catcher is exported as any other object',
            'object "Sphere.001": invisible to shadow rays, but exported as visible'])

    def test_another_camera_and_the_settings_stay(self):
        other = add_camera(self.scene, (0, -9, 1), (0, 0, 0), 20)
        self.scene.camera = bpy.data.objects["Camera"]
        self.scene.frame_set(7)
        paths, _ = self.export([3], camera=other.name)
        self.assertAlmostEqual(float(ElementTree.parse(paths[0]).getroot().find("sensor/float").get("value")), 20, 3)
        self.assertEqual((self.scene.frame_current, self.scene.camera.name, self.scene.render.engine),
                         (7, "Camera", "CYCLES"))

    def test_motion_blur_has_keys_of_what_moves(self):
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 0.5
        paths, reads = self.export([12])
        root = ElementTree.parse(paths[0]).getroot()
        animated = root.findall("shape/animation")
        self.assertEqual(len(animated), 1)
        rate = self.scene.render.fps
        times = [float(transform.get("time")) * rate for transform in animated[0]]
        for found, wanted in zip(times, (11.75, 12, 12.25), strict=True):
            self.assertAlmostEqual(found, wanted, 6)
        self.assertEqual(reads, STILL + 1)

    def test_motion_blur_has_files_of_what_deforms(self):
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 0.5
        self.moving.shape_key_add(name="Basis")
        key = self.moving.shape_key_add(name="taller")
        key.data[0].co.z -= 2
        keyed(key, "value", 0.0, 1.0, (11, 13))
        self.moving.cycles.motion_steps = 2
        # Nothing moves here in spite of a modifier.
        still = bpy.data.objects["Sphere"]
        still.modifiers.new("wave", "WAVE").height = 0
        paths, _ = self.export([12, 20])
        root = ElementTree.parse(paths[0]).getroot()
        (files,) = [found for found in root.findall("shape/animation") if found.get("name") == "filename"]
        rate = self.scene.render.fps
        for found, wanted in zip(files, (11.75, 11.875, 12, 12.125, 12.25), strict=True):
            self.assertAlmostEqual(float(found.get("time")) * rate, wanted, 6)
        heights = [ply_positions(pathlib.Path(self.folder.name, file.get("value")))[:, 2].min() for file in files]
        values = []
        for file in files:
            frame = float(file.get("time")) * rate
            self.scene.frame_set(int(frame), subframe=frame % 1)
            values.append(key.value)
        numpy.testing.assert_allclose(heights, [-1 - 2 * value for value in values], 1e-5)  # in single precision
        self.assertGreater(values[-1] - values[0], 0.2)
        # It stands still then.
        self.assertEqual([found.get("name") for found in ElementTree.parse(paths[1]).getroot().findall(
            "shape/animation")], ["to_world"])
        self.assertEqual(self.report.lines, [])

    def test_what_changes_its_faces_is_named(self):
        self.scene.render.use_motion_blur = True
        modifier = self.moving.modifiers.new("build", "BUILD")
        modifier.frame_start, modifier.frame_duration = 10, 6  # one of its faces a frame
        paths, _ = self.export([12])
        self.assertEqual(self.report.lines, [
            'object "Cube": its faces change while the shutter is open; they are those of the frame'])
        files = [found.get("name") for found in ElementTree.parse(paths[0]).getroot().findall("shape/animation")]
        self.assertEqual(files, ["to_world"])

    def test_errors_arrive(self):
        with self.assertRaises(KeyError):
            export_shot(self.folder.name, self.scene, [1], camera="nobody")
        with mock.patch.object(geometry, "read_mesh", side_effect=OSError("disk full")):
            with self.assertRaisesRegex(OSError, "disk full"):
                export_shot(self.folder.name, self.scene, [1])
        self.assertEqual(self.scene.render.engine, "CYCLES")


if __name__ == "__main__":
    unittest.main()
