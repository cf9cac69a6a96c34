"""A client of `penumbra serve`, which may be on another machine."""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .errors import Message, error_of, messages_of
from .options import of_command, with_device, words
from .program import Finished, Running
from .progress import Progress, Reporter
from .rendering import GENERAL, Scene, result_of, scene_file
from .result import Result

_SECONDS_BETWEEN_STATES = 0.2


def submit_keywords() -> set[str]:
    """Options of a submitted render."""
    return set(of_command("submit")) - GENERAL - {"to", "keys", "out", "frames", "order", "priority", "lines"}


class Job:
    """A job of a service."""

    def __init__(self, service: Service, number: int, warnings: Sequence[Message] = ()):
        self.number = number
        self._service, self._warnings = service, list(warnings)

    def state(self) -> dict[str, Any]:
        """`state` (queued, rendering, done, incomplete, failed, cancelled), `samples_done`, `error`, …"""
        return next(job for job in self._service.status(self.number)["jobs"] if job["job"] == self.number)

    def cancel(self) -> None:
        """Ends it; what is rendered is kept."""
        self._service._call(["cancel", str(self.number)])

    def fetch(self, *, progress: Progress = None, remove: bool = False) -> Result:
        """Waits until it is over, and fetches its images. `remove`: from the service. Ctrl-C cancels the job, and
        fetches what there is."""
        kept = tempfile.TemporaryDirectory(prefix="penumbra-")
        words = ["fetch", str(self.number), "--wait", "--out", kept.name] + (["--remove"] if remove else [])
        reporter = Reporter(progress)
        interrupted = False
        try:
            try:
                if reporter.is_needed:
                    self._watch(reporter)
                finished = self._service._run(words, reporter.check)
                interrupted = finished.interrupted
            except KeyboardInterrupt:
                interrupted = True
            if interrupted:
                self.cancel()
                finished = self._service._run(words)
        finally:
            reporter.close()
        finished.interrupted = interrupted
        files = sorted(map(Path, finished.out.splitlines()), key=lambda file: "-denoised" in file.name)
        statistics = next((file for file in files if file.suffix == ".json"), Path(kept.name) / "statistics.json")
        return self._result(finished, statistics, [file for file in files if file.suffix != ".json"], kept)

    def _result(self, finished: Finished, statistics: Path, files: list[Path], kept: object) -> Result:
        if statistics.exists():
            told = json.loads(statistics.read_text())
            told["files"] = [str(file) for file in files]  # of here, not of the service
            statistics.write_text(json.dumps(told))
        result = result_of(finished, statistics, files, kept)
        result.warnings = self._warnings + result.warnings
        return result

    def _watch(self, reporter: Reporter) -> None:
        """Reports its progress until it is over."""
        while reporter.check():
            state = self.state()
            if state["samples_total"]:
                reporter.update({"seconds": state["elapsed_seconds"], "workers": None, "notices": [], **state})
            if state["state"] not in ("queued", "rendering"):
                return
            time.sleep(_SECONDS_BETWEEN_STATES)

    def __repr__(self) -> str:
        return f"<Job {self.number} of {self._service.address}>"


class Service:
    """The service at an address: "unix:/path", or "HOST:PORT" with `token` or the folder `keys`.

    Every call raises ProgramError if it cannot be reached.
    """

    def __init__(self, address: str, *, token: str | None = None, keys: str | os.PathLike[str] | None = None):
        self.address = address
        self._keys = ["--keys", os.fspath(keys)] if keys is not None else []
        self._environment = {"PENUMBRA_TOKEN": token} if token is not None else {}

    def submit(self, scene: Scene, *, priority: int = 0, **options: Any) -> Job:
        """Submits a render: options as those of render, but for those of workers and files."""
        arguments = words("submit", with_device(dict(options)), submit_keywords())
        with scene_file(scene) as file:
            submitted = self._submit([file, f"--priority={priority}", *arguments])
        return Job(self, int(submitted.out), messages_of(submitted.err))

    def status(self, *jobs: int) -> dict[str, Any]:
        """`jobs`, `groups`, `workers`, `messages` (scheduler/service/README.md): of these jobs, or all."""
        told: dict[str, Any] = json.loads(self._call(["status", *map(str, jobs), "--json"]).out)
        return told

    def job(self, number: int) -> Job:
        """The job of this number."""
        return Job(self, number)

    def _submit(self, words: list[Any]) -> Finished:
        return self._call(["submit", "--quiet", *words], of_input=True)

    def _is_there(self) -> bool:
        return True

    def _run(self, words: list[Any], needed: Callable[[], bool] = lambda: True) -> Finished:
        running = Running([*words, "--to", self.address, *self._keys], environment=self._environment)
        return running.wait(still_needed=lambda: needed() and self._is_there())

    def _call(self, words: list[Any], of_input: bool = False) -> Finished:
        finished = self._run(words)
        if finished.interrupted:
            raise KeyboardInterrupt
        if finished.code != 0:
            raise error_of(finished.code, finished.err, of_input=of_input)
        return finished
