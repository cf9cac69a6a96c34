"""Signatures and docstrings of functions with options, and stubs for type checkers, by the program's list of
options."""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from . import options, rendering, service, session, sweeping, tools

Documented = tuple[str, Callable[..., Any], str, Callable[[], Iterable[str]]]


def functions() -> list[Documented]:
    """Module, function, command, and keywords of what takes options."""

    def those_of(command: str, *without: str) -> Callable[[], Iterable[str]]:
        return lambda: tools.keywords_of(command, *without)

    return [
        ("rendering", rendering.render, "render", rendering.render_keywords),
        ("rendering", rendering.render_all, "render", rendering.render_all_keywords),
        ("rendering", rendering.estimate, "render", rendering.render_keywords),
        ("rendering", rendering.pixel, "render", rendering.render_keywords),
        ("sweeping", sweeping.sweep, "render", lambda: rendering.render_all_keywords() - {"out", "summary"}),
        ("service", service.Service.submit, "submit", service.submit_keywords),
        ("session", session.Session.render, "submit", service.submit_keywords),
        ("tools", tools.info, "info", those_of("info")),
        ("tools", tools.compare, "compare", those_of("compare")),
        ("tools", tools.denoise, "denoise", those_of("denoise")),
        ("tools", tools.merge, "merge", those_of("merge", "out")),
        ("tools", tools.report, "report", those_of("report", "out")),
    ]


def hint_of(option: options.Option) -> str:
    """The type of its values in Python."""
    if option.kind == "flag":
        return "bool | None"
    if option.is_pairs and option.keyword == "settings":
        return "Settings | Mapping[str, Any] | Sequence[str] | None"
    if option.is_pairs:
        return "Mapping[str, Any] | Sequence[str] | None"
    one = {"integer": "int", "number": "float"}.get(option.kind, "")
    if option.choices:
        one = f"Literal[{', '.join(map(repr, option.choices))}]"
    if not one:
        one = "str | os.PathLike[str] | Sequence[int] | Sequence[str]"
    elif option.repeatable:
        one = f"{one} | Sequence[{one}]"
    return one + (" | bool | None" if option.given_as_flag is not None else " | None")


@functools.cache  # as the function was, before it was given a signature
def _own(function: Callable[..., Any]) -> list[inspect.Parameter]:
    return [each for each in inspect.signature(function).parameters.values() if each.kind is not each.VAR_KEYWORD]


def _options_beside(own: Iterable[inspect.Parameter], command: str, keywords: Iterable[str]) -> list[options.Option]:
    chosen = set(keywords) - {each.name for each in own}
    return [option for name, option in options.of_command(command).items() if name in chosen]


def _text_of(option: options.Option) -> str:
    text = option.help.rstrip(".")
    if option.values and not option.choices:
        text += f" [{option.values}]"
    return textwrap.fill(f"{option.keyword}: {text}.", 100, initial_indent="    ", subsequent_indent="        ")


def document_all() -> None:
    """Gives the functions the signatures and docstrings of the program at hand."""
    for _, function, command, keywords in functions():
        own = _own(function)
        beside = _options_beside(own, command, keywords())
        parameters = [
            inspect.Parameter(option.keyword, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint_of(option))
            for option in beside
        ]
        if any(option.keyword == "backend" for option in beside):
            parameters.append(
                inspect.Parameter("device", inspect.Parameter.KEYWORD_ONLY, default=None, annotation="str | None")
            )
        whole = inspect.signature(function).replace(parameters=own + parameters)
        function.__signature__ = whole  # type: ignore[attr-defined]
        text = inspect.getdoc(function) or ""
        function.__doc__ = text + f"\n\nOptions of `penumbra {command}`:\n" + "\n".join(map(_text_of, beside))


_KINDS = {"integer": "int", "number": "float", "boolean": "bool", "number or text": "float | str", "text": "str"}


def _settings() -> str:
    """The settings as a TypedDict, so that type checkers know their names."""
    rows = []
    for setting in options.description()["settings"]:
        hint = _KINDS[setting["kind"]]
        if setting["choices"]:
            hint = f"Literal[{', '.join(map(repr, setting['choices']))}] | str"
        rows.append(f'    "{setting["key"]}": {hint},')
    return 'Settings = TypedDict("Settings", {\n' + "\n".join(rows) + "\n}, total=False)\n"


def stub_of(module: str) -> str:
    """The stub file of a module with such functions: its source without bodies, with all options."""
    import ast

    tree = ast.parse((Path(__file__).with_name(f"{module}.py")).read_text())
    documented = {
        function.__qualname__: (function, command, keywords)
        for name, function, command, keywords in functions()
        if name == module
    }

    def strip(nodes: list[ast.stmt], prefix: str) -> None:
        for node in nodes:
            if isinstance(node, ast.ClassDef):
                strip(node.body, f"{node.name}.")
            elif isinstance(node, ast.FunctionDef):
                own_text = ast.get_docstring(node)
                whole = documented[prefix + node.name][0].__doc__ if prefix + node.name in documented else own_text
                text = textwrap.indent(whole or "", " " * (8 if prefix else 4)).strip()
                node.body = [ast.Expr(ast.Constant(text))] if text else []
                node.body.append(ast.Expr(ast.Constant(...)))
                if prefix + node.name in documented:
                    function, command, keywords = documented[prefix + node.name]
                    for option in _options_beside(_own(function), command, keywords()):
                        node.args.kwonlyargs.append(
                            ast.arg(option.keyword, ast.parse(hint_of(option), mode="eval").body)
                        )
                        node.args.kw_defaults.append(ast.Constant(None))
                    if "backend" in set(keywords()):
                        node.args.kwonlyargs.append(ast.arg("device", ast.parse("str | None", mode="eval").body))
                        node.args.kw_defaults.append(ast.Constant(None))
                    node.args.kwarg = None

    strip(tree.body, "")
    tree.body = [node for node in tree.body if not (isinstance(node, ast.ImportFrom) and node.module == "__future__")]
    head = "import os\nfrom collections.abc import Mapping, Sequence\nfrom typing import Any, Literal, TypedDict\n\n"
    return (
        "from __future__ import annotations\n\n"
        + head
        + _settings()
        + "\n"
        + ast.unparse(ast.fix_missing_locations(tree))
        + "\n"
    )


def write_all(folder: Path) -> None:
    """Writes options.json and the stubs, for the build of the wheel."""
    import json

    (folder / "options.json").write_text(json.dumps(options.described_by_program()) + "\n")
    for module in sorted({name for name, *_ in functions()}):
        (folder / f"{module}.pyi").write_text(stub_of(module))
