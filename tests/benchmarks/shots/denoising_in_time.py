#!/usr/bin/env python3
"""Measures what denoised frames gain by light of those beside them: six shots, still and in time.

    denoising_in_time.py OUT [--frames 24] [--spp 16 64] [--reference-spp 64] [--methods nlmeans nfor oidn] ...

Files are kept: what is there is not made again. Prints a table in Markdown: relMSE, FLIP and flicker (penumbra compare
--help), means over the frames, of frames denoised by themselves, and the ratios to them of frames denoised in time.
Two references a and b of other seeds give squared errors without their own noise, on average: (x - a)(x - b). They are
over w^2 + 0.01, w the mean of both references over 5 x 5 pixels: over a noisy pixel's own square they would be biased.
FLIP is the mean of that to both references, with their noise. Needs numpy, scipy and OpenEXR.
"""

import argparse
import json
import os
import random
import subprocess

import numpy as np
import OpenEXR
from scipy.ndimage import map_coordinates, uniform_filter

FPS = 24
FILM = (96, 54)
KEYS = ("relmse", "flip", "flicker")


def moving(kind, *keys):
    """<animation> through transforms at equal times of the first second."""
    times = [index / (len(keys) - 1) for index in range(len(keys))]
    return f'<animation name="{kind}">' + "".join(
        f'<transform time="{time:g}">{key}</transform>' for time, key in zip(times, keys)) + "</animation>"


def at(x, y, z, scale=1.0, turn=0.0):
    return f'<scale value="{scale}"/><rotate y="1" angle="{turn}"/><translate x="{x}" y="{y}" z="{z}"/>'


def look(x, y, z, height=0.6):
    return f'<lookat origin="{x}, {y}, {z}" target="0, {height}, 0" up="0, 1, 0"/>'


def camera(*keys, inside=""):
    place = moving("to_world", *keys) if len(keys) > 1 else f'<transform name="to_world">{keys[0]}</transform>'
    return f'''<sensor type="perspective"><float name="fov" value="45"/>{place}
  <sampler type="independent"><integer name="sample_count" value="16"/></sampler>
  <film type="hdrfilm"><integer name="width" value="{FILM[0]}"/><integer name="height" value="{FILM[1]}"/>
    <rfilter type="box"/></film>{inside}</sensor>'''


def shape(kind, place, content):
    place = place if place.startswith("<animation") else f'<transform name="to_world">{place}</transform>'
    return f'<shape type="{kind}">{place}{content}</shape>'


def grey(value):
    return f'<bsdf type="diffuse"><rgb name="reflectance" value="{value}"/></bsdf>'


def checkers(scale, a="0.6, 0.5, 0.4", b="0.15, 0.2, 0.25"):
    return f'''<texture type="checkerboard" name="reflectance"><rgb name="color0" value="{a}"/>
  <rgb name="color1" value="{b}"/><transform name="to_uv"><scale value="{scale}"/></transform></texture>'''


def lamp(radiance):
    return f'<emitter type="area"><rgb name="radiance" value="{radiance}"/></emitter>'


FLOOR = shape("rectangle", '<scale value="5"/><rotate x="1" angle="-90"/>',
              f'<bsdf type="diffuse">{checkers(16)}</bsdf>')
WALL = shape("rectangle", '<scale value="5"/><translate z="-3"/>', grey("0.6, 0.3, 0.2"))
ROOM = FLOOR + WALL + shape("rectangle", '<scale value="5"/><rotate y="1" angle="90"/><translate x="-3"/>', grey(0.5))
SKY = '<emitter type="constant"><rgb name="radiance" value="0.15, 0.2, 0.3"/></emitter>'
BOX = shape("cube", at(-0.9, 0.5, -0.6, 0.5, 30), grey("0.2, 0.5, 0.3"))
METAL = '<bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.2"/></bsdf>'
BALL = shape("sphere", at(0.9, 0.45, 0, 0.45), METAL)
HIGH = shape("sphere", at(1.5, 3, 2, 0.25), lamp("40, 36, 30"))
STILL_CAMERA = camera(look(0.5, 1.8, 4.5))


