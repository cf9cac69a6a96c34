"""The extension is what Blender's own checks accept: those of `blender --command extension validate`, which a Python that
has bpy has as a program alone."""

import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest
import zipfile

import bpy

EXTENSION = pathlib.Path(__file__).resolve().parents[3] / "scenes" / "blender"
CHECKS = pathlib.Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"


def validate(path):
    return subprocess.run([sys.executable, CHECKS, "validate", path], capture_output=True, text=True)


class Manifest(unittest.TestCase):
    def test_blender_finds_the_extension_valid(self):
        for path in (EXTENSION, os.environ["PENUMBRA_BLENDER_EXTENSION"]):
            done = validate(path)
            self.assertEqual(done.returncode, 0, f"{path}: {done.stdout}{done.stderr}")

    def test_the_checks_find_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            text = (EXTENSION / "blender_manifest.toml").read_text()
            (pathlib.Path(folder) / "blender_manifest.toml").write_text(text.replace('"add-on"', '"addition"'))
            (pathlib.Path(folder) / "__init__.py").touch()
            self.assertNotEqual(validate(folder).returncode, 0)

    def test_the_zip_holds_every_module_and_nothing_else(self):
        with zipfile.ZipFile(os.environ["PENUMBRA_BLENDER_EXTENSION"]) as archive:
            names = set(archive.namelist())
        modules = {str(path.relative_to(EXTENSION)) for path in EXTENSION.rglob("*.py")}
        self.assertEqual(names, modules | {"blender_manifest.toml"})

    def test_it_needs_the_oldest_blender_that_the_command_line_takes(self):
        from blender import command_line
        manifest = tomllib.loads((EXTENSION / "blender_manifest.toml").read_text())
        self.assertEqual(manifest["blender_version_min"], "{}.{}.{}".format(*command_line.OLDEST))


if __name__ == "__main__":
    unittest.main()
