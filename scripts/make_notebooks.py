#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes notebooks of examples/python and executes them, into build/notebooks.

    scripts/make_notebooks.py [--output FOLDER] [--no-execute] [EXAMPLE.py ...]

Needs jupytext, nbformat, and nbclient and ipykernel to execute; glissade with matplotlib, as the examples do
(pip install ".[plot]" jupytext nbclient ipykernel). Notebooks run in the output folder, where
their pictures go as well; RECORDING names the recording of vio.py, by default data/flight.
"""

import argparse
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("examples", nargs="*", type=pathlib.Path, metavar="EXAMPLE.py",
                        default=sorted((ROOT / "examples" / "python").glob("*.py")))
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build" / "notebooks", metavar="FOLDER")
    parser.add_argument("--no-execute", action="store_true", help="convert only: no outputs in the notebooks")
    args = parser.parse_args()
    try:
        import jupytext
        import nbformat

        if not args.no_execute:
            from nbclient import NotebookClient
            from nbclient.exceptions import CellExecutionError
    except ImportError as error:
        print(f"make_notebooks.py: {error}: pip install jupytext nbformat nbclient ipykernel", file=sys.stderr)
        return 2
    args.output.mkdir(parents=True, exist_ok=True)
    os.environ.setdefault("RECORDING", str(ROOT / "data" / "flight"))
    os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"  # a kernel's own choice, whatever ours is
    for path in args.examples:
        try:
            notebook = jupytext.read(path)
        except OSError as error:
            print(f"make_notebooks.py: {error}", file=sys.stderr)
            return 2
        # The head of the file is comments alone: the notebook begins with its title instead.
        head = notebook.cells[0]
        if head.cell_type == "code" and all(line.startswith("#") for line in head.source.splitlines()):
            del notebook.cells[0]
            notebook.metadata["license"] = "BSD-3-Clause"
        notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
        target = args.output / path.with_suffix(".ipynb").name
        if not args.no_execute:
            try:
                NotebookClient(notebook, timeout=300, kernel_name="python3",
                               resources={"metadata": {"path": str(args.output)}}).execute()
            except CellExecutionError as error:
                print(f"make_notebooks.py: {path}: {error}", file=sys.stderr)
                return 1
        nbformat.write(notebook, target)
        print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