def leaves():
    """Rectangles whose opacity is a texture, in random places."""
    chance = random.Random(1)
    bsdf = f'<bsdf type="mask" id="leaf"><texture type="checkerboard" name="opacity"><float name="color0" value="1"/>' \
           f'<float name="color1" value="0"/><transform name="to_uv"><scale value="2"/></transform></texture>' \
           '<bsdf type="twosided"><bsdf type="diffuse">' + checkers(8, "0.2, 0.5, 0.1", "0.05, 0.2, 0.05") + \
           '</bsdf></bsdf></bsdf>'
    made = []
    for _ in range(300):
        turn = f'<scale value="0.16"/><rotate x="1" angle="{chance.uniform(-90, 90):.3f}"/>' \
               f'<rotate y="1" angle="{chance.uniform(0, 360):.3f}"/>'
        x, y, z = (chance.gauss(0, spread) for spread in (0.8, 0.4, 0.6))
        where = f'<translate x="{x:.3f}" y="{0.9 + y:.3f}" z="{z:.3f}"/>'
        made.append(shape("rectangle", turn + where, '<ref id="leaf"/>'))
    return bsdf + "".join(made)


# Name: integrator, content.
SHOTS = {
    "camera": ("path", camera(look(-1.5, 2, 4.5), look(1.5, 1.4, 3.8)) + SKY + ROOM + BOX + BALL + HIGH),
    "object": ("path", STILL_CAMERA + SKY + ROOM + HIGH +
               shape("cube", moving("to_world", at(-1.6, 0.5, -0.8, 0.5, 0), at(-0.4, 0.5, -0.2, 0.5, 90)),
                     grey("0.2, 0.5, 0.3")) +
               shape("sphere", moving("to_world", at(1.6, 0.45, -0.6, 0.45), at(0.3, 0.45, 0.8, 0.45)), METAL)),
    "light": ("path", STILL_CAMERA + SKY + ROOM + BOX + BALL +
              shape("sphere", moving("to_world", at(-1.5, 2.2, 1.5, 0.3), at(1.8, 2.6, 1.2, 0.3)), lamp("30, 27, 22"))),
    "caustics": ("ppm", STILL_CAMERA + ROOM + shape("sphere", at(1.5, 3, 2, 0.1), lamp("300, 270, 220")) +
                 shape("sphere", moving("to_world", at(-0.9, 0.7, 0.4, 0.6), at(0.9, 0.7, 0.2, 0.6)),
                       '<bsdf type="dielectric"/>')),
    "fog": ("volpath", '<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.12"/>'
            '<rgb name="albedo" value="0.9"/></medium>' +
            camera(look(0.5, 1.8, 4.5), inside='<ref name="medium" id="fog"/>') +
            ROOM + BOX + shape("sphere", moving("to_world", at(-1.2, 1.6, 0, 0.15), at(1.4, 1.8, 0.4, 0.15)),
                               '<ref name="exterior" id="fog"/>' + lamp("60, 54, 44"))),
    "foliage": ("path", camera(look(-1, 1.5, 3.6, 0.9), look(1, 1.2, 3.2, 0.9)) + SKY + FLOOR + HIGH + leaves()),
}


def write_scene(path, integrator, content):
    settings = '<integer name="max_depth" value="8"/>'
    if integrator == "ppm":
        settings += '<integer name="photon_count" value="20000"/>'
    with open(path, "w", encoding="utf-8") as file:
        file.write(f'<scene version="3.0.0"><integrator type="{integrator}">{settings}</integrator>{content}</scene>\n')


def read(pattern, frames):
    """The frames' channels by name."""
    def channels(frame):
        name = pattern.replace("####", f"{frame:04}")
        found = OpenEXR.File(name, separate_channels=True).parts[0].channels
        return {key: channel.pixels.astype(np.float64) for key, channel in found.items()}
    return [channels(frame) for frame in range(frames)]


