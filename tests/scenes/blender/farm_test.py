"""A shot that is sent to a service with two workers ends as the same shot rendered here: the same bytes."""

import pathlib
import subprocess
import tempfile
import time
import unittest
import unittest.mock

import bpy

from blender import farm, program
from blender.export.shot import export_shot
from engine_scene import EngineTest

BEGINS_WITHIN = 20  # seconds
ENDS_WITHIN = 60


class Farm(EngineTest):

    def setUp(self):
        super().setUp()
        # Sockets have short names only.
        short = tempfile.TemporaryDirectory(dir="/tmp", prefix="pf")
        self.addCleanup(short.cleanup)
        socket = pathlib.Path(short.name) / "s"
        self.scene.penumbra.farm_address = f"unix:{socket}"
        self.scene.penumbra.farm_name = "my shot"
        self.service = subprocess.Popen(
            [program.find_program(), "serve", "--listen", f"unix:{socket}", "--workers", "2", "--threads", "1",
             "--spool", self.folder / "spool"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(self.end_service)
        self.assertTrue(program.wait_until(socket.exists, BEGINS_WITHIN))
        self.scene.frame_start, self.scene.frame_end = 3, 4
        self.cube.keyframe_insert("location", frame=3)
        self.cube.location.x = 1
        self.cube.keyframe_insert("location", frame=4)
        self.scene.frame_set(1)
        self.scene.render.filepath = str(self.folder / "fetched/")
        (self.folder / "fetched").mkdir()
        self.farm = bpy.context.window_manager.penumbra_farm

    def end_service(self):
        self.service.terminate()
        self.service.wait()

    def wait_for(self, state):
        def is_there():
            bpy.ops.penumbra.farm_refresh()
            return self.farm.shots[0].state == state
        self.assertTrue(program.wait_until(is_there, ENDS_WITHIN, 0.3), self.farm.shots[0].state)

    def test_a_shot_of_two_frames(self):
        self.scene.view_layers[0].use_pass_z = True
        self.scene.view_layers[0].use_pass_position = True
        self.scene.penumbra.farm_priority = 4
        self.assertEqual(bpy.ops.penumbra.send_to_farm(), {"FINISHED"})
        self.assertEqual(self.scene.frame_current, 1, "the scene is where it was")
        self.assertEqual(len(self.farm.shots), 1)
        shot = self.farm.shots[0]
        self.assertIn("my_shot", shot.name)
        self.assertEqual(shot.priority, 4)
        self.wait_for("done")
        self.assertEqual(self.farm.shots[0].done, 1)
        self.assertEqual(bpy.ops.penumbra.farm_fetch(), {"FINISHED"})
        # The same shot in a folder of its own, by `penumbra render`.
        here = self.folder / "here"
        here.mkdir()
        paths, _ = export_shot(here, self.scene, [3, 4], self.scene.view_layers[0].name)
        for path, frame in zip(paths, (3, 4)):
            path.rename(here / f"my_shot.{frame:04d}.xml")
        program.run(["render", here / "my_shot.####.xml", "--frames", "3-4", "--quiet", "-o",
                     self.folder / "my_shot.####.exr", *farm.shot_options(self.scene, self.scene.view_layers[0])])
        images = []
        for frame in (3, 4):
            name = f"my_shot.{frame:04d}.exr"
            fetched = (self.folder / "fetched" / name).read_bytes()
            self.assertEqual(fetched, (self.folder / name).read_bytes())
            images.append(fetched)
        self.assertNotEqual(*images)
        self.assertIn(b"position.X", images[0])

    def test_a_cancelled_shot(self):
        self.scene.penumbra.samples = 1 << 20
        self.assertEqual(bpy.ops.penumbra.send_to_farm(animation=False), {"FINISHED"})
        self.assertEqual(bpy.ops.penumbra.farm_cancel(), {"FINISHED"})
        self.wait_for("cancelled")

    def test_a_farm_that_is_not_there(self):
        self.scene.penumbra.farm_address = f"unix:{self.folder}/none"
        began = time.monotonic()
        with self.assertRaisesRegex(RuntimeError, "none"):
            bpy.ops.penumbra.send_to_farm(animation=False)
        self.assertLess(time.monotonic() - began, farm.ANSWER_TIME + 10)


class Lists(unittest.TestCase):

    def test_frames(self):
        self.assertEqual(farm.frames_text([1, 2, 3]), "1-3")
        self.assertEqual(farm.frames_text([1, 3, 5]), "1-5x2")
        self.assertEqual(farm.frames_text([7]), "7")
        self.assertEqual(farm.frames_text([1, 2, 9]), "1,2,9")

    def test_shots_are_the_users_own(self):
        def group(number, submitter):
            return {"group": number, "name": "shot", "state": "rendering", "submitter": submitter, "done": 0.5,
                    "priority": 1, "jobs": {"done": 1, "queued": 1, "failed": 0}}

        def job(number, submitter, of_group):
            return {"job": number, "name": "still", "state": "failed", "submitter": submitter, "samples_done": 1,
                    "samples_total": 4, "priority": 0, "error": "why", "group": of_group}
        shots = farm.shots_of({"groups": [group(2, "me@here"), group(5, "you@there")],
                               "jobs": [job(3, "me@here", 2), job(9, "me@here", None), job(8, "you@there", None)]},
                              "me@here")
        self.assertEqual([shot["number"] for shot in shots], [9, 2])
        self.assertEqual(shots[0]["done"], 0.25)
        self.assertEqual(shots[1]["text"], "1 done, 1 queued")


if __name__ == "__main__":
    unittest.main()
