"""Runs the program. Nothing is left behind: a program that this process starts ends with it, however it ends."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from .errors import ProgramError, error_of

_OWN = Path(__file__).parent / "programs" / "bin" / "penumbra"
_SECONDS_TO_END = 20.0
_SECONDS_BETWEEN_LOOKS = 0.05


def find() -> Path:
    """PENUMBRA_PROGRAM, else the package's own, else `penumbra` of the PATH."""
    named = os.environ.get("PENUMBRA_PROGRAM")
    if named:
        if not os.access(named, os.X_OK):
            raise ProgramError(f"PENUMBRA_PROGRAM={named} is no program")
        return Path(named)
    if _OWN.exists():
        return _OWN
    found = shutil.which("penumbra")
    if found is None or Path(found).read_bytes()[:2] == b"#!":  # the script that starts main()
        raise ProgramError(
            "there is no program penumbra: neither in the package nor in PATH; PENUMBRA_PROGRAM may name it"
        )
    return Path(found)


@dataclass
class Finished:
    """What a program wrote to its standard output and error, its exit code, and whether Ctrl-C ended it."""

    words: list[str]
    code: int
    out: str
    err: str
    interrupted: bool = False


class Running:
    """A program that has been started. It gets a Ctrl-C only from interrupt(), and ends when this process does.
    `on_line` gets the lines of its standard output in another thread; those that write() gives it are its input."""

    def __init__(
        self,
        words: Iterable[str | os.PathLike[str]],
        *,
        environment: Mapping[str, str] | None = None,
        on_line: Callable[[str], None] | None = None,
        reads_input: bool = False,
    ):
        self.words = [os.fspath(find()), *(os.fspath(word) for word in words)]
        reading, self._owner = os.pipe()
        try:
            self._process = subprocess.Popen(
                self.words,
                stdin=subprocess.PIPE if reads_input else subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=[reading],
                start_new_session=True,
                env={**os.environ, **(environment or {}), "PENUMBRA_OWNER_PIPE": str(reading)},
            )
        except (OSError, ValueError) as error:  # ValueError: an embedded null byte
            os.close(self._owner)
            raise ProgramError(f"cannot start {self.words[0]}: {error}") from error
        finally:
            os.close(reading)
        self._out: list[str] = []
        self._err: list[str] = []
        self._readers: list[threading.Thread] = [
            threading.Thread(target=self._read, args=of, daemon=True)
            for of in ((self._process.stdout, self._out, on_line), (self._process.stderr, self._err, None))
        ]
        for reader in self._readers:
            reader.start()

    @staticmethod
    def _read(stream: IO[bytes], lines: list[str], on_line: Callable[[str], None] | None) -> None:
        with stream:
            for raw in stream:
                line = raw.decode(errors="replace")
                lines.append(line)
                if on_line is not None:
                    on_line(line)

    @property
    def is_running(self) -> bool:
        return self._process.poll() is None

    @property
    def said(self) -> str:
        """What it wrote to its standard error so far."""
        return "".join(self._err)

    def write(self, line: str) -> None:
        """Gives it a line of input. Raises BrokenPipeError if it has ended."""
        assert self._process.stdin is not None
        self._process.stdin.write(line.encode() + b"\n")
        self._process.stdin.flush()

    def interrupt(self) -> None:
        """Asks it to end with what it has; the second time it ends at once."""
        if self.is_running:
            self._process.send_signal(signal.SIGINT)

    def wait(self, *, still_needed: Callable[[], bool] = lambda: True) -> Finished:
        """Until it ends. Ctrl-C asks it to end, a second Ctrl-C kills it and raises. It is killed, too, as soon as it
        is not needed any more."""
        interrupted = False
        try:
            while any(reader.is_alive() for reader in self._readers):
                try:
                    for reader in self._readers:
                        reader.join(_SECONDS_BETWEEN_LOOKS)
                    if not still_needed():
                        self._process.kill()
                except KeyboardInterrupt:
                    if interrupted:
                        raise
                    interrupted = True
                    self.interrupt()
            self._process.wait()
        finally:
            self.end(0)
        return Finished(self.words, self._process.returncode, "".join(self._out), self.said, interrupted)

    def end(self, seconds: float = _SECONDS_TO_END) -> None:
        """Ends it, by force if it is not over after so long."""
        until = time.monotonic() + seconds
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        if self.is_running and seconds > 0:
            self._process.terminate()
        try:
            self._process.wait(max(0.0, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._owner >= 0:
            os.close(self._owner)
            self._owner = -1
        for reader in self._readers:
            reader.join()


def run(words: Iterable[str | os.PathLike[str]]) -> Finished:
    """Runs `penumbra WORDS` to its end, whatever that is."""
    return Running(words).wait()


def answer(words: Iterable[str | os.PathLike[str]]) -> Finished:
    """The same for what must succeed. Raises what the program says else."""
    finished = run(words)
    if finished.interrupted:
        raise KeyboardInterrupt
    if finished.code != 0:
        raise error_of(finished.code, finished.err)
    return finished


def main() -> None:
    """The command `penumbra` of an environment with the package."""
    program = find()
    os.execv(program, [os.fspath(program), *sys.argv[1:]])
