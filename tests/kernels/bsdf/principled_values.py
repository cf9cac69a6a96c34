"""Writes principled_values.txt: what Mitsuba 3's principled BSDFs are worth, for principled_test.cpp.

`python principled_values.py > principled_values.txt`, by a Python that has mitsuba. A line that begins with `<` is a BSDF;
each of the lines after it has the viewer's direction, that of the light, f cos (red, green, blue) and the density of
sampling the light's, in the frame of the normal z. Single precision, as everything in scalar_rgb is.
"""

import math
import random
import struct
import sys

import mitsuba as mi

mi.set_variant("scalar_rgb")

COLOUR = ("base_color", "0.8 0.35 0.1")
# Glossier clearcoats are not asked of: there, Mitsuba's 1 - cos^2 has few digits.
MATERIALS = [
    ("principled", {}),
    ("principled", {"base_color": "0 0 0", "spec_tint": 1, "sheen": 1, "sheen_tint": 1}),
    ("principled", {"roughness": 0.1, "specular": 0.9}),
    ("principled", {"roughness": 1, "flatness": 0.6, "sheen": 0.7, "sheen_tint": 0.4}),
    ("principled", {"metallic": 1, "roughness": 0.3, "anisotropic": 0.9}),
    ("principled", {"metallic": 0.5, "spec_tint": 0.6, "roughness": 0.4, "clearcoat": 1}),
    ("principled", {"clearcoat": 0.8, "clearcoat_gloss": 0.6, "roughness": 0.7, "specular": 0.2}),
    ("principled", {"eta": 0.7, "spec_tint": 0.5, "metallic": 0.3, "clearcoat": 0.5}),
    ("principled", {"spec_trans": 1, "roughness": 0.3, "eta": 1.5}),
    ("principled", {"spec_trans": 0.6, "roughness": 0.5, "anisotropic": 0.5, "eta": 1.33, "metallic": 0.2}),
    ("principled", {"spec_trans": 0.8, "roughness": 0.8, "specular": 0.7, "clearcoat": 1, "sheen": 1, "flatness": 1}),
    ("principled", {"spec_trans": 0.5, "roughness": 0.4, "eta": 0.8, "spec_tint": 0.3}),
    ("principled", {"spec_trans": 0.4, "clearcoat": 0.6, "main_specular_sampling_rate": 0.3,
                    "diffuse_reflectance_sampling_rate": 2, "clearcoat_sampling_rate": 5}),
    ("principledthin", {}),
    ("principledthin", {"diff_trans": 1.4, "flatness": 0.5, "roughness": 0.9, "sheen": 0.8, "sheen_tint": 0.5}),
    ("principledthin", {"spec_trans": 1, "roughness": 0.4, "eta": 1.8}),
    ("principledthin", {"spec_trans": 0.7, "diff_trans": 0.6, "spec_tint": 0.5, "anisotropic": 0.8, "roughness": 0.5}),
    ("principledthin", {"spec_trans": 0.5, "eta": 0.6, "spec_tint": 1, "roughness": 0.6,
                        "specular_reflectance_sampling_rate": 3, "specular_transmittance_sampling_rate": 0.5,
                        "diffuse_reflectance_sampling_rate": 0.2, "diffuse_transmittance_sampling_rate": 4, "diff_trans": 2}),
]


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def direction(cosine, azimuth):
    sine = math.sqrt(1 - cosine * cosine)
    return [single(sine * math.cos(azimuth)), single(sine * math.sin(azimuth)), single(cosine)]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [single(x / length) for x in v]


def pairs(rng, eta):
    """Viewers from either side; lights anywhere, about the mirror direction, about the refracted one, straight through."""
    for side in (1, -1):
        for cosine in (0.99, 0.6, 0.15):
            x, y, z = viewer = direction(side * cosine, rng.uniform(0, 2 * math.pi))
            n = eta if side > 0 else 1 / eta
            lights = [direction(rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)) for _ in range(2)]
            lights += [unit([t + rng.gauss(0, 0.15) for t in (-x, -y, z)]) for _ in range(2)]
            lights += [unit([t + rng.gauss(0, 0.1) for t in (-x / n, -y / n, -side * math.sqrt(max(0.01, 1 - (1 - z * z) / n / n)))])]
            lights += [unit([t + rng.gauss(0, 0.1) for t in (-x, -y, -z)])]
            for light in lights:
                yield viewer, light


rng = random.Random(1)
context = mi.BSDFContext()
for plugin, parameters in MATERIALS:
    values = dict([COLOUR])
    values.update(parameters)
    tags = ["<rgb name='%s' value='%s'/>" % item if item[0] == "base_color" else "<float name='%s' value='%s'/>" % item
            for item in values.items()]
    text = "<bsdf version='3.0.0' type='%s'>%s</bsdf>" % (plugin, "".join(tags))
    bsdf = mi.load_string(text)
    print(text.replace(" version='3.0.0'", ""))
    for viewer, light in pairs(rng, float(values.get("eta", 1.5))):
        si = mi.SurfaceInteraction3f()
        si.wi = viewer
        value, pdf = bsdf.eval(context, si, light), bsdf.pdf(context, si, light)
        print(*("%.9g" % x for x in [*viewer, *light, value[0], value[1], value[2], pdf]))
sys.stdout.flush()
