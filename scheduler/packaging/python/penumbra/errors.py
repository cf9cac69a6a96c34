"""Exceptions, made of what the program says on its standard error."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

_MESSAGE = re.compile(
    r"^(?:.+?: )?(?P<file>[^:]+):(?P<line>\d+):(?P<column>\d+): (?:(?P<kind>error|warning): )?(?P<text>.*)$"
)
_PLAIN = re.compile(r"^[^:]+: (?P<kind>error|warning): (?P<text>.*)$")
_HINT = re.compile(r"did you mean [^?]*\?|Run '[^']*' for what there is\.|; (say|use) .*")


@dataclass(frozen=True)
class Message:
    """One error or warning. `file`, `line` and `column` (from 1) are None where it is not about a place of a file."""

    kind: str
    text: str
    file: str | None = None
    line: int | None = None
    column: int | None = None

    @property
    def hint(self) -> str | None:
        """What would be right instead, if the program knows it."""
        found = _HINT.search(self.text)
        return found.group(0).lstrip("; ") if found else None

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.file else ""
        return place + self.text


def messages_of(text: str) -> list[Message]:
    """The errors and warnings in the output of a program."""
    found = []
    for line in text.splitlines():
        if match := _MESSAGE.match(line):
            found.append(
                Message(
                    match["kind"] or "error", match["text"], match["file"], int(match["line"]), int(match["column"])
                )
            )
        elif match := _PLAIN.match(line):
            found.append(Message(match["kind"], match["text"]))
    return found


class PenumbraError(Exception):
    """Base of all errors. `messages` has all that the program said; `file`, `line`, `column`, `hint` are of the
    first."""

    def __init__(self, text: str, messages: list[Message] | None = None):
        super().__init__(text)
        self.messages = messages or [Message("error", text)]
        first = self.messages[0]
        self.file, self.line, self.column, self.hint = first.file, first.line, first.column, first.hint


class UsageError(PenumbraError, ValueError):
    """An option, a value or an array that cannot be used."""


class SceneError(PenumbraError, ValueError):
    """A scene that cannot be read: `file`, `line` and `column` are where."""


class RenderError(PenumbraError, RuntimeError):
    """What was asked for failed or is incomplete. `result` is a Result of what was written all the same, or None; of
    several renders `results` are those that did not fail."""

    result: Any = None
    results: Any = ()


class ProgramError(PenumbraError, RuntimeError):
    """The program is missing, was killed, or cannot be reached."""


def error_of(code: int, text: str, *, of_input: bool = False) -> PenumbraError:
    """The exception for a program that ended with this exit code (negative: a signal) and said this. `of_input`: it has
    rendered nothing, so that what failed is a scene or an option."""
    errors = [message for message in messages_of(text) if message.kind == "error"]
    said = "\n".join(map(str, errors)) or text.strip()
    if code < 0 or code > 128:
        signal = -code if code < 0 else code - 128
        return ProgramError(f"the program was ended by signal {signal}" + (f": {said}" if said else ""), errors)
    if "no service answers at" in said:
        return ProgramError(said, errors)
    if code == 2 or of_input:
        return (SceneError if any(error.file for error in errors) else UsageError)(said or "bad usage", errors)
    return RenderError(text.strip() or f"the program ended with exit code {code}", errors)
