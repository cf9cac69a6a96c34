"""A private service for many renders: workers, scenes and compiled kernels stay between them."""

from __future__ import annotations

import json
import os
import queue
import tempfile
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import ProgramError, error_of
from .options import words
from .program import Finished, Running
from .progress import Progress
from .rendering import Scene
from .result import Result
from .service import Service

_SECONDS_TO_START = 60.0
_SECONDS_BETWEEN_LOOKS = 0.1


class _Submitter:
    """One `penumbra submit --lines`, which keeps scenes in memory, for all submissions to an address."""

    def __init__(self, address: str):
        self._address = address
        self._lock = threading.Lock()
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._running: Running | None = None

    def submit(self, words: list[Any], is_needed: Callable[[], bool]) -> Finished:
        """Of what `penumbra submit --quiet` would print. It is ended, and started anew by the next call, where this
        one is interrupted."""
        line = [os.fspath(word) for word in words]
        with self._lock:
            try:
                answer = json.loads(self._answer(json.dumps(line), is_needed))
            except BaseException:
                self._end()
                raise
        return Finished(line, answer["exit_code"], str(answer["number"]), answer["messages"])

    def _answer(self, line: str, is_needed: Callable[[], bool]) -> str:
        if self._running is None:
            words = ["submit", "--lines", "--to", self._address]
            self._answers = queue.SimpleQueue()
            self._running = Running(words, on_line=self._answers.put, reads_input=True)
        try:
            self._running.write(line)
        except BrokenPipeError:
            pass  # it has ended
        while True:
            try:
                return self._answers.get(timeout=_SECONDS_BETWEEN_LOOKS)
            except queue.Empty:
                if not (self._running.is_running and is_needed()):
                    raise ProgramError(f"penumbra submit ended: {self._running.said.strip() or 'killed'}") from None

    def _end(self) -> None:
        if self._running is not None:
            self._running.end(0)
            self._running = None

    def end(self) -> None:
        with self._lock:
            self._end()


def _end(submitter: _Submitter, running: Running, folder: tempfile.TemporaryDirectory[str]) -> None:
    submitter.end()
    running.end()
    folder.cleanup()


class Session(Service):
    """`with penumbra.Session(workers=2) as session: session.render(…)`.

    It ends, and its processes with it, with close(), at the end of `with`, of the last reference or of Python.
    `workers`: worker processes; `threads`: of each, by default all cores together. A worker that dies is started anew.
    Without workers (0) those of other terminals help: `penumbra worker --connect ADDRESS`, of its `address`. If the
    service dies, calls raise ProgramError.
    """

    def __init__(self, workers: int = 1, *, threads: int | None = None):
        folder = tempfile.TemporaryDirectory(prefix="penumbra-session-")
        super().__init__(f"unix:{folder.name}/socket")
        arguments = words(
            "serve",
            {
                "workers": workers,
                "threads": threads,
                "spool": f"{folder.name}/spool",
                "listen": self.address,
                "checkpoint_interval": 0,
            },
        )
        self._running = Running(["serve", *arguments])
        self._submitter = _Submitter(self.address)
        self._finalizer = weakref.finalize(self, _end, self._submitter, self._running, folder)
        until = time.monotonic() + _SECONDS_TO_START
        try:
            while not (Path(folder.name) / "socket").exists():
                if not self._running.is_running:
                    finished = self._running.wait()
                    raise error_of(finished.code or 1, finished.err)
                if time.monotonic() > until:
                    raise ProgramError(f"the service did not start: {self._running.said}")
                time.sleep(0.005)
        except BaseException:
            self.close()
            raise

    def render(self, scene: Scene, *, progress: Progress = None, **options: Any) -> Result:
        """Renders one image as render does, with the session's workers. `out`, `workers` and what else belongs to a
        process of its own are no options here."""
        return self.submit(scene, **options).fetch(progress=progress, remove=True)

    def close(self) -> None:
        """Ends its processes, and removes its jobs."""
        self._finalizer()

    def _is_there(self) -> bool:
        return self._running.is_running

    def _submit(self, words: list[Any]) -> Finished:
        self._check_open()
        finished = self._submitter.submit(words, self._is_there)
        self._check_there(finished)
        if finished.code != 0:
            raise error_of(finished.code, finished.err, of_input=True)
        return finished

    def _run(self, *arguments: Any) -> Finished:
        self._check_open()
        finished = super()._run(*arguments)
        self._check_there(finished)
        return finished

    def _check_open(self) -> None:
        if not self._finalizer.alive:
            raise ProgramError("the session is closed")

    def _check_there(self, finished: Finished) -> None:
        if finished.code != 0 and not self._is_there():
            raise ProgramError(f"the session's service ended: {self._running.said.strip() or 'it was killed'}")

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
