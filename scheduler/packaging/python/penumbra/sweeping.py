"""Sets of renders: all combinations of some values, as a table."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Union

from .errors import UsageError, error_of
from .options import of_command, text_of, unknown, with_device, words
from .progress import Progress
from .rendering import Scene, render_all_keywords, render_keywords, run_render
from .scenes import write_scene

Repeat = Union[int, Iterable[int], None]


def _toml(value: Any) -> str:
    return json.dumps(text_of(value), ensure_ascii=False)


def _axes(axes: Mapping[str, Any]) -> dict[str, list[Any]]:
    """The lines of a job file for these axes: options, settings as "integrator.max_depth", and `defines`."""
    lines: dict[str, list[Any]] = {}
    known = render_keywords()
    for name, values in axes.items():
        if name in ("defines", "settings"):
            prefix = "define." if name == "defines" else "set."
            lines |= {prefix + each: list(of) for each, of in values.items()}
        elif "." in name:
            lines["set." + name] = list(values)
        elif name in known:
            lines[of_command("render")[name].name.lstrip("-").replace("-", "_")] = list(values)
        else:
            raise unknown("option of render", name, known)
    for name, values in lines.items():
        if not values or not re.fullmatch(r"[\w.-]+", name):
            raise UsageError(f"{name} has no values" if not values else f"'{name}' is no name of an axis")
    return lines


def sweep(
    scene: Scene,
    axes: Mapping[str, Any],
    *,
    repeat: Repeat = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
    **options: Any,
) -> Any:
    """Renders all combinations, with the same workers.

    `axes`: lists of values by the names of options ("spp", "integrator"), of settings ("integrator.max_depth"), and
    below "defines" of the file's $names. `repeat`: that many seeds from 0 on, or these. `options` are those of every
    render. Returns a row for each render, with the values, `state`, `seconds`, `relative_error`, `samples_per_pixel`,
    `error` and `file` (see read): a pandas.DataFrame where there is pandas, else a list of dicts.

    `out`: a folder of the images and of sweep.toml, a job file; what is there already is not rendered again, so that
    the same call continues an interrupted sweep. Without, images are removed at the end. A render that fails is a row
    whose `state` is "failed".
    """
    lines = _axes(
        {**axes, **({} if repeat is None else {"seed": range(repeat) if isinstance(repeat, int) else repeat})}
    )
    settings, defines = options.pop("settings", {}), options.pop("defines", {})
    arguments = words("render", with_device(dict(options)), render_all_keywords() - {"out", "summary"})
    arguments += words("render", {"settings": settings, "defines": defines})
    with tempfile.TemporaryDirectory(prefix="penumbra-sweep-") as temporary:
        folder = Path(out if out is not None else temporary).absolute()
        folder.mkdir(parents=True, exist_ok=True)
        file = write_scene(scene, folder / "scene") if isinstance(scene, Mapping) else Path(scene)
        name = "-".join("{" + re.sub(r"^(define|set)\.", "", each) + "}" for each in lines) or "image"
        text = f"[[render]]\nscene = {_toml(file.absolute())}\nout = {_toml(f'{name}.exr')}\n"
        text += "".join(f"{each} = [{', '.join(map(_toml, values))}]\n" for each, values in lines.items())
        (folder / "sweep.toml").write_text(text)
        finished = run_render([folder / "sweep.toml", *arguments, "--out", f"{folder}/"], progress)
        summary = folder / "sweep.jobs.json"
        if finished.code not in (0, 1) or not summary.exists():
            raise error_of(finished.code, finished.err)
        jobs = json.loads(summary.read_text())["jobs"]
        rows = [_row(job, lines, folder if out is not None else None) for job in jobs]
    try:
        import pandas  # type: ignore[import-untyped, unused-ignore]
    except ImportError:
        return rows
    return pandas.DataFrame(rows)


def _row(job: Mapping[str, Any], lines: Mapping[str, list[Any]], folder: Path | None) -> dict[str, Any]:
    row: dict[str, Any] = {}
    for line, values in lines.items():
        name = re.sub(r"^(define|set)\.", "", line)
        told = job["options"].get(name)
        # Of an axis with one value the summary says nothing.
        row[name] = next((value for value in values if text_of(value) == told), values[0] if told is None else told)
    for name in ("state", "seconds", "relative_error", "samples_per_pixel", "error"):
        row[name] = job.get(name)
    images = [file for file in job["files"] if file.endswith(".exr")]
    row["file"] = str(folder / images[0]) if images and folder is not None else None
    return row
