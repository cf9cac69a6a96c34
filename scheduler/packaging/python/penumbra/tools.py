"""Commands on scenes and images: info, compare, denoise, merge, report."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import images
from .errors import error_of
from .options import of_command, with_device, words
from .program import answer, run
from .rendering import Scene, scene_file
from .result import Image, read


def keywords_of(command: str, *without: str) -> set[str]:
    """Options of a command, without those that its function has itself."""
    return set(of_command(command)) - {"help", "json", "quiet", *without}


def info(scene: Scene, **options: Any) -> dict[str, Any]:
    """What a scene holds: `shapes`, `triangles`, `lights`, `film`, `settings`, `needs`, `left_out`, `costs`, …"""
    with scene_file(scene) as file:
        told: dict[str, Any] = json.loads(
            answer(["info", file, "--json", *words("info", options, keywords_of("info"))]).out
        )
    return told


def compare(image: Any, reference: Any, **options: Any) -> dict[str, Any]:
    """The error of an image against a reference of the same size: `bias`, `mse`, `relmse`, `flip`, z-test, ….

    Images are files, results, or arrays of the shape (height, width, 3). With limits (`fail_above`, `tolerance`,
    `z_test`) `passed` says whether they hold.
    """
    with tempfile.TemporaryDirectory(prefix="penumbra-") as folder:
        files = [
            images.path_of(each, Path(folder), name) for each, name in ((image, "image"), (reference, "reference"))
        ]
        for name in ("second_reference", "variance", "reference_variance"):
            if options.get(name) is not None:
                options[name] = images.path_of(options[name], Path(folder), name)
        measured = run(["compare", *files, "--json=-", *words("compare", options, keywords_of("compare"))])
    if measured.code not in (0, 1) or not measured.out.startswith("{"):
        raise error_of(measured.code, measured.err)
    return {**json.loads(measured.out), "passed": measured.code == 0}


def denoise(image: Any, *, variance: Any = None, **options: Any) -> Image:
    """A denoised image. `image` is a file, a result (best of a render with denoise="layers"), or an array, of which
    `variance` may be given. Raises as render does."""
    kept = tempfile.TemporaryDirectory(prefix="penumbra-")
    out = options.pop("out", None) or Path(kept.name) / "denoised.exr"
    options = with_device(dict(options))
    if variance is not None:
        path = Path(kept.name) / "image.exr"
        images.write(path, image, {"variance": variance})
    else:
        path = images.path_of(image, Path(kept.name), "image")
    answer(["denoise", path, "--out", out, *words("denoise", options, keywords_of("denoise", "out"))])
    return Image(Path(out), keep=kept)


def merge(several: Sequence[Any], out: str | os.PathLike[str] | None = None, **options: Any) -> Image:
    """The image of all samples of renders of a scene with other seeds: files or results."""
    kept = tempfile.TemporaryDirectory(prefix="penumbra-")
    path = Path(out) if out is not None else Path(kept.name) / "merged.exr"
    files = [images.path_of(each, Path(kept.name), str(i)) for i, each in enumerate(several)]
    answer(["merge", *files, "--out", path, *words("merge", options, keywords_of("merge", "out"))])
    merged = read(path)
    merged._keep = kept
    return merged


def report(scenes: Scene | Sequence[Scene], out: str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """Error against run time of methods: renders, and writes `out`/index.html. Returns its report.json.

    `integrator`: one or a list: "path", "cv=path:nee=cv", ….
    """
    several = [scenes] if isinstance(scenes, (str, os.PathLike)) else scenes
    arguments = words("report", options, keywords_of("report", "out"))
    answer(["report", *map(str, several), "--out", out, "--quiet", *arguments])
    told: dict[str, Any] = json.loads((Path(out) / "report.json").read_text())
    return told
