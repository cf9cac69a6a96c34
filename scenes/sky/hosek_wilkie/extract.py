"""Writes sky.inc and sun.inc from the authors' coefficients in Mitsuba 3's package.

    pip install mitsuba==3.9.1; python3 scenes/sky/hosek_wilkie/extract.py
"""
import importlib.util
import pathlib
import struct

import numpy as np

HERE = pathlib.Path(__file__).parent
NOTICE = "// Copyright (c) 2012 - 2013, Lukas Hosek and Alexander Wilkie: see LICENSE.\n"


def read_tensors(file):
    """Mitsuba's tensor file: magic, version, count; then for each name, dimensions, type, offset, shape."""
    data = file.read_bytes()
    at, tensors = 18, {}
    for _ in range(struct.unpack_from("<I", data, 14)[0]):
        length = struct.unpack_from("<H", data, at)[0]
        name = data[at + 2 : at + 2 + length].decode()
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at + 2 + length)
        at += 2 + length + 11
        shape = struct.unpack_from(f"<{dimensions}Q", data, at)
        at += 8 * dimensions
        if kind == 11:  # double
            tensors[name] = np.frombuffer(data, "<f8", int(np.prod(shape)), offset).reshape(shape)
    return tensors


def number(x):
    text = f"{x:.8g}".replace("e+", "e")
    return (text if "." in text or "e" in text else text + ".") + "f" if x else "0"


def write(name, text, rows):
    lines = ["{" + ", ".join(map(number, row)) + "}," for row in rows]
    (HERE / name).write_text(NOTICE + text + "\n".join(lines) + "\n")


package = pathlib.Path(importlib.util.find_spec("mitsuba").submodule_search_locations[0])
data = read_tensors(package / "data" / "sunsky" / "sunsky_datasets.bin")
write(
    "sky.inc",
    "// For turbidities 1 to 10, albedos 0 and 1, the 6 control points of the elevation, red, green and blue:\n"
    "// the parameters A, B, C, D, E, F, G, I and H, and the mean radiance.\n",
    np.concatenate([data["sky_params_rgb"], data["sky_rad_rgb"][..., None]], -1).reshape(-1, 10),
)
write(
    "sun.inc",
    "// For turbidities 1 to 10, 45 segments of the elevation, and 400 to 720 nm in steps of 40: a cubic's\n"
    "// coefficients from that of 1 to that of x^3.\n",
    data["sun_rad_spec"][:, :, 2:].reshape(-1, 4),
)
for row in data["sun_ld_spec"][2:]:
    print("    {" + ", ".join(f"{x:.8g}" for x in row) + "},")
