"""Measures Penumbra against Mitsuba 3 (llvm_ad_rgb) on Mitsuba scenes and prints a Markdown table.

Usage: python3 against_mitsuba.py [--penumbra FOLDER]... [--spp 16] [--seeds 4] [--images FOLDER] SCENE.xml...

Needs mitsuba, numpy and OpenEXR (pip). All renderers take turns in one run, with one thread each; times are user and
system seconds of the process, so that other work on the machine matters less. With several --penumbra folders, builds
are compared. With --images, Mitsuba's images go to FOLDER/SCENE/mitsuba/SECONDS-seconds.exr, for
`penumbra report SCENE --peer FOLDER/SCENE`.

Errors are variances between images of different seeds over (mean of all images)^2 + 0.01, of means of 4 x 4 pixels, so
that no bias of a reference counts. `median` is their median over the image, `mean` their mean, which a few paths
decide where caustics are. Means are compared by the mean over the image, in standard errors."""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

try:
    import numpy
    import OpenEXR
    import mitsuba
    mitsuba.set_variant("llvm_ad_rgb")
    import drjit
except ImportError as error:
    sys.exit(f"{error}; pip install mitsuba numpy OpenEXR")


def means_of_blocks(image):
    height, width = (size // 4 * 4 for size in image.shape[:2])
    return image[:height, :width].reshape(height // 4, 4, width // 4, 4, 3).mean((1, 3))


def cpu_seconds(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


class Mitsuba:
    """Start: reading the scene and compiling the kernel."""
    name = "Mitsuba"

    def __init__(self, scene, spp, images):
        begin = cpu_seconds(resource.RUSAGE_SELF)
        self.scene, self.spp, self.images = mitsuba.load_file(scene), spp, images
        first = self.timed(0)[1]
        self.start = cpu_seconds(resource.RUSAGE_SELF) - begin - min(first, self.timed(0)[1])

    def timed(self, seed):
        begin = cpu_seconds(resource.RUSAGE_SELF)
        image = mitsuba.render(self.scene, spp=self.spp, seed=seed).numpy()[:, :, :3]
        return image, cpu_seconds(resource.RUSAGE_SELF) - begin

    def render(self, seed):
        image, seconds = self.timed(seed)
        if self.images:
            os.makedirs(self.images, exist_ok=True)
            mitsuba.Bitmap(image).write(os.path.join(self.images, f"{seconds:.3f}-seconds.exr"))
        return image, seconds


class Penumbra:
    """Start: all that a render takes beside the samples: reading, building, processes, files."""

    def __init__(self, name, folder, scene, spp, options):
        self.name, self.folder, self.scene, self.spp, self.options = name, folder, scene, spp, options
        self.file = os.path.join(tempfile.mkdtemp(), "image.exr")
        self.start = min(self.whole(0, 1)[1] for _ in range(2))

    def whole(self, seed, spp):
        begin = cpu_seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([os.path.join(self.folder, "penumbra"), "render", self.scene, "-o", self.file, "--force",
                        "--spp", str(spp), "--seed", str(seed), "--threads", "1", "-q", "--no-features"] + self.options,
                       check=True, stderr=subprocess.DEVNULL)
        seconds = cpu_seconds(resource.RUSAGE_CHILDREN) - begin
        return OpenEXR.File(self.file).channels()["RGB"].pixels, seconds

    def render(self, seed):
        image, seconds = self.whole(seed, self.spp)
        return image, (seconds - self.start) * self.spp / (self.spp - 1)


def measure(renderers, seeds):
    """Images and seconds of all renderers, which take turns."""
    images, seconds = ([[] for _ in renderers] for _ in range(2))
    for seed in range(1, seeds + 1):
        for i, renderer in enumerate(renderers):
            image, time = renderer.render(seed)
            images[i].append(means_of_blocks(numpy.asarray(image, dtype=numpy.float64)))
            seconds[i].append(time)
    return [numpy.stack(each) for each in images], [float(numpy.median(each)) for each in seconds]


def row(name, label, peer, own, truth, samples):
    """peer, own: (images, seconds, start)."""
    def errors(images):
        relative = images.var(0, ddof=1) / (truth**2 + 0.01)
        return numpy.array([relative.mean(), numpy.median(relative)])

    by_mean, by_median = errors(peer[0]) * peer[1] / (errors(own[0]) * own[1])
    of_images = [images.mean((1, 2, 3)) for images in (peer[0], own[0])]
    noise = numpy.sqrt(sum(x.var(ddof=1) / len(x) for x in of_images))
    apart = of_images[1].mean() - of_images[0].mean()
    rates = [samples / seconds * 1e-6 for seconds in (peer[1], own[1])]
    print(f"| {name} | {label} | {rates[0]:.2f}, {rates[1]:.2f} | {rates[1] / rates[0]:.2f} | {by_mean:.2f} | "
          f"{by_median:.2f} | {peer[2]:.2f}, {own[2]:.2f} | {100 * apart / of_images[0].mean():+.2f} % "
          f"({apart / max(noise, 1e-12):+.1f} σ) |", flush=True)
    return rates[1] / rates[0], by_mean, by_median


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--penumbra", action="append", help="folder of a build (default: build/release)")
    parser.add_argument("--option", action="append", default=[], help="an option for penumbra render")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--images")
    parser.add_argument("scenes", nargs="+")
    arguments = parser.parse_args()
    builds = arguments.penumbra or ["build/release"]
    drjit.set_thread_count(1)
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    print("| scene | build | million samples per second: Mitsuba, Penumbra | ratio | time to equal error, mean | median "
          "| start | mean image |\n|---|---|---|---|---|---|---|---|")
    ratios = [[] for _ in builds]
    for scene in arguments.scenes:
        name = os.path.splitext(os.path.basename(scene))[0]
        folder = arguments.images and os.path.join(arguments.images, name, "mitsuba")
        renderers = [Mitsuba(scene, arguments.spp, folder)]
        for build in builds:
            renderers.append(Penumbra(build, build, scene, arguments.spp, arguments.option))
        images, seconds = measure(renderers, arguments.seeds)
        truth = numpy.concatenate(images).mean(0)
        samples = truth.shape[0] * truth.shape[1] * 16 * arguments.spp
        results = list(zip(images, seconds, (renderer.start for renderer in renderers)))
        for i, build in enumerate(builds):
            ratios[i].append(row(name, build, results[0], results[1 + i], truth, samples))
    for build, of_build in zip(builds, ratios):
        print(f"{build}: medians over the scenes " + json.dumps(numpy.median(of_build, 0).round(2).tolist()))


if __name__ == "__main__":
    main()
