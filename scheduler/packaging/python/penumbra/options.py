"""The program's own list of its options, and command lines made of keyword arguments by it."""

from __future__ import annotations

import difflib
import functools
import json
import keyword
import operator
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import UsageError
from .program import answer

_LIST = Path(__file__).with_name("options.json")  # the wheel's, of its own programs
_NAMES = {"-D": "defines", "--set": "settings"}


@dataclass(frozen=True)
class Option:
    """An option of a command, as `penumbra describe` tells it. `kind` is flag, integer, number or text."""

    name: str
    names: tuple[str, ...]
    help: str
    group: str
    kind: str
    value: str | None
    values: str | None
    choices: tuple[str, ...]
    default: str | None
    environment: str | None
    given_as_flag: str | None
    positional: bool
    required: bool
    repeatable: bool
    needs: tuple[str, ...]
    excludes: tuple[str, ...]

    @property
    def keyword(self) -> str:
        """Its name in Python: --stop-after is stop_after, -D is defines, --set is settings, --pass is pass_."""
        name = _NAMES.get(self.name) or self.name.lstrip("-").replace("-", "_")
        return name + "_" if keyword.iskeyword(name) else name

    @property
    def is_pairs(self) -> bool:
        return self.repeatable and self.value is not None and self.value.endswith("=VALUE")


@functools.cache
def description() -> dict[str, Any]:
    """`program`, `version`, `commands`, `settings`, `plugins`: what the program tells of itself."""
    if _LIST.exists() and "PENUMBRA_PROGRAM" not in os.environ:
        told: dict[str, Any] = json.loads(_LIST.read_text())
        return told
    return described_by_program()


def described_by_program() -> dict[str, Any]:
    """The same, asked of the program."""
    told: dict[str, Any] = json.loads(answer(["describe"]).out)
    for reference in ("settings", "plugins"):
        told[reference] = json.loads(answer([reference, "--json"]).out)
    return told


@functools.cache
def of_command(command: str) -> dict[str, Option]:
    """The options of a command by their keywords, without positional ones."""
    told = next(each for each in description()["commands"] if each["name"] == command)
    options = []
    for told_option in told["options"]:
        fields: dict[str, Any] = {name: tuple(of) if isinstance(of, list) else of for name, of in told_option.items()}
        options.append(Option(**fields))
    return {option.keyword: option for option in options if not option.positional}


def text_of(value: Any) -> str:
    """A value as the command line takes it."""
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Iterable):
        return ",".join(map(text_of, value))
    if hasattr(value, "item"):  # a number of numpy
        value = value.item()
    return repr(value) if isinstance(value, float) else str(value)


def _number(option: Option, value: Any) -> str:
    try:
        if option.kind == "integer" and not isinstance(value, str):
            return str(operator.index(value))
        return text_of(value) if isinstance(value, str) else repr(float(value))
    except TypeError:
        raise UsageError(f"{option.keyword}={value!r} is no {option.kind}") from None


def _values(option: Option, value: Any) -> list[str]:
    if isinstance(value, Mapping):
        if not option.is_pairs:
            raise UsageError(f"{option.keyword} takes no dict")
        return [f"{name}={text_of(each)}" for name, each in value.items()]
    if option.repeatable and not isinstance(value, (str, os.PathLike)) and isinstance(value, Iterable):
        return [text_of(each) for each in value]
    return [_number(option, value) if option.kind in ("integer", "number") else text_of(value)]


def unknown(what: str, name: str, known: Iterable[str]) -> UsageError:
    """The error for a name that is not known, with the nearest that is."""
    near = difflib.get_close_matches(name, list(known), 1)
    return UsageError(f"there is no {what} '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))


def words(command: str, keywords: Mapping[str, Any], allowed: Iterable[str] | None = None) -> list[str]:
    """The words of the command line. None and False mean that the option is not given. Raises UsageError."""
    known = of_command(command)
    names = set(known if allowed is None else allowed)
    result = []
    for name, value in keywords.items():
        if name not in names:
            raise unknown(f"option of {command}", name, names)
        option = known[name]
        if value is None or value is False:
            continue
        if option.kind == "flag" or (value is True and option.given_as_flag is not None):
            if value is not True and text_of(value) != "true":
                raise UsageError(f"{name} is True or False, not {value!r}")
            result.append(option.name)
            continue
        for text in _values(option, value):
            if "\0" in text:
                raise UsageError(f"{name}={value!r} has a null character")
            result += [f"{option.name}={text}"] if option.name.startswith("--") else [option.name, text]
    return result


def with_device(keywords: dict[str, Any]) -> dict[str, Any]:
    """`device` stands for two options: "native", "auto", "opencl" or "opencl:NAME"."""
    device = keywords.pop("device", None)
    if device is not None:
        backend, _, name = text_of(device).partition(":")
        if "backend" in keywords or (name and "opencl_device" in keywords):
            raise UsageError("device stands for backend and opencl_device: give one or the other")
        keywords["backend"] = backend
        if name:
            keywords["opencl_device"] = name
    return keywords
