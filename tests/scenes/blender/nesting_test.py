"""What an export says of media that cannot add up, and of instances that look alike."""

import tempfile
import unittest
from xml.etree import ElementTree

import bpy

from blender.export.shot import export_shot
from cycles_comparison import add_camera, empty_scene
from material_scenes import add_node, link, material
from unit_scenes import active, density_grid, volume


def exported(scene):
    """The <scene>, and the lines of the report."""
    with tempfile.TemporaryDirectory() as folder:
        paths, report = export_shot(folder, scene, [scene.frame_current])
        return ElementTree.parse(paths[0]).getroot(), report.lines


def fog(size, place=(0, 0, 0), density=1.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=place)
    return active(volume("ShaderNodeVolumeAbsorption", {"Color": (0, 0, 0), "Density": density}))


class Nesting(unittest.TestCase):

    def setUp(self):
        self.scene = empty_scene()
        add_camera(self.scene, (0, -9, 0), (0, 0, 0))

    def test_inner_media_add_up(self):
        fog(2, density=0.25)
        fog(1, density=0.5)
        root, lines = exported(self.scene)
        absorbed = {medium.get("id"): medium.find("rgb[@name='sigma_a']").get("value").split(",")[0]
                    for medium in root.findall("medium")}
        sides = set()
        for shape in root.findall("shape"):
            media = {ref.get("name"): absorbed[ref.get("id")] for ref in shape.findall("ref") if ref.get("name")}
            sides.add((media.get("interior"), media.get("exterior")))
        self.assertEqual(sides, {("0.25", None), ("0.75", "0.25")})
        self.assertEqual(lines, [])

    def test_the_camera_is_in_a_medium(self):
        fog(2, (0, -9, 0))
        root, _ = exported(self.scene)
        self.assertIsNotNone(root.find("sensor/ref[@name='medium']"))

    def test_crossing_surfaces_are_named(self):
        fog(2)
        fog(2, (0.5, 0.3, 0.2))
        line = 'material "volume": its surface crosses that of the volume "volume.001"; where both are, one counts'
        self.assertIn(line, exported(self.scene)[1])

    def test_media_around_grids_are_named(self):
        density_grid(self.scene, "grid")
        fog(8)
        self.assertIn('material "volume": within the box of the grid there is no other medium', exported(self.scene)[1])

    def test_instances_with_values_of_the_object_are_named(self):
        made, shader, _ = material("random", "ShaderNodeBsdfDiffuse")
        link(made, add_node(made, "ShaderNodeObjectInfo").outputs["Random"], shader.inputs["Color"])
        bpy.ops.mesh.primitive_plane_add()
        inner = bpy.data.collections.new("inner")
        obj = active(made)
        self.scene.collection.objects.unlink(obj)
        inner.objects.link(obj)
        for x in (0, 3):
            empty = bpy.data.objects.new("empty", None)
            empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", inner, (x, 0, 0)
            self.scene.collection.objects.link(empty)
        self.assertIn('object "Plane": what its material has of the object and its place is the same for all instances',
                      exported(self.scene)[1])


if __name__ == "__main__":
    unittest.main()
