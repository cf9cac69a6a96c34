"""What `penumbra` makes of .blend files, by command_line.py."""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import bpy

PENUMBRA = os.environ["PENUMBRA_PROGRAM"]
SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scenes" / "blender" / "command_line.py"


def write_shot(path):
    """A cube that moves over a plane in frames 1 to 5, 25 a second, seen by the cameras Front and Side."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, -0.5))
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = bpy.context.object
    for frame, x in ((1, -1), (5, 1)):
        cube.location.x = x
        cube.keyframe_insert("location", frame=frame)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy = 300
    lamp.location = (2, -2, 3)
    scene.collection.objects.link(lamp)
    for name, location, turn in (("Front", (0, -6, 2), 0), ("Side", (6, 0, 2), 1.5708)):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.location = location
        camera.rotation_euler = (1.3, 0, turn)
        scene.collection.objects.link(camera)
    scene.camera = bpy.data.objects["Front"]
    scene.render.fps = 25
    scene.render.resolution_x, scene.render.resolution_y = 32, 24
    scene.frame_end = 5
    scene.frame_set(3)
    bpy.data.scenes.new("Empty")
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


class CommandLine(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "tmp").mkdir()
        write_shot(self.folder / "shot.blend")

    def penumbra(self, *words, code=0):
        environment = dict(os.environ, PENUMBRA_BLENDER=sys.executable, TMPDIR=str(self.folder / "tmp"))
        done = subprocess.run([PENUMBRA, *words], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])
        return done

    def export(self, *words, code=0):
        """The lines of the result."""
        done = subprocess.run([sys.executable, SCRIPT, "shot.blend", "--out=out", "--result=result", *words],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return [json.loads(line) for line in (self.folder / "result").read_text().splitlines()]

    def film_hash(self, name):
        return json.loads((self.folder / name).with_suffix(".json").read_text())["film_hash"]

    def test_a_shot_renders_as_what_was_exported_before(self):
        *frames, whole = self.export("--frames=1-5")
        self.assertEqual([frame["frame"] for frame in frames], [1, 2, 3, 4, 5])
        self.assertEqual(whole["range"], [1, 5, 1])
        self.assertEqual(whole["fps"], 25)
        self.penumbra("render", "out/frame.####.xml", "--frames", "1-5x2", "--spp", "4", "-o", "a.exr")
        self.penumbra("render", "shot.blend", "--frames", "1-5x2", "--spp", "4", "-o", "b.exr", "--workers", "2")
        hashes = [self.film_hash(f"b.000{frame}.exr") for frame in (1, 3, 5)]
        self.assertEqual(hashes, [self.film_hash(f"a.000{frame}.exr") for frame in (1, 3, 5)])
        self.assertEqual(len(set(hashes)), 3)
        self.penumbra("render", "shot.blend", "--spp", "4", "-o", "still.exr")
        self.assertEqual(self.film_hash("still.exr"), hashes[1], "the file is at frame 3")
        self.penumbra("render", "shot.blend", "--spp", "4", "-o", "side.exr", "--camera", "Side")
        self.assertNotEqual(self.film_hash("side.exr"), hashes[1])

    def test_what_stays_the_same_is_written_once(self):
        self.export("--frames=1-5")
        scenes = [path.read_text() for path in sorted((self.folder / "out").glob("frame.*.xml"))]
        self.assertEqual(len(set(scenes)), 5)
        meshes = {name for scene in scenes for name in re.findall(r'value="([^"]*\.ply)"', scene)}
        self.assertEqual(len(meshes), 2, "a plane, and a cube whose mesh does not change")
        self.assertEqual({str(path.relative_to(self.folder / "out")) for path in (self.folder / "out").rglob("*.ply")},
                         meshes)

    def test_an_export_repeats(self):
        self.export("--frames=2")
        first = {path.name: path.read_bytes() for path in (self.folder / "out").rglob("*") if path.is_file()}
        self.export("--frames=2", "--out=again")
        self.assertEqual({path.name: path.read_bytes() for path in (self.folder / "again").rglob("*") if path.is_file()},
                         first)

    def test_settings_of_the_file_count(self):
        from blender import properties
        properties.register()
        self.addCleanup(properties.unregister)
        bpy.context.scene.penumbra.samples = 3
        bpy.context.scene.penumbra.time_budget = 20
        bpy.context.scene.penumbra.denoise = "nfor"
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "shot.blend"))
        info = json.loads(self.penumbra("info", "shot.blend", "--json").stdout)
        self.assertEqual(info["settings"]["spp"], "3")
        self.assertIn("the scene 'Scene' asks for --time-budget 20 --denoise=nfor, which only the command line can",
                      self.export()[-1]["report"])

    def test_wrong_names_are_errors_with_the_nearest(self):
        for option, name, near in (("--camera", "Frnt", "'Front'"), ("--scene", "Emty", "'Empty'"),
                                   ("--view-layer", "ViewLayr", "'ViewLayer'")):
            error = self.export(option, name, code=2)[-1]["error"]
            self.assertIn(f"{name!r}; did you mean {near}?", error)
            self.assertIn(f"shot.blend: {error}", self.penumbra("info", "shot.blend", option, name, code=2).stderr)

    def test_files_that_blender_cannot_open_are_errors(self):
        (self.folder / "shot.blend").write_bytes(b"BLENDER-v402" + bytes(100))
        self.assertIn("cannot open it", self.export(code=2)[-1]["error"])
        self.assertIn("cannot open it", self.penumbra("info", "shot.blend", code=2).stderr)

    def test_scripts_of_the_file_do_not_run(self):
        text = bpy.data.texts.new("own.py")
        text.write(f"open({str(self.folder / 'ran')!r}, 'w')")
        text.use_module = True
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "shot.blend"))
        report = self.export()[-1]["report"]
        self.assertFalse((self.folder / "ran").exists())
        self.assertTrue(any("scripts within the file do not run" in line for line in report), report)

    def test_a_killed_blender_is_an_error(self):
        environment = dict(os.environ, PENUMBRA_BLENDER=sys.executable, TMPDIR=str(self.folder / "tmp"))
        with subprocess.Popen([PENUMBRA, "info", "shot.blend"], cwd=self.folder, env=environment,
                              stderr=subprocess.PIPE, text=True) as program:
            children = pathlib.Path(f"/proc/{program.pid}/task")
            while True:
                blenders = [int(pid) for task in children.iterdir() for pid in (task / "children").read_text().split()
                            if SCRIPT.name in pathlib.Path(f"/proc/{pid}/cmdline").read_text()]
                if blenders:
                    break
                time.sleep(0.01)
            os.kill(blenders[0], signal.SIGKILL)
            error = program.communicate()[1]
        self.assertEqual(program.returncode, 2)
        self.assertIn("killed by signal 9", error)


if __name__ == "__main__":
    unittest.main()
