"""Writes hair_values.txt: what Mitsuba 3's hair is worth, for hair_test.cpp.

`python hair_values.py > hair_values.txt`, by a Python that has mitsuba. The lines are as those of principled_values.txt.
"""

import math
import random
import struct

import mitsuba as mi

mi.set_variant("scalar_rgb")

MATERIALS = [
    {},
    {"eumelanin": 0.3},
    {"pheomelanin": 1.5, "longitudinal_roughness": 0.9},
    {"sigma_a": 0.4, "scale": 0.5, "azimuthal_roughness": 0.8, "scale_tilt": 0},
    {"sigma_a": 0, "longitudinal_roughness": 0.15, "azimuthal_roughness": 0.2, "scale_tilt": -4},
    {"sigma_a": 0.1, "longitudinal_roughness": 1, "azimuthal_roughness": 1, "scale_tilt": 10, "int_ior": 1.8},
    {"longitudinal_roughness": 0.05, "azimuthal_roughness": 0.4, "int_ior": 1.33, "ext_ior": 1},
]


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def direction(cosine, azimuth):
    sine = math.sqrt(1 - cosine * cosine)
    return [single(sine * math.cos(azimuth)), single(sine * math.sin(azimuth)), single(cosine)]


def tag(name, value):
    if name == "sigma_a":
        return "<rgb name='sigma_a' value='%s %s %s'/>" % (value, 2 * value, 4 * value)
    return "<float name='%s' value='%s'/>" % (name, value)


rng = random.Random(1)
context = mi.BSDFContext()
for parameters in MATERIALS:
    text = "<bsdf version='3.0.0' type='hair'>%s</bsdf>" % "".join(tag(*item) for item in parameters.items())
    bsdf = mi.load_string(text)
    print(text.replace(" version='3.0.0'", ""))
    for cosine in (0.99, 0.6, 0.15):
        for _ in range(6):
            viewer = direction(cosine, rng.uniform(0, 2 * math.pi))
            light = direction(rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi))
            if rng.random() < 0.5:  # in the cone of the specular directions
                across = math.sqrt(1 - viewer[1] ** 2)
                azimuth = rng.uniform(0, 2 * math.pi)
                light = [single(across * math.cos(azimuth)), -viewer[1], single(across * math.sin(azimuth))]
            si = mi.SurfaceInteraction3f()
            si.wi = viewer
            value, pdf = bsdf.eval(context, si, light), bsdf.pdf(context, si, light)
            print(*("%.9g" % x for x in [*viewer, *light, value[0], value[1], value[2], pdf]))
