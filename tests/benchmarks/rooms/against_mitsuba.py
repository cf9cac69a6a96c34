#!/usr/bin/env python3
"""Programs of Penumbra against Mitsuba 3 (llvm_ad_rgb) on scenes that both read, as a Markdown table. Before and after
a change in one run: --penumbra before=FOLDER --penumbra after=FOLDER.

Times are seconds of CPU on one thread, so that others on the machine do not count. The seconds of a sample are the
slope between few samples and --spp. Start-up is what remains of the first render: loading, building, compiling and
writing, with no cache from before (of Mitsuba without Python and its imports). An error is the variance between images
of independent seeds over (mean image of all^2 + 0.01), of the means of 4 x 4 pixels: so no bias of either counts, and
the points that neighbours share do. Equal error is found with error falling as 1 / spp. Ratios above 1: Penumbra is
ahead. Needs mitsuba and numpy.

  error   time to equal error: of mean errors, of those without the largest thousandth, of the median of squares of
          8 x 8 blocks
  means   Penumbra's over Mitsuba's mean - 1, in percent and in standard errors
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

try:
    import mitsuba as mi
    import numpy as np
except ImportError as missing:
    sys.exit(f"{sys.argv[0]}: needs the Python packages mitsuba and numpy ({missing})")

FEW = 2  # samples of the first render


def serve(file, scale):
    """Mitsuba in a process of its own: answers lines "SPP SEED FILE" with the seconds of CPU since the line before."""
    import drjit as dr
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(1)
    dr.eval(mi.Float(1) + 1)
    before = time.process_time()
    scene = mi.load_file(file)
    parameters = mi.traverse(scene)
    for key in [key for key in parameters.keys() if key.endswith("film.size")]:
        parameters[key] = [max(1, round(n * scale)) for n in parameters[key]]
    parameters.update()
    for line in sys.stdin:
        spp, seed, out = line.split()
        image = mi.render(scene, spp=int(spp), seed=int(seed)).numpy()
        np.save(out, image[:, :, :3].astype(np.float32))
        after = time.process_time()
        answers.write(f"{after - before}\n")
        before = after


class Mitsuba:

    def __init__(self, file, work, scale):
        self.out = os.path.join(work, "mitsuba.npy")
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve", file, str(scale)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=without_caches(work),
            text=True)

    def render(self, spp, seed):
        """Image, seconds of CPU."""
        self.process.stdin.write(f"{spp} {seed} {self.out}\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            sys.exit("Mitsuba has ended; its message is above")
        return np.load(self.out), float(line)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


class Penumbra:

    def __init__(self, file, folder, sampler, work, scale, options):
        self.command = [
            os.path.join(folder, "penumbra"), "render", file, "--workers", "1", "--threads", "1", "--restart",
            "--quiet", "--scale",
            str(scale)
        ] + options
        self.command += ["--sampler", sampler] if sampler else []
        self.out = os.path.join(work, "penumbra.exr")
        self.environment = without_caches(work)

    def render(self, spp, seed):
        """Image, seconds of CPU, those of the worker with them."""
        process = subprocess.Popen(self.command +
                                   ["--spp", str(spp), "--seed", str(seed), "-o", self.out],
                                   env=self.environment)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"{' '.join(process.args)}: ended with {process.returncode}; its message is above")
        return image_of(self.out), used.ru_utime + used.ru_stime

    def end(self):
        pass


def without_caches(work):
    """The environment with an empty home, where both keep their caches."""
    kept = ("XDG_CACHE_HOME", "PENUMBRA_HIERARCHY_CACHE", "PENUMBRA_KERNEL_CACHE")
    return {k: v for k, v in os.environ.items() if k not in kept} | {"HOME": tempfile.mkdtemp(dir=work)}


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
    variance = np.stack(images).var(0, ddof=1).mean(2)
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


class Timed:
    """A renderer with its images and seconds."""

    def __init__(self, label, renderer):
        self.label, self.renderer = label, renderer
        self.first = renderer.render(FEW, 1000)[1]
        self.few = renderer.render(FEW, 1001)[1]
        self.seconds, self.images = [], []

    def render(self, spp, seed):
        image, seconds = self.renderer.render(spp, seed)
        self.seconds.append((seconds - self.few) / (spp - FEW))
        self.images.append(blocks(image))
        return image, seconds

    def of_a_sample(self):
        return float(np.median(self.seconds))

    def start_up(self):
        return self.first - FEW * self.of_a_sample()


def measure(file, a, work):
    name = pathlib.Path(file).parent.name
    mitsuba = Timed("mitsuba", Mitsuba(spelled_for_mitsuba(file, work), work, a.scale))
    ours = [
        Timed(f"{program} {sampler or ''}".strip(), Penumbra(file, folder, sampler, work, a.scale, a.options))
        for program, folder in a.penumbra for sampler in a.sampler
    ]
    jobs = [mitsuba] + ours
    for k in range(a.rounds):
        for job in jobs:
            image, seconds = job.render(a.spp, 1 + k)
            if k == 0 and a.peer and job is mitsuba:
                os.makedirs(os.path.join(a.peer, name), exist_ok=True)
                mi.Bitmap(image).write(os.path.join(a.peer, name, f"{seconds:.3f}-seconds.exr"))
    mitsuba.renderer.end()
    pixels = image.shape[0] * image.shape[1]
    truth = np.mean([np.mean(job.images, 0) for job in jobs], 0)
    theirs, their_errors = mitsuba.of_a_sample(), errors(mitsuba.images, truth)
    their_means = np.mean(mitsuba.images, (1, 2, 3))
    rows = []
    for job in ours:
        mine, means = job.of_a_sample(), np.mean(job.images, (1, 2, 3))
        off = means.mean() - their_means.mean()
        sigma = np.sqrt((means.var(ddof=1) + their_means.var(ddof=1)) / a.rounds)
        rows.append(
            dict(scene=name,
                 program=job.label,
                 spp=a.spp,
                 speeds=[pixels * 1e-6 / mine, pixels * 1e-6 / theirs],
                 ratios=[theirs * e / (mine * o) for e, o in zip(their_errors, errors(job.images, truth))],
                 starts=[job.start_up(), mitsuba.start_up()],
                 means=[100 * off / their_means.mean(), off / sigma]))
    return rows


def line(r):
    mine, other = r["speeds"]
    return (f"| {r['scene']} | {r['program']} | {mine:.2f} | {other:.2f} | {mine / other:.2f} | " +
            " | ".join(f"{x:.2f}" for x in r["ratios"]) + " | {:.2f} | {:.2f} | ".format(*r["starts"]) +
            ("{:+.1f} %, {:+.1f} σ |".format(*r["means"]) if r["means"] else "|"))


def medians(rows, program):
    """Of all scenes, column by column."""
    rows = [r for r in rows if r["program"] == program]
    middle = {key: np.median([r[key] for r in rows], 0) for key in ("speeds", "ratios", "starts")}
    return dict(scene="**median**", program=program, means=None, **middle)


def program_of(text):
    """NAME=FOLDER, or FOLDER alone."""
    name, _, folder = text.rpartition("=")
    folder = os.path.abspath(folder)
    if not os.path.exists(os.path.join(folder, "penumbra")):
        raise argparse.ArgumentTypeError(f"{folder} holds no program penumbra; expected [NAME=]FOLDER")
    return name or os.path.basename(folder), folder


def main():
    if sys.argv[1:2] == ["--serve"]:
        return serve(sys.argv[2], float(sys.argv[3]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE.xml")
    parser.add_argument("--penumbra",
                        action="append",
                        type=program_of,
                        metavar="[NAME=]FOLDER",
                        help="with penumbra and penumbra-worker; repeatable (default: build/release)")
    parser.add_argument("--sampler",
                        action="append",
                        metavar="NAME",
                        help="of Penumbra; repeatable (default: its default)")
    parser.add_argument("--rounds", type=int, default=4, help="images of each, two or more (default: 4)")
    parser.add_argument("--spp", type=int, default=64, help=f"of each image, above {FEW} (default: 64)")
    parser.add_argument("--scale", type=float, default=0.25, help="of the film's width and height (default: 0.25)")
    parser.add_argument("--peer", metavar="DIR", help="also write Mitsuba's images for penumbra report --peer DIR")
    parser.add_argument("--json", metavar="FILE", help="also write all figures")
    parser.add_argument("--options", type=str.split, default=[], help="further options of penumbra render")
    a = parser.parse_args()
    if a.rounds < 2 or a.spp <= FEW:
        parser.error(f"--rounds must be 2 or more, and --spp above {FEW}")
    a.penumbra = a.penumbra or [program_of("build/release")]
    a.sampler = a.sampler or [None]
    mi.set_variant("scalar_rgb")
    print(
        "| scene | program | Msamples / s | Mitsuba's | ratio | error: mean | trimmed | median | start-up | Mitsuba's "
        "| means |"
        "\n|---|---|---|---|---|---|---|---|---|---|---|")
    everything = []
    for file in a.scenes:
        with tempfile.TemporaryDirectory() as work:
            rows = measure(os.path.abspath(file), a, work)
        everything += rows
        print("\n".join(line(r) for r in rows), flush=True)
        if a.json:
            with open(a.json, "w", encoding="utf-8") as out:
                json.dump(everything, out, indent=1)
    for program in dict.fromkeys(r["program"] for r in everything):
        print(line(medians(everything, program)))


if __name__ == "__main__":
    main()
