"""One list of options serves the program and the package."""

import inspect
import subprocess
import sys
from pathlib import Path

import penumbra
import pytest
from penumbra import options, rendering, service, signatures


def test_nothing_of_the_program_is_missing(command_line):
    told = {option.keyword: option for option in options.of_command("render").values()}
    offered = rendering.render_keywords() | rendering.render_all_keywords() | rendering.OWN_FUNCTIONS
    assert set(told) - offered == rendering.GENERAL
    help_text = command_line("render", "--help-all").stdout
    for option in told.values():
        assert option.name in help_text
    for word in help_text.split("\nExamples:")[0].split():
        name = word.rstrip(",").partition("=")[0]
        if word.startswith("--") and name.strip("-.,;:`'").replace("-", "_") in told:
            assert name.strip(".,;:`'") in {each for option in told.values() for each in option.names}
    assert set(options.of_command("submit")) - service.submit_keywords() == rendering.GENERAL - {"json", "progress"} | {
        "to",
        "keys",
        "out",
        "frames",
        "order",
        "priority",
        "lines",
    }


def test_every_option_reaches_the_program():
    """Each with a value of its kind, in the words of its own command."""
    for command in ("render", "info", "compare", "denoise", "report", "submit"):
        for name, option in options.of_command(command).items():
            if option.kind == "flag":
                assert options.words(command, {name: True}) == [option.name]
                assert options.words(command, {name: False}) == []
            value = {"flag": True, "integer": 3, "number": 0.5}.get(option.kind, "a")
            text = " ".join(options.words(command, {name: value}))
            assert text.startswith(option.name) and (option.kind == "flag" or text.endswith(str(value)))


def test_signatures_and_docstrings_have_them():
    parameters = inspect.signature(penumbra.render).parameters
    assert set(parameters) == {"scene", "progress", "device"} | rendering.render_keywords()
    for name in rendering.render_keywords():
        assert f"    {name}: " in penumbra.render.__doc__


USES = """
import numpy
import penumbra
result = penumbra.render("a.xml", spp=64, integrator="path", settings={"film.width": 320}, defines={"a": 1}, seed=0,
                         denoise="nfor", workers=2, device="native", time_budget=1.5, target_error=0.1,
                         crop=(0, 0, 4, 4))
array: numpy.ndarray = result.layers["albedo"]
with penumbra.Session(workers=2) as session:
    session.render({"type": "scene"}, spp=1).show()
penumbra.compare(result, "b.exr", fail_above={"mse": 1.0})["mse"]
"""
MISUSES = [
    'penumbra.render("a.xml", sp=1)',
    'penumbra.render("a.xml", spp="many")',
    'penumbra.render("a.xml", integrator="pth")',
    "penumbra.Session(wrkers=1)",
    'penumbra.render("a.xml", lenient=3)',
    'penumbra.render("a.xml").imag',
]


@pytest.mark.slow
def test_type_checkers_know_them(tmp_path):
    pytest.importorskip("mypy", reason="mypy is not installed")
    package = Path(penumbra.__file__).parent
    if not (package / "py.typed").exists() or not (package / "rendering.pyi").exists():
        pytest.skip("this is not the wheel's package, which has stubs")
    (tmp_path / "uses.py").write_text(USES + "".join(f"{line}\n" for line in MISUSES))
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "uses.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    first = USES.count("\n") + 1
    wrong = {int(line.split(":")[1]) for line in checked.stdout.splitlines() if ": error: " in line}
    assert wrong == set(range(first, first + len(MISUSES))), checked.stdout
    modules = [word for file in sorted(package.glob("[a-z]*.py")) for word in ("-m", f"penumbra.{file.stem}")]
    own = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-incremental", *modules],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert own.returncode == 0, own.stdout


def test_stubs_are_python():
    for module in sorted({name for name, *_ in signatures.functions()}):
        compile(signatures.stub_of(module), module, "exec")
