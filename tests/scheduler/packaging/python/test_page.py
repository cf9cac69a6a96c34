"""The snippets of the page on Python that use the package, one after the other, beside scenes/. The others are run by
tests/acceptance/python_page_test.cpp."""

import re

import penumbra
from conftest import ROOT


def test_the_snippets_work(tmp_path, monkeypatch):
    page = (ROOT / "scheduler/record/PYTHON.md").read_text()
    snippets = re.findall(r"^```py\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert len(snippets) == 3
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    names = {}
    for snippet in snippets:
        exec(compile(snippet, "PYTHON.md", "exec"), names)
    assert names["r"].denoised.shape == (64, 64, 3) and (names["a"].image != names["b"].image).any()
    assert (penumbra.read("a.exr").image == names["r"].image).all() and len(list(tmp_path.glob("sweep/*.exr"))) == 4
