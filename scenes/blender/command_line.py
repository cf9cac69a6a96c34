# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports frames of a .blend file without a user: what `penumbra render shot.blend` runs.

    blender -b --factory-startup --python command_line.py -- shot.blend --out FOLDER --frames 1-250
    python command_line.py shot.blend --out FOLDER          (a Python that has bpy)

Without a file it is the one that Blender has open. Scripts within the file do not run. --result FILE gets a JSON object a
line: as soon as frame.NNNN.xml is there {"frame", "path", "fps", "report": what is left out so far}; at the end all "paths",
"report", "fps", "range" (first, last, step) and the version of "blender", or an "error".
Exit codes: 0 all done, 1 the export failed, 2 bad usage or bad input.
"""

import argparse
import difflib
import importlib
import json
import os
import pathlib
import re
import sys
import traceback
import types

OLDEST = (4, 2, 0)
EXPORT_FAILED, BAD_INPUT = 1, 2


class BadInput(Exception):
    """What the user can put right."""


def frames_of(text):
    """The frames of lists such as 300, 1-250, 1..250, 1-250x2 and 1-10,50-60, in their order."""
    frames = []
    for part in text.split(","):
        match = re.fullmatch(r"(\d+)(?:(?:-|\.\.)(\d+)(?:x([1-9]\d*))?)?", part)
        if match is None or (match[2] and int(match[2]) < int(match[1])):
            raise argparse.ArgumentTypeError(f"frames are numbers as in 300, 1-250, 1-250x2 or 1-10,50-60, not '{part}'")
        first = int(match[1])
        frames += range(first, int(match[2] or first) + 1, int(match[3] or 1))
    return frames


def parse_arguments(words):
    parser = argparse.ArgumentParser(prog="command_line.py", description="Exports frames of a .blend file for Penumbra.")
    parser.add_argument("file", nargs="?", help="a .blend file (default: the one that is open)")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the scenes that are written")
    parser.add_argument("--frames", type=frames_of, help="as in 1-250 or 1-250x2 (default: the file's current frame)")
    parser.add_argument("--scene", help="its name (default: the one that is open in the file)")
    parser.add_argument("--camera", help="name of an object (default: the scene's camera)")
    parser.add_argument("--view-layer", help="its name (default: the scene's first)")
    parser.add_argument("--texture-size", type=int, help="pixels on a side of baked textures (default: the scene's)")
    parser.add_argument("--result", type=pathlib.Path, help="file of the result, a JSON object a line")
    return parser.parse_args(words)


def one_of(names, name, kind, owner):
    """The name. BadInput: it is none of them; the message has the nearest ones."""
    if name in names:
        return name
    near = difflib.get_close_matches(name, names, n=3, cutoff=0.5)
    hint = f"; did you mean {' or '.join(repr(each) for each in near)}?" if near else "."
    listed = ", ".join(repr(each) for each in names) or "none"
    raise BadInput(f"{owner} has no {kind} {name!r}{hint} It has: {listed}")


def import_beside(name):
    """A module of this folder, as part of a package whose other modules, of the user interface, need not be there."""
    package = "penumbra_command_line"
    if package not in sys.modules:
        sys.modules[package] = types.ModuleType(package)
        sys.modules[package].__path__ = [str(pathlib.Path(__file__).resolve().parent)]
    return importlib.import_module(f"{package}.{name}")


def open_file(bpy, file):
    """Opens the file without the user's settings, and without its scripts and windows."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        bpy.ops.wm.open_mainfile(filepath=file, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise BadInput(f"Blender {bpy.app.version_string} cannot open it: {' '.join(str(error).split())}") from error


def report_file(bpy, report):
    """Adds what is not as the file's author saw it."""
    if bpy.app.autoexec_fail:
        report.add(f"scripts within the file do not run: {bpy.app.autoexec_fail_message}")
    if bpy.data.version[:2] > bpy.app.version[:2]:
        report.add("the file is of Blender {}.{}, newer than this one, {}.{}".format(*bpy.data.version[:2],
                                                                                     *bpy.app.version[:2]))
    for library in bpy.data.libraries:
        path = bpy.path.abspath(library.filepath, library=library.parent)
        if not pathlib.Path(path).is_file():
            report.add(f"the file that it links, {path}, is not there")


class Result:
    """The file of results; without one they are not written."""

    def __init__(self, path):
        self._file = open(path, "w", encoding="utf-8") if path is not None else None

    def add(self, **values):
        if self._file is not None:
            self._file.write(json.dumps(values) + "\n")
            self._file.flush()


def export(bpy, arguments, result):
    if arguments.file is not None:
        open_file(bpy, os.path.abspath(arguments.file))  # Blender takes PWD for the current folder
    properties = import_beside("properties")
    if not hasattr(bpy.types.Scene, "penumbra"):
        properties.register()
    report = import_beside("export.context").Report()
    report_file(bpy, report)

    scene = bpy.context.scene
    if arguments.scene is not None:
        scene = bpy.data.scenes[one_of(bpy.data.scenes.keys(), arguments.scene, "scene", "the file")]
    owner = f"the scene {scene.name!r}"
    cameras = [obj.name for obj in scene.objects if obj.type == "CAMERA"]
    if arguments.camera is not None:
        one_of(cameras, arguments.camera, "camera", owner)
    elif scene.camera is None and all(marker.camera is None for marker in scene.timeline_markers):
        raise BadInput(f"{owner} has no active camera; --camera NAME chooses one. It has: "
                       f"{', '.join(map(repr, cameras)) or 'none'}")
    if arguments.view_layer is not None:
        one_of(scene.view_layers.keys(), arguments.view_layer, "view layer", owner)
    beside = import_beside("command").options_beside_scene(properties.settings_of(scene))
    if beside:
        report.add(f"{owner} asks for {' '.join(beside)}, which only the command line can")
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
    frames = arguments.frames or [scene.frame_current]
    fps = scene.render.fps / scene.render.fps_base

    out = arguments.out.absolute()

    def progress(done, count):
        path = out / f"frame.{frames[done - 1]:04d}.xml"
        print(f"Penumbra: frame {frames[done - 1]}, {done} of {count}: {path}", flush=True)
        result.add(frame=frames[done - 1], path=str(path), fps=fps, report=report.lines)

    paths, report = import_beside("export.shot").export_shot(
        out, scene, frames, view_layer=arguments.view_layer, camera=arguments.camera,
        texture_size=arguments.texture_size or properties.settings_of(scene).texture_size, progress=progress,
        report=report)
    for line in report.lines:
        print(f"Penumbra: warning: {line}")
    result.add(paths=[str(path) for path in paths], report=report.lines, fps=fps,
               range=[scene.frame_start, scene.frame_end, scene.frame_step], blender=bpy.app.version_string)


def main(words):
    """Returns the exit code."""
    arguments = parse_arguments(words)
    result = Result(arguments.result)
    try:
        try:
            import bpy
        except ImportError as error:
            raise BadInput(f"{sys.executable} has no Blender (pip install bpy): {error}") from error
        if bpy.app.version < OLDEST:
            raise BadInput(f"Blender {bpy.app.version_string} is too old; 4.2 or newer would do")
        export(bpy, arguments, result)
    except BadInput as error:
        message, code = str(error), BAD_INPUT
    except Exception:
        message, code = "the export failed:\n" + traceback.format_exc().rstrip(), EXPORT_FAILED
    else:
        return 0
    print(f"Penumbra: error: {message}", file=sys.stderr, flush=True)
    result.add(error=message)
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]))
