# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every example of examples/python runs: as a script, and as a notebook where jupytext and nbclient are."""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys

import pytest

pytest.importorskip("matplotlib")

ROOT = pathlib.Path(os.environ.get("GLISSADE_SOURCE", pathlib.Path(__file__).parents[2]))
EXAMPLES = sorted((ROOT / "examples" / "python").glob("*.py"))
PNG = b"\x89PNG\r\n\x1a\n"

pytestmark = pytest.mark.skipif(not EXAMPLES, reason=f"no examples at {ROOT}")


def number(pattern, text):
    """The number that a pattern's only group finds."""
    found = re.search(pattern, text)
    assert found, f"{pattern!r} is not in\n{text}"
    return float(found.group(1))


# What an example says, and between which numbers that must be.
FIGURES = {
    "mono_ba": [(r"38 x 38, of rank (\d+)", 31, 31), (r"relative difference of the cost (\S+)", 0, 1e-10),
                (r"relative difference of the steps (\S+)", 0, 1e-9)],
    "marginalization": [(r"the optimum has moved by (\S+) m", 0, 1e-6),
                        (r"with the prior, there: kappa (\S+)", 0, 1e-12),
                        (r"estimates OFF: kappa (\S+)", 1e-6, 1), (r"estimates FULL: kappa (\S+)", 0, 1e-10)],
    "prior_weights": [(r"(?m)^fixed +(\S+)", 6.74595, 6.74597), (r"(?m)^10 +(\S+)", 3.9, 3.91),
                      (r"(?m)^1e\+08 +(\S+)", 6.74595, 6.74597)],
    "gauge": [(r"free: .* (\S+) m in its gauge", 0, 1e-6), (r"transformed against computed: (\S+)", 0, 1e-8)],
    "ba_file": [(r"\((\S+) %\)", 4.9, 5.1), (r"then rms (\S+) px", 0.35, 0.5)],
    "vio": [(r"ATE (\S+) m", 0.001, 0.05), (r"(\d+) states", 100, 121)],
    "own_edge": [(r"differences: (\S+)", 0, 1e-6), (r"a wrong sign: +(\S+)", 0.5, 2),
                 (r"Tukey +.*off by +(\S+) mm", 0, 60), (r"finds (\d+) of them", 9, 9)],
}


def test_every_example_has_its_figures():
    assert sorted(FIGURES) == [path.stem for path in EXAMPLES]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_as_a_script(path, tmp_path):
    environment = {**os.environ, "MPLBACKEND": "Agg", "RECORDING": str(ROOT / "data" / "flight")}
    done = subprocess.run([sys.executable, "-W", "error", str(path)], cwd=tmp_path, env=environment, timeout=300,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Warning" not in done.stderr
    for pattern, low, high in FIGURES[path.stem]:
        assert low <= number(pattern, done.stdout) <= high, (pattern, done.stdout)
    pictures = sorted(tmp_path.glob("*.png"))
    assert len(pictures) >= 2
    assert {picture.read_bytes()[:8] for picture in pictures} == {PNG}


@pytest.mark.skipif(not all(map(importlib.util.find_spec, ("jupytext", "nbclient", "nbformat", "ipykernel"))),
                    reason="needs jupytext, nbclient, nbformat and ipykernel")
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_as_a_notebook(path, tmp_path):
    import nbformat

    done = subprocess.run([sys.executable, str(ROOT / "scripts" / "make_notebooks.py"), "--output", str(tmp_path),
                           str(path)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    notebook = nbformat.read(tmp_path / f"{path.stem}.ipynb", as_version=4)
    nbformat.validate(notebook)
    kinds = [cell.cell_type for cell in notebook.cells]
    assert kinds[0] == "markdown" and kinds.count("code") >= 3
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert not any(output.output_type == "error" for output in outputs)
    streams = {name: "".join(output.text for output in outputs if output.get("name") == name)
               for name in ("stdout", "stderr")}
    assert "Warning" not in streams["stderr"]  # the bar of a long solve may be there
    text = streams["stdout"]
    for pattern, low, high in FIGURES[path.stem]:
        assert low <= number(pattern, text) <= high, (pattern, text)
