"""Renders with a scheduler and workers of its own for each call."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from . import images
from .errors import RenderError, UsageError, error_of, messages_of
from .options import of_command, with_device, words
from .program import Finished, Running, answer
from .progress import Progress, Reporter
from .result import Result
from .scenes import write_scene

Scene = Union[str, "os.PathLike[str]", Mapping[str, Any]]

GENERAL = {"help", "help_all", "quiet", "progress", "json"}  # what this package itself decides
SETS = {"frames", "order", "video", "no_contact_sheet", "force", "summary", "table"}
OWN_FUNCTIONS = {"estimate", "pixel"}


def render_keywords() -> set[str]:
    """Options of one render."""
    return set(of_command("render")) - GENERAL - SETS - OWN_FUNCTIONS


def render_all_keywords() -> set[str]:
    """Options of several renders."""
    return set(of_command("render")) - GENERAL - OWN_FUNCTIONS - {"statistics"}


@contextlib.contextmanager
def scene_file(scene: Scene, name: str = "scene") -> Iterator[Path]:
    """The file of a scene; a dict is written into a temporary folder."""
    if isinstance(scene, Mapping):
        with tempfile.TemporaryDirectory(prefix="penumbra-scene-") as folder:
            yield write_scene(scene, folder, name)
    elif isinstance(scene, (str, os.PathLike)):
        yield images.no_option(Path(scene))
    else:
        raise UsageError(f"a scene is a file or a dict, not {type(scene).__name__}")


def run_render(arguments: Sequence[str | os.PathLike[str]], progress: Progress) -> Finished:
    """Runs `penumbra render`, and shows its progress."""
    reporter = Reporter(progress)
    try:
        quiet = ["--progress=json"] if reporter.is_needed else []
        running = Running(["render", *arguments, "--quiet", *quiet], on_line=reporter.line if quiet else None)
        finished = running.wait(still_needed=reporter.check)
    finally:
        reporter.close()
    return finished


def result_of(finished: Finished, statistics: Path, files: Sequence[Path] = (), keep: object = None) -> Result:
    """The result of a render that ended. Raises its error; what was written nevertheless is the error's `result`."""
    if finished.code not in (0, 1):
        raise error_of(finished.code, finished.err)
    told: dict[str, Any] = json.loads(statistics.read_text()) if statistics.exists() else {}
    written = [Path(file) for file in told.get("files", files)]
    if finished.code == 1 and not (finished.interrupted and written):
        error = error_of(finished.code, finished.err)
        if finished.interrupted:
            raise KeyboardInterrupt
        if isinstance(error, RenderError) and written:
            error.result = Result(written, told, messages_of(finished.err), keep=keep)
        raise error
    return Result(written, told, messages_of(finished.err), interrupted=finished.interrupted, keep=keep)


def render(scene: Scene, *, progress: Progress = None, **options: Any) -> Result:
    """Renders one image.

    `scene`: a file of any format, or a dict (see write_scene). `settings`: a dict of what `penumbra settings` lists;
    `defines`: one of values for the file's $names. `device`: "native", "opencl", "opencl:NAME" or "auto". `progress`:
    see Reporter. Files are temporary unless `out` is given.

    Ctrl-C ends the render and returns what is there (`interrupted`); a second one raises KeyboardInterrupt. Raises
    SceneError, UsageError, RenderError (whose `result` is what was written all the same) or ProgramError.
    """
    options = with_device(dict(options))
    kept = tempfile.TemporaryDirectory(prefix="penumbra-")
    folder = Path(kept.name)
    statistics = folder / "statistics.json"
    asked = options.pop("statistics", None)
    beside = not options.pop("no_statistics", False)
    out = options.pop("out", None)
    arguments: list[str | os.PathLike[str]] = [*words("render", options, render_keywords())]
    with scene_file(scene) as file:
        name = re.sub(r"[^\w.-]", "_", file.stem) or "image"
        arguments += ["--out", out if out is not None else folder / f"{name}.exr", "--statistics", statistics]
        finished = run_render([file, *arguments], progress)
    result = result_of(finished, statistics, keep=kept)
    if asked is not None:
        shutil.copyfile(statistics, asked)
    elif out is not None and beside and result.files:
        shutil.copyfile(statistics, result.files[0].with_suffix(".json"))
    return result


