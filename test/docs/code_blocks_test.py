#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the C++ in README.md and docs/*.md against the installed package, warnings as errors.

    code_blocks_test.py PREFIX COMPILER [FLAG...]

A block with an #include is a file, or, if a comment says so, its other lines are the body of a
function. A block without is the body of a function, in which some names are known (CONTEXT). A comment
on the line before the block says what it is where this is not so:

    <!-- code: file -->                           declarations at file scope
    <!-- code: with Pose T_w_b0; double focal; -->   a function's body, with these names besides
    <!-- code: not compiled: why -->
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDES = "#include <glissade/glissade.h>\n#include <glissade/testing.h>\nusing namespace glissade;\n"
CONTEXT = """
  [[maybe_unused]] Problem problem;
  [[maybe_unused]] VertexHandle<VertexPose> host, target, first, last;
  [[maybe_unused]] VertexHandle<VertexInverseDepth> depth, depth_a, depth_b;
"""
BLOCK = re.compile(r"(?:^<!-- code: (?P<says>[^\n]*?) -->\n)?^```(?:cpp|c\+\+)\n(?P<code>.*?)^```$",
                   re.MULTILINE | re.DOTALL)
PREFIX, COMMAND = pathlib.Path(), []


def blocks(path):
    """(line, what the comment says, code) of each block."""
    text = path.read_text(encoding="utf-8")
    for match in BLOCK.finditer(text):
        yield text.count("\n", 0, match.start("code")) + 1, match["says"] or "", match["code"]


def source_of(says, code):
    """A translation unit; None for what is not to be compiled."""
    if says.startswith("not compiled:"):
        return None
    lines = code.splitlines(keepends=True)
    head = [line for line in lines if re.match(r"\s*(#include|using namespace)", line)]
    body = "".join(line for line in lines if line not in head)
    if says == "file":
        return INCLUDES + "".join(head) + body
    if head and not says:
        return code
    extra = says.removeprefix("with ") if says.startswith("with ") else ""
    if says and not extra:
        raise ValueError(f"what is 'code: {says}'?")
    known = CONTEXT if not head else ""
    return f"{INCLUDES}{''.join(head)}void Snippet({extra.rstrip('; ').replace(';', ',')}) {{{known}{body}}}\n"


class CodeBlocks(unittest.TestCase):
    def test_the_code_of_the_docs_compiles_without_warnings(self):
        files = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
        count = 0
        for path in files:
            for line, says, code in blocks(path):
                with self.subTest(where=f"{path.relative_to(ROOT)}:{line}"):
                    source = source_of(says, code)
                    if source is None:
                        continue
                    count += 1
                    self.compile(source)
        self.assertGreaterEqual(count, 4, "README.md has two blocks, docs/ has more")

    def test_a_warning_is_found(self):
        self.assertNotEqual(self.run_compiler("bool F(unsigned a, int b) { return a < b; }\n").returncode, 0)

    def run_compiler(self, source):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "block.cpp"
            file.write_text(source, encoding="utf-8")
            return subprocess.run([*COMMAND, str(file)], capture_output=True, text=True, check=False)

    def compile(self, source):
        result = self.run_compiler(source)
        self.assertEqual(result.returncode, 0, f"{result.stderr[:4000]}\n--- of ---\n{source}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    prefix, compiler, *flags = sys.argv[1:]
    COMMAND = [compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror",
               # A block may end with what its reader goes on with.
               "-Wno-unused-variable", "-Wno-unused-but-set-variable",
               "-I", str(pathlib.Path(prefix) / "include"), *flags]
    unittest.main(argv=sys.argv[:1])
