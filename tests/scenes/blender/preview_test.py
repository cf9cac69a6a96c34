"""The viewport without a window: a made-up region and engine. Drawing itself needs a display, and is not tested."""

import time
import types
import unittest
import unittest.mock

import bpy
import mathutils
import numpy

from blender import preview, program
from cycles_comparison import cycles_image
from engine_scene import HEIGHT, WIDTH, EngineTest

ENDS_WITHIN = 60  # seconds


class Engine:
    """What the viewport tells Blender."""

    def __init__(self):
        self.reports, self.stats, self.redraws = [], [], 0

    def update_stats(self, *texts):
        self.stats.append(texts)

    def report(self, kind, text):
        self.reports.append((kind, text))

    def tag_redraw(self):
        self.redraws += 1


class Preview(EngineTest):

    def setUp(self):
        super().setUp()
        self.scene.penumbra.preview_samples = self.scene.penumbra.samples
        self.engine = Engine()
        self.viewport = preview.Viewport(self.engine)
        self.addCleanup(self.viewport.close)

    def context(self, depsgraph):
        """As of a viewport that looks through the camera."""
        camera = self.scene.camera
        region_3d = types.SimpleNamespace(view_matrix=camera.matrix_world.normalized().inverted(),
                                          window_matrix=camera.calc_matrix_camera(depsgraph, x=WIDTH, y=HEIGHT))
        return types.SimpleNamespace(region=types.SimpleNamespace(width=WIDTH, height=HEIGHT), region_data=region_3d,
                                     scene=self.scene)

    def update(self):
        """Blender tells what has changed while it tells that something has; so this is done by a handler."""
        updated = []

        def take(_, depsgraph):
            updated.append(True)
            self.viewport.update(self.context(depsgraph), depsgraph)
        self.scene.camera.update_tag()
        bpy.app.handlers.depsgraph_update_post.append(take)
        try:
            bpy.context.view_layer.update()
        finally:
            bpy.app.handlers.depsgraph_update_post.remove(take)
        self.assertEqual(updated, [True])

    def look(self):
        context = self.context(bpy.context.evaluated_depsgraph_get())
        self.viewport.look(preview.View.of(context.region, context.region_data))

    def finish(self):
        """The pictures that show until nothing more comes; the last one is done."""
        pictures = []
        end = time.monotonic() + ENDS_WITHIN
        while self.viewport.poll():
            self.assertLess(time.monotonic(), end)
            if self.viewport.picture is not None and (not pictures or pictures[-1] is not self.viewport.picture):
                pictures.append(self.viewport.picture)
            time.sleep(0.02)
        return [*pictures, self.viewport.picture]

    def test_it_is_coarse_and_then_the_render(self):
        self.update()
        pictures = self.finish()
        self.assertEqual(pictures[0].shape, (HEIGHT // preview.COARSE_SCALE, WIDTH // preview.COARSE_SCALE, 4))
        self.assertEqual(pictures[-1].shape, (HEIGHT, WIDTH, 4))
        self.assertGreater(self.engine.redraws, 1)
        rendered = self.combined(self.render())[..., :3]
        # The same samples in the same pixels; passes of one sample add up in another order.
        numpy.testing.assert_allclose(pictures[-1][..., :3], rendered, rtol=1e-4, atol=1e-5)

    def test_cameras_see_what_those_of_cycles_see(self):
        self.scene.penumbra.preview_samples = 256
        camera = self.scene.camera.data
        for name, values in (("shift", {"shift_x": 0.2, "shift_y": -0.1}),
                             ("orthographic", {"type": "ORTHO", "ortho_scale": 7}),
                             ("vertical", {"type": "PERSP", "sensor_fit": "VERTICAL", "shift_x": 0})):
            for key, value in values.items():
                setattr(camera, key, value)
            self.update()
            picture = self.finish()[-1][..., :3]
            self.scene.render.engine = "CYCLES"
            self.scene.cycles.samples = 256
            cycles = cycles_image(self.scene)
            self.scene.render.engine = "PENUMBRA"
            error = abs(picture - cycles).mean() / cycles.mean()
            moved = abs(numpy.roll(picture, 1, axis=1) - cycles).mean() / cycles.mean()
            with self.subTest(name):
                # Noise, and another filter at edges; a picture that is off by a pixel differs more.
                self.assertLess(error, 0.5 * moved)

    def test_moving_exports_nothing(self):
        self.update()
        self.finish()
        with unittest.mock.patch.object(preview, "export_scene", side_effect=AssertionError):
            self.scene.camera.location.x += 2
            self.look()
            moved = self.finish()[-1]
        self.assertEqual(self.engine.reports, [])
        rendered = self.combined(self.render())[..., :3]
        numpy.testing.assert_allclose(moved[..., :3], rendered, rtol=1e-4, atol=1e-5)

    def test_a_change_writes_only_what_changes(self):
        self.update()
        self.finish()
        files = {path: path.stat().st_mtime_ns for path in self.viewport._folder.rglob("*.ply")}
        self.assertEqual(len(files), 2)
        self.cube.location = mathutils.Vector((0, 0, 1))
        self.update()
        self.finish()
        self.assertEqual({path: path.stat().st_mtime_ns for path in self.viewport._folder.rglob("*.ply")}, files)
        self.cube.data.vertices[0].co.x -= 1
        self.cube.data.update()
        self.update()
        self.finish()
        self.assertEqual(len(list(self.viewport._folder.rglob("*.ply"))), 3)

    def test_while_it_turns_coarse_pictures_show(self):
        self.scene.penumbra.preview_samples = 1 << 16  # more than this test waits for
        self.update()
        seen = []
        end = time.monotonic() + 6
        while time.monotonic() < end:
            self.scene.camera.location.x += 0.01
            self.look()
            if self.viewport.picture is not None and not any(self.viewport.picture is one for one in seen):
                seen.append(self.viewport.picture)
            time.sleep(0.05)
        self.assertGreater(len(seen), 2)
        self.assertTrue(all(picture.shape[0] < HEIGHT for picture in seen))

    def test_a_missing_program_is_told(self):
        with unittest.mock.patch.object(program, "find_program", side_effect=program.ProgramError("not there")):
            self.update()
            self.finish()
        self.assertEqual(self.viewport.problem, "not there")
        self.look()
        self.assertIsNone(self.viewport.picture)
        self.update()
        self.assertIsNotNone(self.finish()[-1], "it goes on once the program is there")

    def test_closing_ends_the_renderer_and_leaves_no_file(self):
        self.scene.penumbra.preview_samples = 1 << 20
        self.update()
        end = time.monotonic() + ENDS_WITHIN
        while self.viewport.picture is None or self.viewport.picture.shape[0] < HEIGHT:
            self.assertLess(time.monotonic(), end)
            self.viewport.poll()
            time.sleep(0.02)
        process, folder = self.viewport._stage.process, self.viewport._folder
        self.viewport.close()
        self.assertIsNotNone(process.code())
        self.assertFalse(folder.exists())


if __name__ == "__main__":
    unittest.main()
