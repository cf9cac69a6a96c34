"""The package is that of the environment, else of the source; the program that of the package, else
PENUMBRA_PROGRAM."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
if importlib.util.find_spec("penumbra") is None:
    sys.path.insert(0, str(ROOT / "scheduler/packaging/python"))

import penumbra.program  # noqa: E402


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes more than one or two seconds; not among the quick tests")


@pytest.fixture
def cornell():
    return ROOT / "scenes/cornell-small/cornell-small.xml"


@pytest.fixture
def command_line(tmp_path):
    """Runs the program by hand."""

    def run(*words):
        return subprocess.run([penumbra.program.find(), *map(str, words)], cwd=tmp_path, capture_output=True, text=True)

    return run


def descendants(process):
    """The processes below a process, by /proc."""
    parents = {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                text = Path(f"/proc/{entry}/stat").read_text()
            except OSError:
                continue
            state, parent = text.rpartition(")")[2].split()[:2]
            if state != "Z":
                parents.setdefault(int(parent), []).append(int(entry))
    found = parents.get(process, [])
    return found + [below for each in found for below in descendants(each)]


@pytest.fixture(autouse=True)
def leaves_no_process():
    """Of whatever a test does, no process is left."""
    before = set(descendants(os.getpid()))
    yield
    assert set(descendants(os.getpid())) <= before
