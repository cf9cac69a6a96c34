"""The render engine: pictures and passes are those of `penumbra`; whatever fails is told, and Blender lives."""

import errno
import os
import pathlib
import resource
import subprocess
import sys
import time
import unittest
import unittest.mock

import bpy
import numpy

import blender
from blender import engine, exr, passes, program
from blender.properties import Settings, settings_of
from engine_scene import HEIGHT, WIDTH, EngineTest, is_same, pass_of

STOPS_WITHIN = 1.0  # seconds from Esc to the end of the render, as users are promised
ENDLESS = 1 << 20  # samples that no test waits for


def read_images():
    """Records the EXR files that the engine reads: a patch whose mock has `images`."""
    real, images = exr.read, []

    def read(path):
        images.append(real(path))
        return images[-1]
    return unittest.mock.patch.object(engine.exr, "read", read), images


class Pictures(EngineTest):

    def test_the_combined_pass_is_the_file_of_penumbra(self):
        patch, images = read_images()
        with patch:
            picture = self.combined(self.render())
        self.assertEqual(picture.shape, (HEIGHT, WIDTH, 4))
        self.assertEqual(len(images), 1)
        self.assertTrue(is_same(picture[..., :3], images[0].stack("RGB")))
        self.assertTrue((picture[..., 3] == 1).all())
        self.assertGreater(picture[..., :3].std(), 0.01)
        self.assertEqual(images[0].channels["samples.Y"].max(), 4)

    def test_passes_are_the_layers_of_the_file(self):
        layer = self.scene.view_layers[0]
        for name in ("z", "position", "normal", "vector", "uv", "cryptomatte_object", "cryptomatte_material"):
            setattr(layer, f"use_pass_{name}", True)
        for name in ("light", "albedo", "variance", "samples"):
            setattr(layer.penumbra, f"use_pass_{name}", True)
        patch, images = read_images()
        with patch:
            picture = self.render()
        file = images[0]
        for name, channels, source in (
                ("Position", "XYZ", "position.X position.Y position.Z"),
                ("Normal", "XYZ", "normal.X normal.Y normal.Z"),
                ("Direct", "RGB", "direct.R direct.G direct.B"),
                ("Indirect", "RGB", "indirect.R indirect.G indirect.B"),
                ("Denoising Albedo", "RGB", "albedo.R albedo.G albedo.B"),
                ("Variance", "RGB", "variance.R variance.G variance.B"), ("Debug Sample Count", "X", "samples.Y"),
                ("CryptoObject00", "RGBA", "CryptoObject00.R CryptoObject00.G CryptoObject00.B CryptoObject00.A"),
                ("CryptoMaterial02", "RGBA", " ".join(f"CryptoMaterial02.{c}" for c in "RGBA"))):
            with self.subTest(name):
                self.assertTrue(is_same(pass_of(picture, name, channels), file.stack(source.split())))
        direct, indirect = pass_of(picture, "Direct", "RGB"), pass_of(picture, "Indirect", "RGB")
        numpy.testing.assert_allclose(direct + indirect, self.combined(picture)[..., :3], rtol=1e-4, atol=1e-6)
        self.assertTrue(is_same(pass_of(picture, "UV", "UVA")[..., :2], file.stack(["uv.U", "uv.V"])))
        depth = pass_of(picture, "Depth", "Z")[..., 0]
        is_hit = file.channels["depth.Z"] > 0
        self.assertTrue(is_hit.any() and not is_hit.all())
        self.assertTrue((depth[~is_hit] == passes.NOTHING_DEPTH).all())
        self.assertTrue(is_same(depth[is_hit], file.channels["depth.Z"][is_hit]))
        vector = pass_of(picture, "Vector", "XYZW")
        self.assertTrue(is_same(vector, file.stack([f"motion.{c}" for c in "XYZW"]) * numpy.float32([1, -1, -1, 1])))

    def test_names_of_cryptomatte_are_in_the_file(self):
        layer = self.scene.view_layers[0]
        layer.use_pass_cryptomatte_object = True
        picture = self.render()
        key = f"cryptomatte/{passes.name_hash('ViewLayer.CryptoObject') >> 4:07x}"
        self.assertEqual(picture.metadata[f"{key}/name"], "ViewLayer.CryptoObject")
        self.assertEqual(picture.metadata[f"{key}/hash"], "MurmurHash3_32")
        self.assertIn("{", picture.metadata[f"{key}/manifest"])

    def test_a_region_is_a_part_of_the_whole(self):
        whole = self.combined(self.render())
        render = self.scene.render
        render.use_border = render.use_crop_to_border = True
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.0, 0.5
        part = self.combined(self.render("part"))
        rows, columns = slice(HEIGHT // 2, HEIGHT), slice(WIDTH // 4, WIDTH * 3 // 4)
        self.assertTrue(is_same(part, whole[rows, columns]))
        render.use_crop_to_border = False
        placed = self.combined(self.render("placed"))
        self.assertEqual(placed.shape, whole.shape)
        self.assertTrue(is_same(placed[rows, columns], whole[rows, columns]))
        self.assertEqual(placed[:HEIGHT // 2].max(), 0)

    def test_the_percentage_scales_the_film(self):
        self.scene.render.resolution_percentage = 50
        self.assertEqual(self.combined(self.render()).shape, (HEIGHT // 2, WIDTH // 2, 4))

    def test_each_view_layer_is_rendered(self):
        hidden = bpy.data.collections.new("Hidden")
        self.scene.collection.children.link(hidden)
        self.scene.collection.objects.unlink(self.cube)
        hidden.objects.link(self.cube)
        second = self.scene.view_layers.new("Without")
        second.layer_collection.children["Hidden"].exclude = True
        second.use_pass_z = True
        picture = self.render()
        difference = self.combined(picture) - self.combined(picture, "Without")
        self.assertGreater(abs(difference).max(), 0.05)
        self.assertGreater(pass_of(picture, "Depth", "Z", "Without").min(), 1)
        self.assertNotIn("ViewLayer.Depth.Z", picture.channels)

    def test_a_transparent_film_has_alpha(self):
        self.scene.render.film_transparent = True
        alpha = self.combined(self.render())[..., 3]
        self.assertEqual((alpha.min(), alpha.max()), (0, 1))

    def test_a_denoised_render_keeps_the_noisy_one(self):
        self.scene.penumbra.denoise = "nfor"
        patch, images = read_images()
        with patch:
            picture = self.render()
        self.assertEqual(len(images), 2)
        noisy = pass_of(picture, "Noisy Image", "RGBA")
        self.assertTrue(is_same(noisy[..., :3], images[0].stack("RGB")))
        self.assertFalse(is_same(noisy, self.combined(picture)))

    def test_pictures_of_materials_are_small_renders(self):
        self.scene.penumbra.denoise = "nfor"
        patch, images = read_images()
        with patch, unittest.mock.patch.object(engine.LayerRender, "is_preview", True):
            picture = self.render()
        self.assertEqual(len(images), 1)
        self.assertEqual(images[0].channels["samples.Y"].max(), engine.PREVIEW_SAMPLES)
        self.assertTrue(is_same(self.combined(picture)[..., :3], images[0].stack("RGB")))

    def test_an_animation_has_other_frames_and_shares_what_stays(self):
        scene = self.scene
        scene.frame_start, scene.frame_end = 1, 2
        self.cube.keyframe_insert("location", frame=1)
        self.cube.location.x = 1
        self.cube.keyframe_insert("location", frame=2)
        written, folders = [], set()
        real = engine.export_scene

        def export(*arguments):
            path = real(*arguments)
            folders.add(path.parent)
            written.append({file.name for file in path.parent.rglob("*.ply")})
            return path
        scene.render.image_settings.file_format = "PNG"
        scene.render.filepath = str(self.folder / "shot.")
        with unittest.mock.patch.object(engine, "export_scene", export):
            bpy.ops.render.render(animation=True)
        frames = [(self.folder / f"shot.{frame:04d}.png").read_bytes() for frame in (1, 2)]
        self.assertNotEqual(*frames)
        self.assertEqual(len(written), 2)
        self.assertEqual(written[0], written[1], "a moved object's mesh is the same file")
        self.assertEqual(len(folders), 1)
        self.assertFalse(folders.pop().exists(), "nothing is left behind")

    def test_seeds_change_noise_and_can_follow_frames(self):
        first = self.combined(self.render())
        self.assertTrue(is_same(first, self.combined(self.render())))
        self.scene.penumbra.animate_seed = True
        self.scene.frame_current = 7
        self.assertEqual(settings_of(self.scene).seed, 7)
        self.assertFalse(is_same(first, self.combined(self.render())))


class Progress(EngineTest):

    def test_it_has_the_time_left(self):
        told = unittest.mock.Mock()
        render = object.__new__(engine.LayerRender)
        render.engine, render.settings = told, Settings()
        line = {"samples_done": 30, "samples_total": 120, "seconds_left": 3675.4, "relative_error": 0.0123, "workers": 2}
        render.show_progress(line, 5)
        told.update_stats.assert_called_with("", "Remaining 01:01:15 | 25 % | Error 1.2 %")
        told.update_progress.assert_called_with(0.25)
        render.settings = Settings(time_budget=10)
        render.show_progress({**line, "seconds_left": None, "relative_error": None}, 5)
        told.update_stats.assert_called_with("", "Remaining 00:00:05 | 50 %")
        told.update_progress.assert_called_with(0.5)


class Ends(EngineTest):

    def test_esc_keeps_what_is_there_within_a_second(self):
        self.scene.penumbra.samples = ENDLESS
        broke_at = []

        def is_stopped(_):
            if time.monotonic() < began + 3:
                return False
            broke_at.append(time.monotonic())
            return True
        began = time.monotonic()
        with unittest.mock.patch.object(engine.LayerRender, "is_stopped", is_stopped):
            picture = self.combined(self.render())
        self.assertLess(time.monotonic() - broke_at[0], STOPS_WITHIN + 0.5, "half a second to write Blender's file")
        self.assertGreater(picture[..., :3].min(), 0, "every pixel has samples")

    def test_esc_ends_a_renderer_that_does_not_listen(self):
        self.scene.penumbra.samples = ENDLESS
        began = time.monotonic()
        with unittest.mock.patch.object(engine.LayerRender, "is_stopped",
                                        lambda _: time.monotonic() > began + 2), \
                unittest.mock.patch.object(program.signal, "SIGINT", program.signal.SIGCONT):  # which does nothing
            picture = self.combined(self.render())
        self.assertLess(time.monotonic() - began, 2 + STOPS_WITHIN + 0.5)
        self.assertGreater(picture[..., :3].max(), 0, "its tiles are there")

    def test_esc_ends_an_export(self):
        looked = []

        def is_stopped(_):
            looked.append(time.monotonic())
            return True
        with unittest.mock.patch.object(engine.LayerRender, "is_stopped", is_stopped), \
                unittest.mock.patch.object(engine, "Process") as process:
            self.render()
        self.assertEqual(len(looked), 1, "of the scene's objects none after the first is looked at")
        process.assert_not_called()

    def test_a_time_budget_ends_a_render_without_an_error(self):
        self.scene.penumbra.samples = ENDLESS
        self.scene.penumbra.time_budget = 0.5
        self.assertGreater(self.combined(self.render())[..., :3].min(), 0)

    def fails(self, text):
        """A render that must fail with this text, as an error for the user; and the next one works."""
        with self.assertRaisesRegex(RuntimeError, text):
            self.render()

    def test_a_killed_renderer(self):
        self.scene.penumbra.samples = ENDLESS
        real = program.Process.wait
        began = time.monotonic()

        def wait(process, seconds):
            if time.monotonic() > began + 2:
                process.kill()
            return real(process, seconds)
        with unittest.mock.patch.object(program.Process, "wait", wait):
            self.fails("killed")
        self.scene.penumbra.samples = 1
        self.assertGreater(self.combined(self.render())[..., :3].max(), 0, "Blender lives, and renders again")

    def test_a_missing_program(self):
        with unittest.mock.patch.dict(os.environ, PENUMBRA=str(self.folder / "none")):
            self.fails("There is no program .*none. It is what the environment variable PENUMBRA says")
        with unittest.mock.patch.dict(os.environ, PENUMBRA="", PATH=str(self.folder)), \
                unittest.mock.patch.object(program, "USUAL_FOLDERS", []), \
                unittest.mock.patch.object(program, "ANCESTORS", -1):
            self.fails("Install Penumbra, and choose the program in the preferences")

    def test_an_animation_ends_at_its_first_failure(self):
        self.scene.frame_start, self.scene.frame_end = 1, 3
        self.scene.render.filepath = str(self.folder / "shot.")
        began = []
        real = engine.LayerRender.run
        with unittest.mock.patch.object(engine.LayerRender, "run", lambda render: (began.append(1), real(render))), \
                unittest.mock.patch.dict(os.environ, PENUMBRA=str(self.folder / "none")):
            with self.assertRaisesRegex(RuntimeError, "There is no program"):
                bpy.ops.render.render(animation=True)
        self.assertEqual(len(began), 1)

    def test_a_program_that_is_another(self):
        other = self.folder / "penumbra"
        other.write_text("#!/bin/sh\necho error: not this one >&2\nexit 3\n")
        other.chmod(0o755)
        with unittest.mock.patch.dict(os.environ, PENUMBRA=str(other)):
            self.fails("not this one")
        with self.assertRaisesRegex(program.ProgramError, "is not a Penumbra that runs here"):
            program.version_of(other)
        self.assertRegex(program.version_of(program.find_program()), r"^\d+\.\d+")

    def test_a_full_disk(self):
        bpy.context.view_layer.objects.active = self.cube
        subdivision = self.cube.modifiers.new("Subdivision", "SUBSURF")
        subdivision.render_levels = subdivision.levels = 4
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, limits[1]))
        try:
            self.fails("Free some space, or choose another folder")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        self.assertEqual(errno.EFBIG, 27)

    def test_a_scene_without_a_camera(self):
        bpy.data.objects.remove(self.scene.camera)
        with self.assertRaisesRegex(RuntimeError, "(?i)camera"):
            self.render()

    def test_an_error_of_the_extension_is_told(self):
        with unittest.mock.patch.object(engine, "export_scene", side_effect=KeyError("odd")):
            self.fails("odd")

    def test_python_ends_with_an_error(self):
        code = ("import bpy, blender; blender.register(); bpy.context.scene.render.engine = 'PENUMBRA'; "
                "bpy.ops.render.render()")
        paths = os.pathsep.join([str(pathlib.Path(blender.__file__).parents[1])])
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100, check=False,
                             env={**os.environ, "PYTHONPATH": paths, "PENUMBRA": str(self.folder)})
        self.assertNotEqual(ran.returncode, 0)
        self.assertIn("There is no program", ran.stderr + ran.stdout)


class Registration(unittest.TestCase):

    def test_nothing_is_left_behind(self):
        def known():
            return {cls.__name__ for base in (bpy.types.Panel, bpy.types.Operator, bpy.types.PropertyGroup,
                                              bpy.types.RenderEngine, bpy.types.UIList)
                    for cls in base.__subclasses__() if getattr(cls, "is_registered", False)}
        before = known()
        handlers = len(bpy.app.handlers.render_complete)
        for _ in range(2):
            blender.register()
            self.assertIn("PenumbraRenderEngine", known() - before)
            blender.unregister()
            self.assertEqual(known(), before)
        self.assertEqual(len(bpy.app.handlers.render_complete), handlers)
        self.assertFalse(hasattr(bpy.types.Scene, "penumbra"))

    def test_panels_of_cycles_are_not_shown(self):
        blender.register()
        try:
            shown = [cls.__name__ for cls in bpy.types.Panel.__subclasses__()
                     if "PENUMBRA" in getattr(cls, "COMPAT_ENGINES", ())]
            self.assertIn("EEVEE_MATERIAL_PT_surface", shown)
            self.assertIn("RENDER_PT_format", shown)
            self.assertIn("PENUMBRA_RENDER_PT_sampling", shown)
            self.assertEqual([name for name in shown if name.startswith("CYCLES")], [])
        finally:
            blender.unregister()
        shown = [cls.__name__ for cls in bpy.types.Panel.__subclasses__()
                 if "PENUMBRA" in getattr(cls, "COMPAT_ENGINES", ())]
        self.assertEqual([name for name in shown if not name.startswith("PENUMBRA")], [])


class StoredSettings(EngineTest):

    def test_a_file_keeps_them_without_the_extension(self):
        settings = self.scene.penumbra
        settings.samples, settings.max_bounces, settings.integrator, settings.texture_size = 77, 3, "sppm", "2048"
        settings.use_target_error, settings.denoise = True, "nfor"
        expected = settings_of(self.scene)
        self.assertEqual((expected.samples, expected.max_depth, expected.integrator), (77, 5, "sppm"))
        path = str(self.folder / "stored.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        blender.unregister()
        try:
            bpy.ops.wm.open_mainfile(filepath=path)
            self.assertEqual(settings_of(bpy.context.scene), expected)
        finally:
            blender.register()

    def test_without_any_they_are_those_of_cycles(self):
        blender.unregister()
        try:
            bpy.ops.wm.read_factory_settings(use_empty=True)
            scene = bpy.context.scene
            scene.cycles.samples, scene.cycles.max_bounces = 33, 5
            self.assertEqual((settings_of(scene).samples, settings_of(scene).max_depth), (33, 7))
        finally:
            blender.register()


if __name__ == "__main__":
    unittest.main()