def followed(frame, later):
    """Where the next frame shows the points of each pixel (rows, columns), and whether it does."""
    rows, columns = np.indices(frame["R"].shape)
    at = np.stack([rows + frame["motion.W"], columns + frame["motion.Z"]])
    nearest = tuple(np.clip(np.round(x).astype(int), 0, size - 1) for x, size in zip(at, rows.shape))
    is_seen = (at > -0.5).all(0) & (at[0] < rows.shape[0] - 0.5) & (at[1] < rows.shape[1] - 0.5)
    for on, back in (("motion.Z", "motion.X"), ("motion.W", "motion.Y")):
        is_seen &= abs(frame[on] + later[back][nearest]) <= 1
    depths = frame["depth.Z"], later["depth.Z"][nearest]
    return at, is_seen & (abs(depths[0] - depths[1]) <= 0.1 * np.maximum(*depths))


def errors_without_noise(image, references, frames):
    """relMSE and flicker, means over the frames."""
    a, b = (read(reference, frames) for reference in references)
    x = read(image, frames)
    squares, changes = [], []
    for frame in range(frames):
        at, is_seen = followed(a[frame], a[frame + 1]) if frame + 1 < frames else (None, None)
        for c in "RGB":
            weight = 1 / (uniform_filter((a[frame][c] + b[frame][c]) / 2, 5) ** 2 + 0.01)
            now = [x[frame][c] - reference[frame][c] for reference in (a, b)]
            squares.append(np.mean(now[0] * now[1] * weight))
            if at is None:
                continue
            then = [map_coordinates(x[frame + 1][c] - reference[frame + 1][c], at, order=1, mode="nearest")
                    for reference in (a, b)]
            changes.append(np.mean(((then[0] - now[0]) * (then[1] - now[1]) * weight)[is_seen]))
    return {"relmse": np.mean(squares), "flicker": np.mean(changes)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--penumbra", default="penumbra", help="the program")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--spp", type=int, nargs="+", default=[16, 64])
    parser.add_argument("--reference-spp", type=int, default=64)
    parser.add_argument("--methods", nargs="+", default=["nlmeans", "nfor"])
    parser.add_argument("--shots", nargs="+", choices=SHOTS, default=list(SHOTS))
    arguments = parser.parse_args()

    def penumbra(*words):
        done = subprocess.run([arguments.penumbra, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True)
        return done.stdout

    def errors(image, references):
        found = errors_without_noise(image, references, arguments.frames)
        both = [json.loads(penumbra("compare", image, reference, "--json"))["mean"]["flip"] for reference in references]
        return {**found, "flip": sum(both) / 2}

    columns = [f"{method},{spp}" for spp in arguments.spp for method in arguments.methods]
    print(f'|{",".join(KEYS)}|' + "".join(f"{column}|" for column in columns))
    print("|-|" + "-|" * len(columns))
    for name in arguments.shots:
        folder = os.path.join(arguments.out, name)
        os.makedirs(folder, exist_ok=True)
        scene = os.path.join(folder, "scene.xml")
        write_scene(scene, *SHOTS[name])
        frames = ["--frames", f"0-{arguments.frames - 1}", "--fps", FPS, "--sampler", "sobol", "--layers", "motion",
                  "--quiet", "--no-contact-sheet", "--seed-per-frame", "frame"]
        references = [os.path.join(folder, f"reference-{letter}.####.exr") for letter in "ab"]
        for reference, seed in zip(references, (1000, 2000)):
            penumbra("render", scene, *frames, "--spp", arguments.reference_spp, "--seed", seed, "-o", reference)
        cells = []
        for spp in arguments.spp:
            noisy = os.path.join(folder, f"noisy-{spp}.####.exr")
            penumbra("render", scene, *frames, "--spp", spp, "--denoise=layers", "-o", noisy)
            for method in arguments.methods:
                means = []
                for radius in (0, 2):
                    denoised = os.path.join(folder, f"{method}-{spp}-{radius}.####.exr")
                    penumbra("denoise", noisy, "--method", method, "--time-radius", radius, "-o", denoised)
                    means.append(errors(denoised, references))
                still, timed = means
                cells.append(",".join(f"{still[key]:.1e}×{timed[key] / still[key]:.2f}" for key in KEYS))
        print(f"|{name}|" + "".join(f"{cell}|" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
