"""Scenes as users make them have the mean of Cycles' pictures, and look the same to an observer (FLIP)."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

import numpy

from cycles_comparison import compare, empty_scene, program
from realistic_scenes import REALISTIC_SCENES, SAMPLES
from blender.export.exr_writer import exr_bytes

MEANS_AGREE = 0.02  # relative, per channel
CONVERGED = 0.005  # relative standard error of a channel's mean
FLIP = 0.05  # of the pictures in sRGB, clamped to what a screen shows (LDR-FLIP)
# PENUMBRA_PICTURES names a folder that keeps both pictures of each scene.


def flip(ours, theirs, folder):
    """LDR-FLIP of two linear pictures (height, width, 3), by the penumbra program."""
    paths = [os.path.join(folder, name) for name in ("penumbra.exr", "cycles.exr")]
    for path, image in zip(paths, (ours, theirs)):
        pathlib.Path(path).write_bytes(exr_bytes(image.astype(numpy.float32)))
    done = subprocess.run([program(), "compare", *paths, "--ldr", "--flip", "ldr", "--json"], stdout=subprocess.PIPE,
                          text=True, check=True)
    return json.loads(done.stdout)["flip"]["mean"]
