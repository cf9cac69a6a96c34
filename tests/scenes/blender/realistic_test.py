"""Scenes as users make them have the mean of Cycles' pictures, and look the same to an observer (FLIP).

PENUMBRA_PICTURES names a folder that keeps both pictures of each scene, as EXR files.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

from cycles_comparison import compare, empty_scene, program
from realistic_scenes import REALISTIC_SCENES, SAMPLES
from blender.export.exr_writer import exr_bytes

WIDTH, HEIGHT, BATCHES = 128, 96, 4
MEANS_AGREE = 0.02  # relative, per channel
CONVERGED = 0.005  # relative standard error of the difference of the means
FLIP = 0.05  # LDR-FLIP: of the pictures as a screen shows them, in sRGB and clamped


def flip(ours, theirs, folder):
    """LDR-FLIP of two linear pictures (height, width, 3), by the penumbra program."""
    paths = [os.path.join(folder, name) for name in ("penumbra.exr", "cycles.exr")]
    for path, image in zip(paths, (ours, theirs)):
        pathlib.Path(path).write_bytes(exr_bytes(image.astype(numpy.float32)))
    done = subprocess.run([program(), "compare", *paths, "--ldr", "--flip", "ldr", "--json"], stdout=subprocess.PIPE,
                          text=True, check=True)
    return json.loads(done.stdout)["flip"]["mean"]


class RealisticScenes(unittest.TestCase):
    """Has one test for each scene."""


def _test_of(name):
    def test(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = empty_scene(WIDTH, HEIGHT)
            REALISTIC_SCENES[name](scene, folder)
            found = compare(scene, *SAMPLES[name], batches=BATCHES)
        theirs, ours = found.cycles, found.penumbra
        kept = os.environ.get("PENUMBRA_PICTURES")
        with tempfile.TemporaryDirectory() as temporary:
            folder = os.path.join(kept, name) if kept else temporary
            os.makedirs(folder, exist_ok=True)
            seen = flip(ours.image, theirs.image, folder)
        mean, scale = theirs.image.mean(axis=(0, 1)), theirs.image.mean()
        ratios = ours.image.mean(axis=(0, 1)) / mean
        errors = numpy.hypot(ours.error, theirs.error) / mean
        print(f"{name} | mean / Cycles' {ours.image.mean() / scale:.4f} | FLIP {seen:.3f} | noise of a pixel "
              f"{theirs.pixel_error / scale:.3f} in Cycles, {ours.pixel_error / scale:.3f} here | seconds "
              f"{theirs.seconds:.0f} in Cycles, {ours.seconds:.0f} here | samples {SAMPLES[name]}", flush=True)
        self.assertEqual(found.report.lines, [])
        self.assertLess(errors.max(), CONVERGED)
        self.assertLess(abs(ratios - 1).max(), MEANS_AGREE, f"means per channel over Cycles': {ratios}")
        self.assertLess(seen, FLIP)
    return test


for _name in REALISTIC_SCENES:
    setattr(RealisticScenes, f"test_{_name}", _test_of(_name))

if __name__ == "__main__":
    if program() is None:
        print("skipped: neither PENUMBRA_PROGRAM nor PATH has the penumbra program")
        sys.exit(77)
    unittest.main()
