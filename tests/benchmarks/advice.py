#!/usr/bin/env python3
"""Compares the choice of `penumbra advise` with exhaustive search, as a Markdown table.

Every candidate renders each scene with several seeds. Its figure is the mean relative squared error, without the largest
0.2 % of the pixels, times the counted work of a sample (of `advise --json`). Single bright samples of light that all
candidates find alike would decide otherwise. The converged image is a long render of the chosen candidate; where that is
none with photons, the mean of its and of ppm's. Needs numpy and OpenEXR.

  chosen   what advise takes
  best     the candidate with the least figure
  loss     the chosen one's figure over the best one's: 1 is the best choice
  gain     the first candidate's figure, of the scene's own settings, over the chosen one's
  noise    standard error of the loss, by the seeds
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import OpenEXR
except ImportError as missing:
    sys.exit(f"{sys.argv[0]}: needs the Python packages numpy and OpenEXR ({missing})")

# Of the trimmed relMSE; see scheduler/image/metrics/error_metrics.h, whose share of pixels is half as large.
EPSILON, TRIMMED_SHARE = 0.01, 0.002


def answer_of(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


class Scene:

    def __init__(self, file, a, work):
        self.file, self.a, self.out = file, a, os.path.join(work, "image.exr")
        self.program = os.path.join(a.programs, "penumbra")
        film = json.loads(answer_of([self.program, "info", file, "--json"]))["film"]
        self.common = [file, "--scale", str(min(1.0, a.side / max(film["width"], film["height"])))]

    def advice(self):
        return json.loads(answer_of([self.program, "advise", *self.common, "--json"]))

    def image(self, options, spp, seed):
        answer_of([
            self.program, "render", *self.common, *options.split(), "--spp", str(spp), "--seed", str(seed), "-q",
            "--no-features", "--no-statistics", "--restart", "-o", self.out
        ])
        with OpenEXR.File(self.out, separate_channels=True) as file:
            channels = file.channels()
            return np.stack([channels[name].pixels for name in "RGB"], -1).astype(np.float64)


def error(image, truth):
    ordered = np.sort(((image - truth)**2 / (truth**2 + EPSILON)).mean(2).ravel())
    return ordered[:len(ordered) - int(np.ceil(TRIMMED_SHARE * len(ordered)))].mean()


def measure(file, a, work):
    scene = Scene(file, a, work)
    advice = scene.advice()
    rows = [row for row in advice["candidates"] if "work" in row]
    images = [[scene.image(row["options"], a.spp, 100 + k) for k in range(a.seeds)] for row in rows]
    names = [row["name"] for row in rows]
    chosen = names.index(advice["chosen"])
    # Rare bright samples of paths would need far longer than photons to converge.
    photons = [i for i, name in enumerate(names) if name.startswith("ppm")][:1]
    converged = [chosen] if names[chosen].startswith("ppm") else [chosen, *photons]
    truth = np.mean([scene.image(rows[i]["options"], a.reference_spp, 7 + i) for i in converged], 0)
    figures = np.array([[error(image, truth) * row["work"] for image in one] for one, row in zip(images, rows)])
    means = figures.mean(1)
    best = int(np.argmin(means))
    ratios = figures[chosen] / figures[best]
    noise = np.std(ratios, ddof=1) / np.sqrt(a.seeds)
    return {
        "scene": pathlib.Path(file).parent.name if file.endswith("scene.xml") else pathlib.Path(file).stem,
        "chosen": names[chosen],
        "best": names[best],
        "loss": means[chosen] / means[best],
        "noise": noise,
        "gain": means[0] / means[chosen],
        "seconds": advice["seconds"],
        "figures": {
            row["name"]: [mean / means[0], row["error"] * row["work"] / (rows[0]["error"] * rows[0]["work"])]
            for row, mean in zip(rows, means)
        },  # relative to the first: measured, advised
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", metavar="SCENE", nargs="+")
    parser.add_argument("--programs", default="build/release", metavar="FOLDER", help="with penumbra")
    parser.add_argument("--side", type=int, default=96, help="longest side of the images in pixels")
    parser.add_argument("--spp", type=int, default=64, help="of the judged images")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--reference-spp", type=int, default=4096, help="of a converged image")
    parser.add_argument("--json", metavar="FILE", help="also write every figure")
    a = parser.parse_args()
    print("| scene | chosen | best | loss | noise | gain | seconds |\n|---|---|---|---|---|---|---|", flush=True)
    found = []
    for file in a.scenes:
        with tempfile.TemporaryDirectory() as work:
            try:
                row = measure(file, a, work)
            except RuntimeError as wrong:
                print(f"| {file} | {wrong} |", flush=True)
                continue
        print("| {scene} | {chosen} | {best} | {loss:.2f} | {noise:.2f} | {gain:.1f} | {seconds:.1f} |".format(**row),
              flush=True)
        found.append(row)
        if a.json:
            with open(a.json, "w", encoding="utf-8") as out:
                json.dump(found, out, indent=2)


if __name__ == "__main__":
    main()
