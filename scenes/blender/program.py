# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the program `penumbra` and runs it beside Blender."""

import atexit
import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time
import weakref

NAME = "penumbra"
# Where programs are installed that desktops start without a shell's PATH.
USUAL_FOLDERS = [pathlib.Path("/usr/local/bin"), pathlib.Path("/opt/penumbra/bin"), pathlib.Path.home() / ".local/bin"]
ANCESTORS = 4  # of this folder that may be the root of an installation, with the program in bin/
LINES_KEPT = 40  # of what a program says


class ProgramError(Exception):
    """What went wrong and what to do, for the user."""


def preferences():
    """The extension's preferences; None where it is not enabled."""
    import bpy
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences if addon is not None else None


def find_program():
    """The path of `penumbra`: of the preferences, of the environment's PENUMBRA, in PATH, beside this extension."""
    chosen = getattr(preferences(), "program", "")
    for source, value in (("the field Program in the extension's preferences", chosen),
                          ("the environment variable PENUMBRA", os.environ.get("PENUMBRA", ""))):
        if value:
            path = pathlib.Path(value).expanduser()
            path = path / NAME if path.is_dir() else path
            if not os.access(path, os.X_OK):
                raise ProgramError(f"There is no program {path}. It is what {source} says; it would be {NAME} of an "
                                   "installation of Penumbra.")
            return path
    in_path = shutil.which(NAME)
    if in_path:
        return pathlib.Path(in_path)
    roots = list(pathlib.Path(__file__).resolve().parents)[:ANCESTORS + 1]
    for path in [root / "bin" / NAME for root in roots] + [folder / NAME for folder in USUAL_FOLDERS]:
        if os.access(path, os.X_OK):
            return path
    raise ProgramError(f"The program {NAME} is not found. Install Penumbra, and choose the program in the preferences: "
                       "Edit > Preferences > Add-ons > Penumbra.")


def version_of(program):
    """The program's version, such as "0.1.0". Error: it does not run."""
    try:
        ran = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=20, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ProgramError(f"{program} does not run: {error}.") from error
    words = ran.stdout.split()
    if ran.returncode != 0 or words[:1] != [NAME] or len(words) < 2:
        said = (ran.stderr or ran.stdout).strip().splitlines()
        raise ProgramError(f"{program} is not a Penumbra that runs here: {said[0] if said else ran.returncode}.")
    return words[1]


def run(arguments, timeout=None):
    """Runs a short command of `penumbra`, such as ["status", "--json"]. Returns its stdout. Error: what it says."""
    program = find_program()
    try:
        ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=timeout,
                             stdin=subprocess.DEVNULL, check=False)
    except subprocess.TimeoutExpired as error:
        raise ProgramError(f"penumbra {arguments[0]}: no answer in {timeout:g} s.") from error
    except OSError as error:
        raise ProgramError(f"{program} does not run: {error}.") from error
    if ran.returncode != 0:
        raise ProgramError(ran.stderr.strip() or f"penumbra {arguments[0]} ended with {ran.returncode}.")
    return ran.stdout


_running = weakref.WeakSet()


@atexit.register
def _end_all():
    """A Blender that ends leaves no renderer behind."""
    for process in list(_running):
        process.kill()


class Process:
    """A `penumbra` that runs, in a process group of its own, so that Ctrl-C in Blender's terminal does not reach it."""

    def __init__(self, arguments, folder=None):
        """Error: it cannot be started."""
        program = find_program()
        # The program ends when Blender, which holds the other end, does, even if that crashes.
        pipe, self._owner_pipe = os.pipe()
        try:
            self._process = subprocess.Popen(
                [program, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True, cwd=folder,
                pass_fds=[pipe], env={**os.environ, "PENUMBRA_OWNER_PIPE": str(pipe)})
        except OSError as error:
            os.close(self._owner_pipe)
            raise ProgramError(f"{program} does not run: {error}.") from error
        finally:
            os.close(pipe)
        _running.add(self)
        self._lock = threading.Lock()
        self._progress = {}
        self._said = collections.deque(maxlen=LINES_KEPT)
        self._readers = [threading.Thread(target=reader, daemon=True)
                         for reader in (self._read_progress, self._read_messages)]
        for reader in self._readers:
            reader.start()

    def _read_progress(self):
        for line in self._process.stdout:
            try:
                progress = json.loads(line)
            except ValueError:
                continue
            with self._lock:
                self._progress = progress

    def _read_messages(self):
        for line in self._process.stderr:
            with self._lock:
                self._said.append(line.rstrip())

    @property
    def progress(self):
        """The newest line of `--progress json`; empty before the first."""
        with self._lock:
            return self._progress

    def code(self):
        """The exit code, negative for a signal; None while it runs."""
        return self._process.poll()

    def wait(self, seconds):
        """Whether it has ended within this time."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def stop(self, grace):
        """Asks it to write what it has; kills it, with its workers, after `grace` seconds."""
        if self.code() is None:
            self._process.send_signal(signal.SIGINT)
            self.wait(grace)
        self.kill()

    def kill(self):
        """Ends it at once, with its workers. Does nothing more where they have ended."""
        try:
            os.killpg(self._process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self._process.wait()
        self._join()
        if self._owner_pipe is not None:
            os.close(self._owner_pipe)
            self._owner_pipe = None

    def _join(self):
        for reader in self._readers:
            reader.join(timeout=2)
        for pipe, reader in zip((self._process.stdout, self._process.stderr), self._readers):
            if not reader.is_alive():
                pipe.close()

    def messages(self):
        """The last lines that it has said."""
        if self.code() is not None:
            self._join()
        with self._lock:
            return list(self._said)

    def failure(self):
        """Why it has failed, in one text for the user."""
        code = self.code()
        if code is not None and code < 0:
            return (f"The renderer was killed ({signal.Signals(-code).name}). Perhaps the memory was full; smaller "
                    "textures or meshes, or fewer workers, take less.")
        lines = self.messages()
        errors = [line for line in lines if "error" in line]
        return "\n".join(errors or lines[-3:]) or f"The renderer ended with exit code {code}."


def wait_until(is_true, seconds, interval=0.02):
    """Whether it has become true within this time."""
    deadline = time.monotonic() + seconds
    while not is_true():
        if time.monotonic() > deadline:
            return False
        time.sleep(interval)
    return True
