#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the Python in README.md and docs/: the blocks of a page in order, in one namespace, in a folder of their
own beside the repository's data/, without a display. They print the lines of the page's `<!-- output -->` blocks, as
its C++ does, and of `<!-- output: python -->` blocks.

    python_blocks_test.py

    <!-- code: needs NAME -->           before a block: of another package; run where that is installed
    <!-- code: not run: why -->

Needs a Python that can import the package glissade.
"""

import contextlib
import importlib.util
import io
import os
import pathlib
import tempfile
import traceback
import unittest

import markdown_blocks

os.environ.setdefault("MPLBACKEND", "agg")


def is_here(package):
    return importlib.util.find_spec(package) is not None


def python_pages():
    """{page: its blocks of Python and of what they print}."""
    found = {}
    for page in markdown_blocks.pages():
        mine = [block for block in markdown_blocks.blocks(page)
                if block.language == "python" and not block.says.startswith("code: not run:")
                or block.says == "output" or block.says.startswith("output: python")]
        if any(block.language == "python" for block in mine):
            found[page] = mine
    return found


def run(block, names):
    """A block, compiled so that a traceback has the page's name and line."""
    code = compile("\n" * (block.line - 1) + block.code, str(block.page), "exec")
    exec(code, names)  # noqa: S102: the code of our own pages


class PythonBlocks(unittest.TestCase):
    def test_pages_run_and_print_what_they_say(self):
        ran, here = 0, pathlib.Path.cwd()
        for page, blocks in python_pages().items():
            printed, names = io.StringIO(), {"__name__": "__main__"}
            with self.subTest(page=str(page.relative_to(markdown_blocks.ROOT))), \
                 tempfile.TemporaryDirectory() as folder:
                (pathlib.Path(folder) / "data").symlink_to(markdown_blocks.ROOT / "data")
                os.chdir(folder)
                try:
                    for block in blocks:
                        if block.language != "python":
                            continue
                        needed = block.says.removeprefix("code: needs ") if "code: needs " in block.says else "glissade"
                        if not is_here(needed):
                            continue
                        with contextlib.redirect_stdout(printed):
                            run(block, names)
                        ran += 1
                except Exception:  # noqa: BLE001: whatever a page's code throws is the page's failure
                    self.fail(f"{block.where}\n{traceback.format_exc()}")
                finally:
                    os.chdir(here)
                for block in blocks:
                    if block.says.startswith("output") and is_here((block.says.split()[2:] or ["glissade"])[0]):
                        self.assertEqual(markdown_blocks.missing_lines(block.code, printed.getvalue()), [],
                                         f"{block.where}; printed was\n{printed.getvalue()}")
        self.assertGreater(ran, 4)
        print(f"{ran} blocks of {len(python_pages())} pages ran")


if __name__ == "__main__":
    if not is_here("glissade"):
        raise SystemExit("this Python has no package glissade (pip install .)")
    unittest.main()
