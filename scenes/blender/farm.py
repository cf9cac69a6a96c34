# SPDX-License-Identifier: GPL-3.0-or-later
"""Sends shots to a farm, `penumbra serve`, and shows what becomes of them."""

import getpass
import json
import pathlib
import re
import socket
import tempfile
import threading

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from . import passes
from .command import farm_options, sampling_options
from .engine import disk_error_text
from .export.shot import export_shot
from .program import ProgramError, run
from .properties import settings_of

REFRESH_INTERVAL = 3.0  # seconds between looks at the farm while shots are under way
ANSWER_TIME = 20.0  # seconds that a farm may take to answer
RUNNING = {"queued", "rendering"}


def shot_name(scene):
    """The name of the scene's shots, fit for files."""
    name = settings_of(scene).farm_name or pathlib.Path(bpy.data.filepath).stem or "untitled"
    return re.sub(r"[^\w.-]+", "_", name)


def frames_text(frames):
    """Frames as `--frames` takes them."""
    if len(frames) > 1 and len(set(frames[i + 1] - frames[i] for i in range(len(frames) - 1))) == 1:
        step = frames[1] - frames[0]
        return f"{frames[0]}-{frames[-1]}" + (f"x{step}" if step > 1 else "")
    return ",".join(map(str, frames))


def send_shot(scene, view_layer, frames, name, progress=None):
    """Exports these frames of a view layer to a temporary folder, and submits them. Returns the number of the group,
    and the export's Report. Errors: ProgramError, and OSError of the folder."""
    settings = settings_of(scene)
    with tempfile.TemporaryDirectory(dir=bpy.app.tempdir or None, prefix="penumbra.shot.") as folder:
        paths, report = export_shot(folder, scene, frames, view_layer.name, texture_size=settings.texture_size,
                                    progress=progress)
        for path, frame in zip(paths, frames):  # the farm names the shot after its files
            path.rename(path.with_name(f"{name}.{frame:04d}.xml"))
        number = run(["submit", f"{folder}/{name}.####.xml", "--frames", frames_text(frames), "--quiet",
                      *shot_options(scene, view_layer), "-o", f"{name}.####.exr",
                      "--priority", str(settings.farm_priority), *farm_options(settings)])
    return int(number.split()[0]), report


def shot_options(scene, view_layer):
    """The options of `penumbra` that pictures of the shot depend on."""
    settings = settings_of(scene)
    options = sampling_options(settings)
    if scene.penumbra.animate_seed:
        options[options.index("--seed") + 1] = str(scene.penumbra.seed)
        options += ["--seed-per-frame", "frame"]
    chosen = passes.passes_of(view_layer, settings.denoise != "off")
    return options + passes.options_for(chosen)


def shots_of(status, submitter):
    """The user's groups and single jobs in `penumbra status --json`, the newest first: dictionaries with number, name,
    state, done (0 to 1), priority, text."""
    shots = []
    for group in status["groups"]:
        if group["submitter"] == submitter:
            states = ", ".join(f"{count} {state}" for state, count in group["jobs"].items() if count)
            shots.append({"number": group["group"], "name": group["name"], "state": group["state"],
                          "done": group["done"], "priority": group["priority"], "text": states})
    for job in status["jobs"]:
        if job["submitter"] == submitter and job["group"] is None:
            done = job["samples_done"] / job["samples_total"] if job["samples_total"] else 0.0
            shots.append({"number": job["job"], "name": job["name"], "state": job["state"], "done": done,
                          "priority": job["priority"], "text": job["error"] or ""})
    return sorted(shots, key=lambda shot: -shot["number"])


def this_user():
    """As whom `penumbra submit` sends jobs."""
    return f"{getpass.getuser()}@{socket.gethostname()}"


class PenumbraShot(bpy.types.PropertyGroup):
    """A row of the list."""

    number: IntProperty()
    state: StringProperty()
    done: FloatProperty()
    priority: IntProperty()
    text: StringProperty()


class PenumbraFarm(bpy.types.PropertyGroup):
    """What is known of the farm."""

    shots: CollectionProperty(type=PenumbraShot)
    active: IntProperty()
    problem: StringProperty()
    is_asked: BoolProperty()


def show(farm, shots):
    """Replaces the rows, keeping the chosen shot."""
    chosen = farm.shots[farm.active].number if farm.active < len(farm.shots) else None
    farm.shots.clear()
    for index, shot in enumerate(shots):
        row = farm.shots.add()
        row.name = shot["name"]
        for field in ("number", "state", "done", "priority", "text"):
            setattr(row, field, shot[field])
        if shot["number"] == chosen:
            farm.active = index
    farm.active = max(0, min(farm.active, len(farm.shots) - 1))


def refresh(scene):
    """Asks the farm, and shows its answer. Error: ProgramError."""
    farm = bpy.context.window_manager.penumbra_farm
    show(farm, _ask(settings_of(scene)))
    farm.problem = ""


def _ask(settings):
    answer = run(["status", "--json", *farm_options(settings)], ANSWER_TIME)
    return shots_of(json.loads(answer), this_user())


