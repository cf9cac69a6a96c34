#!/usr/bin/env python3
"""What samplers do for single pixels and for means of blocks: a Markdown table of errors over those of `independent`.

An error is the root of the mean, over the image, of the variance between images of independent seeds over (mean image
of all^2 + 0.01). Below 1: less error than as many independent samples. Needs numpy and OpenEXR.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "scheduler/packaging/python"))
from penumbra.images import read  # noqa: E402

SAMPLERS = ("independent", "stratified", "halton", "sobol")
SIDES = (1, 2, 4, 8)


def blocks(image, side):
    """Means of squares of `side` pixels; what is left over at the right and at the bottom does not count."""
    h, w = (n // side for n in image.shape[:2])
    return image[:h * side, :w * side].reshape(h, side, w, side, -1).mean((1, 3))


def images_of(scene, sampler, spp, seeds, a):
    """Array of (seed, row, column, channel)."""
    images = []
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "a.exr")
        for seed in seeds:
            subprocess.run([
                os.path.join(a.penumbra, "penumbra"), "render", scene, "--sampler", sampler, "--spp",
                str(spp), "--seed",
                str(seed), "--scale",
                str(a.scale), "--quiet", "--restart", "--no-features", "-o", out
            ] + a.options,
                           check=True)
            images.append(read(out)[0]["beauty"][:, :, :3].astype(np.float64))
    return np.stack(images)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--penumbra",
                        default="build/release",
                        metavar="FOLDER",
                        help="with penumbra (default: build/release)")
    parser.add_argument("--spp", type=int, action="append", metavar="N", help="repeatable (default: 16 and 64)")
    parser.add_argument("--seeds", type=int, default=8, help="images of each, two or more (default: 8)")
    parser.add_argument("--scale", type=float, default=0.25, help="of the film's width and height (default: 0.25)")
    parser.add_argument("--options", type=str.split, default=[], help="further options of penumbra render")
    a = parser.parse_args()
    if a.seeds < 2:
        parser.error("--seeds must be 2 or more")
    print("| scene | spp | sampler | " + " | ".join("pixel" if side == 1 else f"{side} × {side}"
                                                    for side in SIDES) + " |\n" + "|---" * (3 + len(SIDES)) + "|")
    for scene in a.scenes:
        path = pathlib.Path(scene)
        name = path.parent.name if path.stem == "scene" else path.stem
        for spp in a.spp or [16, 64]:
            # Seeds of their own: samplers may share random numbers.
            images = {s: images_of(scene, s, spp, range(100 * i, 100 * i + a.seeds), a) for i, s in enumerate(SAMPLERS)}
            truth = np.mean([stack.mean(0) for stack in images.values()], 0)
            errors = {}
            for sampler, stack in images.items():
                errors[sampler] = []
                for side in SIDES:
                    variance = np.stack([blocks(image, side) for image in stack]).var(0, ddof=1).mean(2)
                    errors[sampler].append(np.sqrt(np.mean(variance / (blocks(truth, side).mean(2)**2 + 0.01))))
            for sampler in SAMPLERS:
                ratios = (e / i for e, i in zip(errors[sampler], errors["independent"]))
                print(f"| {name} | {spp} | {sampler} | " + " | ".join(f"{r:.2f}" for r in ratios) + " |", flush=True)


if __name__ == "__main__":
    main()
