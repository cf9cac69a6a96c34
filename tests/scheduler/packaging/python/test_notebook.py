"""The notebook runs, and shows what it promises."""

import re
import shutil
from pathlib import Path

import pytest
from conftest import ROOT

NOTEBOOK = ROOT / "scheduler/packaging/python/penumbra.ipynb"


@pytest.mark.slow
def test_the_notebook_runs(tmp_path):
    for module in ("nbclient", "ipykernel", "matplotlib", "pandas"):
        pytest.importorskip(module, reason=f"{module} is not installed")
    import nbclient
    import nbformat

    folder = tmp_path / "scheduler/packaging/python"  # it names its scene from its own folder
    folder.mkdir(parents=True)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    shutil.copy(NOTEBOOK, folder)
    notebook = nbformat.read(folder / NOTEBOOK.name, 4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "it is kept without outputs"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(folder)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    shown = [kind for output in outputs for kind in output.get("data", {})]
    assert shown.count("image/png") == 4, "the reference, the convergence, the layers, equal time"
    assert shown.count("text/html") == 1, "the table"
    printed = "".join(output.get("text", "") for output in outputs)
    slopes = [float(slope) for slope in re.findall(r"error ~ spp\^(-?[\d.]+)", printed)]
    # Independent samples: -1/2, with a standard deviation of 0.006 (of twelve such sweeps). path_mats finds the lamp by
    # chance, so that errors of its few samples are far from normal.
    assert len(slopes) == 3 and all(abs(slope + 0.5) < 5 * 0.006 for slope in slopes[1:]), printed
    assert Path(folder / "sweep/sweep.toml").exists()