def render_all(scenes: Scene | Sequence[Scene], *, progress: Progress = None, **options: Any) -> list[Result]:
    """Renders several scenes, the renders of a job file, or frames (`frames=range(1, 251)`), with the same workers.

    `out` is their folder, or a name with fields; temporary without. Those that are there already are kept. Raises
    RenderError if one fails: its `results` are the others, its `messages` say why.
    """
    options = with_device(dict(options))
    kept = tempfile.TemporaryDirectory(prefix="penumbra-")
    folder = Path(kept.name)
    several = [scenes] if isinstance(scenes, (str, os.PathLike, Mapping)) else list(scenes)
    summary = Path(options.pop("summary", None) or folder / "jobs.json")
    out = options.pop("out", None)
    if out is None and not any(str(scene).endswith(".toml") for scene in several):
        out = folder / ("{frame:04}.exr" if options.get("frames") is not None and len(several) == 1 else "")
    arguments = words("render", options, render_all_keywords())
    with contextlib.ExitStack() as files:
        paths = [files.enter_context(scene_file(scene, f"scene-{i}")) for i, scene in enumerate(several)]
        output = [] if out is None else ["--out", f"{os.fspath(out)}{'/' if out == folder else ''}"]
        finished = run_render([*paths, *arguments, *output, "--summary", summary], progress)
    if finished.code not in (0, 1) or not summary.exists():
        raise error_of(finished.code, finished.err)
    jobs = json.loads(summary.read_text())["jobs"]
    results = [
        _result_of_job(job, summary.parent, kept) for job in jobs if job["state"] in ("done", "unchanged", "incomplete")
    ]
    if finished.code != 0 and not finished.interrupted:
        error = error_of(finished.code, finished.err)
        if isinstance(error, RenderError):
            error.results = results
        raise error
    return results


def _result_of_job(job: Mapping[str, Any], folder: Path, keep: object) -> Result:
    files = [folder / file for file in job["files"]]
    statistics = next((file for file in files if file.suffix == ".json"), None)
    told = json.loads(statistics.read_text()) if statistics and statistics.exists() else {}
    pictures = [file for file in files if file.suffix in (".exr", ".png")]
    return Result(pictures, told, keep=keep, interrupted=told.get("ended_by") == "interrupt")


def estimate(scene: Scene, **options: Any) -> dict[str, Any]:
    """What a render would take: core and wall time, memory, error. Renders for about ten seconds; writes nothing."""
    options = with_device(dict(options))
    with scene_file(scene) as file:
        found = answer(
            ["render", file, *words("render", options, render_keywords()), "--estimate", "--json", "--quiet"]
        )
    told: dict[str, Any] = json.loads(found.out)
    return told


def pixel(scene: Scene, x: int, y: int, **options: Any) -> dict[str, Any]:
    """One pixel with all its digits: `samples`, and tuples of numbers: `radiance`, `standard error`, layers."""
    options = with_device(dict(options))
    with scene_file(scene) as file:
        arguments = words("render", {**options, "pixel": (x, y)}, render_keywords() | {"pixel"})
        lines = answer(["render", file, *arguments, "--quiet"]).out.splitlines()
    found: dict[str, Any] = {}
    for line in lines:
        match = re.match(r"(\S+(?: \S+)*?)\s{2,}(\S.*)$", line)
        if line.startswith("pixel"):
            found["samples"] = int(re.search(r"(\d+) samples?", line)[1])  # type: ignore[index]
        elif match and match[1] == "exactly":
            found["radiance"] = tuple(map(float.fromhex, match[2].split()))
        elif match:
            found[match[1]] = tuple(map(float, match[2].split()))
    return found