class _Watch:
    """Asks the farm again and again on a thread, while shots are under way."""

    def __init__(self):
        self._thread = None
        self._answer = None
        self._problem = ""

    def begin(self):
        if not bpy.app.background and not bpy.app.timers.is_registered(self._tick):
            bpy.app.timers.register(self._tick, first_interval=REFRESH_INTERVAL)

    def end(self):
        if bpy.app.timers.is_registered(self._tick):
            bpy.app.timers.unregister(self._tick)

    def _ask(self, settings):
        try:
            self._answer, self._problem = _ask(settings), ""
        except (ProgramError, ValueError) as error:
            self._answer, self._problem = None, str(error)

    def _tick(self):
        farm = bpy.context.window_manager.penumbra_farm
        if self._thread is not None and self._thread.is_alive():
            return REFRESH_INTERVAL
        if self._thread is not None:
            if self._answer is not None:
                show(farm, self._answer)
            farm.problem = self._problem
            for window in bpy.context.window_manager.windows:
                for area in window.screen.areas:
                    if area.type == "PROPERTIES":
                        area.tag_redraw()
        if self._thread is not None and not any(shot.state in RUNNING for shot in farm.shots):
            self._thread = None
            return None
        self._thread = threading.Thread(target=self._ask, args=(settings_of(bpy.context.scene),), daemon=True)
        self._thread.start()
        return REFRESH_INTERVAL


_watch = _Watch()


class _FarmOperator:
    """An operator that asks the farm for something, and then for its state."""

    def execute(self, context):
        try:
            self.act(context)
            refresh(context.scene)
        except ProgramError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        except OSError as error:
            self.report({"ERROR"}, disk_error_text(error))
            return {"CANCELLED"}
        _watch.begin()
        return {"FINISHED"}

    def act(self, context):
        """Nothing more than refreshing."""


class PENUMBRA_OT_send_to_farm(_FarmOperator, bpy.types.Operator):
    bl_idname = "penumbra.send_to_farm"
    bl_label = "Send to Farm"
    bl_description = "Export frames, and submit them to the service"

    animation: BoolProperty(name="Animation", description="All frames of the scene, instead of the current one",
                            default=True)

    def act(self, context):
        scene = context.scene
        if scene.camera is None:
            raise ProgramError("The scene has no camera.")
        frame = scene.frame_current
        frames = list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step)) if self.animation else [frame]
        if frames[0] < 0:
            raise ProgramError(f"A farm renders no frame below 0, and the shot begins at {frames[0]}.")
        refresh(scene)  # whether the farm answers, before minutes of exporting
        layers = [layer for layer in scene.view_layers if layer.use]
        manager = context.window_manager
        manager.progress_begin(0, len(frames) * len(layers))
        try:
            for index, layer in enumerate(layers):
                name = shot_name(scene) + (f".{layer.name}" if len(layers) > 1 else "")
                number, report = send_shot(scene, layer, frames, name, lambda done, count, before=index * len(frames):
                                           manager.progress_update(before + done))
                for line in report.lines:
                    self.report({"WARNING"}, f"Penumbra: {line}")
                self.report({"INFO"}, f"{name} is group {number} of the farm")
        finally:
            manager.progress_end()
            scene.frame_set(frame)


class PENUMBRA_OT_farm_refresh(_FarmOperator, bpy.types.Operator):
    bl_idname = "penumbra.farm_refresh"
    bl_label = "Refresh"
    bl_description = "Ask the farm for the state of the shots"


class _ShotOperator(_FarmOperator):
    """About the number, or the chosen shot."""

    number: IntProperty(name="Number", default=0, min=0, options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return bool(context.window_manager.penumbra_farm.shots)

    def arguments(self, context):
        farm = context.window_manager.penumbra_farm
        return [str(self.number or farm.shots[farm.active].number), *farm_options(settings_of(context.scene))]


class PENUMBRA_OT_farm_cancel(_ShotOperator, bpy.types.Operator):
    bl_idname = "penumbra.farm_cancel"
    bl_label = "Cancel"
    bl_description = "Cancel the shot; what is rendered of it is kept"

    def act(self, context):
        run(["cancel", *self.arguments(context)], ANSWER_TIME)


class PENUMBRA_OT_farm_fetch(_ShotOperator, bpy.types.Operator):
    bl_idname = "penumbra.farm_fetch"
    bl_label = "Fetch"
    bl_description = "Write the images of the shot to the folder of the scene's output"

    def act(self, context):
        folder = pathlib.Path(bpy.path.abspath(context.scene.render.filepath))
        folder = folder if folder.is_dir() else folder.parent
        run(["fetch", *self.arguments(context), "-o", folder])
        self.report({"INFO"}, f"The images are in {folder}")


CLASSES = [PenumbraShot, PenumbraFarm, PENUMBRA_OT_send_to_farm, PENUMBRA_OT_farm_refresh, PENUMBRA_OT_farm_cancel,
           PENUMBRA_OT_farm_fetch]


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.penumbra_farm = bpy.props.PointerProperty(type=PenumbraFarm)


def unregister():
    _watch.end()
    del bpy.types.WindowManager.penumbra_farm
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
