"""Shows how far a render is: as a bar of tqdm on a terminal or in a notebook, or by a callback."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable
from typing import Any, Union

Callback = Callable[[dict[str, Any]], None]
Progress = Union[Callback, bool, None]


def in_notebook() -> bool:
    """Whether this runs in the kernel of a notebook."""
    shell = sys.modules.get("IPython")
    return shell is not None and type(shell.get_ipython()).__name__ == "ZMQInteractiveShell"


class Reporter:
    """Passes on the lines of `penumbra render --progress json`.

    `progress`: a callback, which gets each of them as a dict with `samples_done`, `samples_total`, `seconds`,
    `seconds_left`, `relative_error`, `workers`, of several renders `render`, in another thread; True or False for
    tqdm's bar or nothing; None for a bar if there is tqdm and somebody who looks. What a callback raises is raised by
    close().
    """

    def __init__(self, progress: Progress):
        self._callback = progress if callable(progress) else None
        self._bar: Any = None
        self._error: BaseException | None = None
        if progress is True or (progress is None and (in_notebook() or sys.stderr.isatty())):
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]
            except ImportError:
                if progress is True:
                    raise
                return
            self._bar = tqdm(unit=" samples", unit_scale=True, leave=False)

    @property
    def is_needed(self) -> bool:
        return self._callback is not None or self._bar is not None

    def line(self, text: str) -> None:
        if text.startswith("{"):
            self.update(json.loads(text))

    def update(self, state: dict[str, Any]) -> None:
        if self._bar is not None:
            self._bar.total = state["samples_total"]
            if state["relative_error"] is not None:
                self._bar.set_postfix_str(f"error {state['relative_error']:.2%}", refresh=False)
            self._bar.n = state["samples_done"]
            self._bar.refresh()
        if self._callback is not None and self._error is None:
            try:
                self._callback(state)
            except BaseException as error:  # it ends the render, not the thread that reads
                if isinstance(error, KeyboardInterrupt) and threading.current_thread() is threading.main_thread():
                    raise  # Ctrl-C
                self._error = error

    def check(self) -> bool:
        """Whether nothing went wrong."""
        return self._error is None

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        if self._error is not None:
            raise self._error
