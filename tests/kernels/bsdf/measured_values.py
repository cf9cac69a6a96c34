"""Prints measured_values.txt: what Mitsuba 3's measured is worth, for measured_test.cpp.

    PENUMBRA_MEASURED_FOLDER=folder kernels_test --gtest_filter='MeasuredBsdf.HasTheValuesOfMitsuba'
    python measured_values.py folder > measured_values.txt

The first command writes the files; the second takes a Python that has mitsuba. A line has the name of a file, the
direction to the viewer and that to the light, the pdf, and f cos in each channel or at each of WAVELENGTHS.
"""

import math
import pathlib
import random
import struct
import sys

import mitsuba as mi

FILES = ("isotropic", "anisotropic", "quarter", "strange", "spectral")
WAVELENGTHS = (400, 450, 500, 550, 600, 650, 700)


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def direction(cosine, azimuth):
    sine = math.sqrt(1 - cosine * cosine)
    # Of a zero the sign would decide the quadrant.
    return [single(sine * math.cos(azimuth)) + 0.0, single(sine * math.sin(azimuth)) + 0.0, single(cosine)]


def spectral_values(bsdf, context, si, light):
    values = []
    for start in range(0, len(WAVELENGTHS), 4):
        some = WAVELENGTHS[start:start + 4]
        si.wavelengths = [*some, *[some[-1]] * (4 - len(some))]
        values += [float(x) for x in bsdf.eval(context, si, light)][:len(some)]
    return values


rng = random.Random(1)
for name in FILES:
    mi.set_variant("scalar_spectral" if name == "spectral" else "scalar_rgb")
    context = mi.BSDFContext()
    bsdf = mi.load_dict({"type": "measured", "filename": str(pathlib.Path(sys.argv[1], name + ".bsdf"))})
    for cosine in (1, 0.99, 0.8, 0.5, 0.2, 0.05):
        for _ in range(12):
            viewer = direction(cosine, rng.uniform(-math.pi, math.pi))
            light = direction(rng.uniform(0.02, 1), rng.uniform(-math.pi, math.pi))
            si = mi.SurfaceInteraction3f()
            si.wi = viewer
            pdf = bsdf.pdf(context, si, light)
            if name == "spectral":
                values = spectral_values(bsdf, context, si, light)
            else:
                values = bsdf.eval(context, si, light)
            print(name, *("%.9g" % x for x in (*viewer, *light, pdf, *values)))
