"""Scenes of one feature each have the mean of Cycles' picture of them, and look as it does."""

import sys
import unittest

import numpy

from cycles_comparison import compare, empty_scene, program
from unit_scenes import UNIT_SCENES

MEANS_AGREE = 0.01  # relative, beyond four standard errors
# Mean absolute difference of pixels over the mean, beyond that of noise. A picture that is shifted by a pixel or
# mirrored has 0.1 or more in these scenes.
PICTURES_AGREE = 0.03


class UnitScenes(unittest.TestCase):
    """Has one test for each unit scene."""


def _test_of(name):
    def test(self):
        scene = empty_scene(width=32, height=24)
        why_not = UNIT_SCENES[name](scene)
        if why_not:
            self.skipTest(why_not)
        found = compare(scene, spp=128, batches=4)
        theirs, ours = found.cycles, found.penumbra
        mean, scale = theirs.image.mean(axis=(0, 1)), theirs.image.mean()
        ratio = ours.image.mean() / scale
        difference = numpy.abs(ours.image - theirs.image).mean() / scale
        noise = (ours.pixel_error + theirs.pixel_error) / scale
        print(f"{name}: mean / Cycles' = {ratio:.4f}, difference {difference:.4f}, of noise {noise:.4f}",
              *found.report.lines)
        errors = 4 * numpy.hypot(ours.error, theirs.error)
        self.assertTrue((numpy.abs(ours.image.mean(axis=(0, 1)) - mean) <= MEANS_AGREE * mean + errors).all(),
                        f"{ours.image.mean(axis=(0, 1))} instead of {mean}, with errors of {errors}")
        self.assertLessEqual(difference, PICTURES_AGREE + noise)
    return test


for _name in UNIT_SCENES:
    setattr(UnitScenes, f"test_{_name}", _test_of(_name))

if __name__ == "__main__":
    if program() is None:
        print("skipped: neither PENUMBRA_PROGRAM nor PATH has the penumbra program")
        sys.exit(77)
    unittest.main()
