"""A private service for many renders: workers, scenes and compiled kernels stay between them."""

from __future__ import annotations

import tempfile
import time
import weakref
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


def _end(running: Running, folder: tempfile.TemporaryDirectory[str]) -> None:
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
        self._finalizer = weakref.finalize(self, _end, self._running, folder)
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

    def _run(self, *arguments: Any) -> Finished:
        if not self._finalizer.alive:
            raise ProgramError("the session is closed")
        finished = super()._run(*arguments)
        if finished.code != 0 and not self._is_there():
            raise ProgramError(f"the session's service ended: {self._running.said.strip() or 'it was killed'}")
        return finished

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
