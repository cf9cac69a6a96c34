#!/usr/bin/env python3
"""Penumbra against Mitsuba 3 (llvm_ad_rgb) on scenes that both read, as a Markdown table.

Times are seconds of rendering alone, of alternating renders on one core. An error is the variance between images of
independent seeds over (converged image^2 + 0.01), of the means of 4 x 4 pixels: so no bias of either renderer counts.
Equal error is found with error falling as 1 / spp. Ratios above 1: Penumbra is ahead. Needs mitsuba and numpy.

  start-up  seconds of all else: loading, sending the scene to the worker, writing; with Mitsuba, loading and compiling
  means     Penumbra's over Mitsuba's mean - 1, in percent and in standard errors; share of 4 x 4 blocks that differ by
            more than 4 standard errors (0.1 % would by chance)
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

try:
    import mitsuba as mi
    import numpy as np
except ImportError as missing:
    sys.exit(f"{sys.argv[0]}: needs the Python packages mitsuba and numpy ({missing})")

BATCHES = 4  # of a converged image


def serve(file, core):
    """Mitsuba in a process of its own: answers lines "SPP SEED FILE" with seconds; first, with those of the start-up."""
    import drjit as dr
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    dr.eval(mi.Float(1) + 1)
    start = time.perf_counter()
    scene = mi.load_file(file)  # on all cores: on one, it can wait for itself
    for thread in os.listdir("/proc/self/task"):
        os.sched_setaffinity(int(thread), {core})
    dr.set_thread_count(1)

    def render(spp, seed, out):
        before = time.perf_counter()
        image = mi.render(scene, spp=spp, seed=seed).numpy()
        spent = time.perf_counter() - before
        if out != "-":
            np.save(out, image[:, :, :3].astype(np.float32))
        return spent

    render(1, 1000, "-")
    first = time.perf_counter() - start
    again = render(1, 1001, "-")
    answers.write(f"{first - again}\n")
    for line in sys.stdin:
        spp, seed, out = line.split()
        answers.write(f"{render(int(spp), int(seed), out)}\n")


class Mitsuba:

    def __init__(self, file, work, core):
        self.out = os.path.join(work, "mitsuba.npy")
        self.process = subprocess.Popen([sys.executable, __file__, "--serve", file, core],
                                        stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE,
                                        text=True)
        self.start_ups = [self.answer()]

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit("Mitsuba has ended; its message is above")
        return float(line)

    def render(self, spp, seed):
        """Image, seconds."""
        self.process.stdin.write(f"{spp} {seed} {self.out}\n")
        self.process.stdin.flush()
        seconds = self.answer()
        return np.load(self.out), seconds

    def end(self):
        self.process.stdin.close()
        self.process.wait()


class Penumbra:

    def __init__(self, file, folder, sampler, work, core, options):
        self.command = [
            "taskset", "-c", core,
            os.path.join(folder, "penumbra"), "render", file, "--workers", "1", "--threads", "1", "--restart"
        ] + options
        self.command += ["--sampler", sampler] if sampler else []
        self.out = os.path.join(work, "penumbra.exr")
        self.start_ups = []

    def render(self, spp, seed):
        """Image, seconds."""
        before = time.perf_counter()
        done = subprocess.run(self.command +
                              ["--spp", str(spp), "--seed", str(seed), "-o", self.out],
                              capture_output=True,
                              text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(done.args)}:\n{done.stderr}")
        with open(self.out[:-4] + ".json", encoding="utf-8") as record:
            seconds = seconds_of_rendering(json.load(record))
        self.start_ups.append(time.perf_counter() - before - seconds)
        return image_of(self.out), seconds

    def end(self):
        pass


def seconds_of_rendering(record):
    """From when the worker has the scene to the last tile, of a record of one worker with one thread."""
    took = record["seconds"]
    first_tile = record["workers"][0]["busy_seconds"] / record["units"]["done"]
    return took["render"] - took["to_first_tile"] + first_tile


def image_of(file):
    """The colours of an EXR file, without its other layers."""
    for name, bitmap in mi.Bitmap(file).split():
        if name in ("<root>", ""):
            return np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    sys.exit(f"{file}: holds no colours")


def blocks(image):
    h, w, c = image.shape
    return image[:h // 4 * 4, :w // 4 * 4].reshape(h // 4, 4, w // 4, 4, c).mean((1, 3)).astype(np.float64)


def errors(images, truth):
    """Mean; mean without the largest 0.1 %; median over squares of 8 x 8 blocks of their means."""
    variance = np.stack(images).var(0, ddof=1).mean(2) if len(images) > 1 else np.full(truth.shape[:2], np.nan)
    relative = variance / (truth.mean(2)**2 + 0.01)
    ordered = np.sort(relative.ravel())
    h, w = (n // 8 * 8 for n in relative.shape)
    squares = relative[:h, :w].reshape(h // 8, 8, w // 8, 8).mean((1, 3))
    return relative.mean(), ordered[:int(len(ordered) * 0.999)].mean(), np.median(squares)


def spelled_for_mitsuba(file, work):
    """A file of version 0.x without what Mitsuba 3 does not read, beside links to its folders; others as they are."""
    text = open(file, encoding="utf-8").read()
    if re.search(r'<scene version="[1-9]', text):
        return file
    text = re.sub(r'\s*<(boolean|float|string) name="(strictNormals|extEta|gamma|banner|filterType)"[^>]*/>', "", text)
    for entry in os.scandir(os.path.dirname(file)):
        link = os.path.join(work, entry.name)
        if entry.is_dir() and not os.path.lexists(link):
            os.symlink(entry.path, link)
    with open(os.path.join(work, "scene.xml"), "w", encoding="utf-8") as out:
        out.write(text)
    return os.path.join(work, "scene.xml")


def converged(label, renderer, spp, work, digest):
    """Mean and variance of the mean of 4 x 4 blocks over batches of independent seeds, from the cache where they are
    there."""
    file = os.path.join(work, f"{label}-{spp}x{BATCHES}-{digest}.npz")
    if not os.path.exists(file):
        batches = [blocks(renderer.render(spp, 5000 + k)[0]) for k in range(BATCHES)]
        np.savez(file[:-4],
                 mean=np.mean(batches, 0),
                 variance=np.var(batches, 0, ddof=1) / BATCHES,
                 totals=[batch.mean() for batch in batches])
    data = np.load(file)
    return data["mean"], data["variance"], data["totals"]


def measure(file, a):
    name = pathlib.Path(file).parent.name
    work = os.path.abspath(os.path.join(a.references, name))
    os.makedirs(work, exist_ok=True)
    digest = hashlib.sha256(open(file, "rb").read()).hexdigest()[:8]
    mitsuba = Mitsuba(spelled_for_mitsuba(file, work), work, a.core)
    first, seconds = mitsuba.render(2, 1)
    spp = a.spp or max(2, round(2 * a.seconds / seconds))
    jobs = {"mitsuba": mitsuba}
    samplers = (None, ) if len(a.penumbra) > 1 else ("independent", None)
    for folder in a.penumbra:
        for sampler in samplers:
            jobs[f"{folder} {sampler or 'default'}"] = Penumbra(file, folder, sampler, work, a.core, a.options)
    last = f"{a.penumbra[-1]} default"
    more = max(spp, round(spp * a.reference_seconds / a.seconds / BATCHES))
    ours = converged("penumbra", jobs[last], more, work, digest)
    theirs = converged("mitsuba", mitsuba, more, work, digest)
    truth = (ours[0] + theirs[0]) / 2
    times, images = ({label: [] for label in jobs} for _ in range(2))
    for k in range(a.rounds):
        for label, job in jobs.items():
            image, seconds = job.render(spp, 1 + k)
            times[label].append(seconds)
            images[label].append(blocks(image))
            if k == 0 and a.peer and job is mitsuba:
                os.makedirs(os.path.join(a.peer, name), exist_ok=True)
                mi.Bitmap(image).write(os.path.join(a.peer, name, f"{seconds:.3f}-seconds.exr"))
    mitsuba.end()
    pixels = first.shape[0] * first.shape[1]
    theirs_took, their_error = np.median(times["mitsuba"]), errors(images["mitsuba"], truth)
    difference = np.abs(ours[0] - theirs[0]) / np.sqrt(ours[1] + theirs[1] + 1e-20)
    sigma = np.sqrt((ours[2].var(ddof=1) + theirs[2].var(ddof=1)) / BATCHES)
    off = ours[2].mean() - theirs[2].mean()
    means = f"{100 * off / theirs[2].mean():+.2f} %, {off / sigma:+.1f} σ, {100 * (difference > 4).mean():.2f} %"
    rows = []
    for label, job in jobs.items():
        if job is mitsuba:
            continue
        took = np.median(times[label])
        ratios = [theirs_took * e / (took * o) for e, o in zip(their_error, errors(images[label], truth))]
        mine, other = pixels * spp / took * 1e-6, pixels * spp / theirs_took * 1e-6
        rows.append(
            dict(scene=name,
                 label=label,
                 spp=spp,
                 mine=mine,
                 other=other,
                 ratios=ratios,
                 start=np.median(job.start_ups),
                 their_start=mitsuba.start_ups[0],
                 means=means))
    return rows


def main():
    if sys.argv[1:2] == ["--serve"]:
        return serve(sys.argv[2], int(sys.argv[3]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE.xml")
    parser.add_argument("--penumbra",
                        action="append",
                        metavar="FOLDER",
                        help="with penumbra and penumbra-worker; of several, all run with their default sampler")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--spp", type=int, default=0, help="of each timed image; 0: as many as --seconds allow")
    parser.add_argument("--seconds", type=float, default=4, help="of Mitsuba for a timed image (default: 4)")
    parser.add_argument("--reference-seconds",
                        type=float,
                        default=60,
                        help="of Mitsuba for the converged image (default: 60); Penumbra gets as many samples")
    parser.add_argument("--references", default="references", metavar="FOLDER", help="where converged images are kept")
    parser.add_argument("--peer", metavar="DIR", help="also write Mitsuba's images for penumbra report --peer DIR")
    parser.add_argument("--core", default="0", help="the core that both run on")
    parser.add_argument("--json", metavar="FILE", help="also write all figures")
    parser.add_argument("--options", type=str.split, default=[], help="further options of penumbra render")
    a = parser.parse_args()
    a.penumbra = [os.path.abspath(folder) for folder in a.penumbra or ["build/release"]]
    mi.set_variant("scalar_rgb")
    print(
        "| scene | spp | Penumbra | Msamples / s: Penumbra, Mitsuba, ratio | time to equal error: mean, trimmed, median "
        "| start-up: Penumbra, Mitsuba | means |\n|---|---|---|---|---|---|---|")
    everything = []
    for file in a.scenes:
        for r in measure(os.path.abspath(file), a):
            everything.append(r)
            print(
                f"| {r['scene']} | {r['spp']} | {os.path.basename(r['label'])} | {r['mine']:.2f}, {r['other']:.2f}, {r['mine'] / r['other']:.2f} | "
                + ", ".join(f"{x:.2f}"
                            for x in r["ratios"]) + f" | {r['start']:.1f}, {r['their_start']:.1f} | {r['means']} |",
                flush=True)
            if a.json:
                with open(a.json, "w", encoding="utf-8") as out:
                    json.dump(everything, out, indent=1)


if __name__ == "__main__":
    main()
