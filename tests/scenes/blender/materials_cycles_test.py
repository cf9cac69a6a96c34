"""Materials against Cycles: scenes of one material each."""

import pathlib
import sys
import tempfile
import unittest

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from cycles_comparison import cycles_image, empty_scene, penumbra_image, program  # noqa: E402
from material_scenes import MATERIALS, fill  # noqa: E402

SPP, SEEDS = 48, 4
TOLERANCE = 0.01  # of the mean, for differences of models
# Blender 4.2 shades bumps by another formula (Chiang et al. 2019) than 4.5 and we (Estevez et al. 2019).
TOLERANCE_OF_OTHER_BUMPS = 0.02
BUMPS = {"normal map", "bump", "bump of noise", "displacement of noise"}
ERRORS = 4.0  # standard errors besides; of some 250 comparisons with fixed seeds one would be beyond by chance


class MaterialsAsInCycles(unittest.TestCase):

    def test_means(self):
        """The means of the image and, within twice the tolerance, of the middle of the sphere, per channel."""
        for name, make in MATERIALS.items():
            with self.subTest(name):
                other_bumps = name in BUMPS and bpy.app.version < (4, 5)
                self.check(make, TOLERANCE_OF_OTHER_BUMPS if other_bumps else TOLERANCE)

    def check(self, make, tolerance):
        scene = empty_scene(48, 36, SPP)
        fill(scene, make())
        with tempfile.TemporaryDirectory() as folder:
            pairs = [(cycles_image(scene, seed), penumbra_image(scene, SPP, seed, folder)) for seed in range(SEEDS)]
        cycles = numpy.array([theirs for theirs, _ in pairs], dtype=float)
        ours = numpy.array([image for _, (image, _) in pairs], dtype=float)
        self.assertEqual(pairs[0][1][1].lines, [])
        for rows, columns, share in ((slice(None), slice(None), 1), (slice(8, 30), slice(14, 34), 2)):
            theirs_mean, our_mean = cycles[:, rows, columns].mean((1, 2)), ours[:, rows, columns].mean((1, 2))
            mean = theirs_mean.mean(axis=0)
            error = numpy.hypot(theirs_mean.std(axis=0, ddof=1), our_mean.std(axis=0, ddof=1)) / SEEDS ** 0.5
            difference = numpy.abs(our_mean.mean(axis=0) - mean)
            self.assertTrue((difference <= share * tolerance * mean + ERRORS * error).all(),
                            f"{our_mean.mean(axis=0)} is not {mean} ± {error}")


if __name__ == "__main__":
    if program() is None:
        print("skipped: neither PENUMBRA_PROGRAM nor PATH has the penumbra program")
        sys.exit(77)
    unittest.main()
