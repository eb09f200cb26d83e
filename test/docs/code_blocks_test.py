#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the C++ in README.md and docs/ against the installed package, warnings as errors, all blocks in one
translation unit, each in a namespace of its own.

    code_blocks_test.py PREFIX COMPILER [FLAG...]

A block with an #include is a file, or, if a comment says so, its other lines are the body of a
function. A block without is the body of a function, in which some names are known (CONTEXT). A comment
on the line before the block says what it is where this is not so:

    <!-- code: file -->                           declarations at file scope
    <!-- code: body -->                           the body of a function, with #includes before it
    <!-- code: with Pose T_w_b0; double focal; -->   a function's body, with these names besides
    <!-- code: not compiled: why -->

A page with the comment `<!-- page: one program -->` is one: program_pages_test.py runs it.
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import markdown_blocks

INCLUDES = "#include <glissade/glissade.h>\n#include <glissade/testing.h>\n"
CONTEXT = """
  [[maybe_unused]] Problem problem;
  [[maybe_unused]] VertexHandle<VertexPose> host, target, first, last;
  [[maybe_unused]] VertexHandle<VertexInverseDepth> depth, depth_a, depth_b;
"""
# What not every machine has; a block that includes it is left out there.
OPTIONAL = re.compile(r"<((?:ceres|glissade/bridge|glissade/vision|opencv2)/[^>]+)>")
PREFIX, COMMAND = pathlib.Path(), []


def body_of(block):
    """(lines of #include, what stands in the block's namespace)."""
    says = block.says.removeprefix("code: ") if block.says.startswith("code: ") else ""
    lines = block.code.splitlines(keepends=True)
    head = [line for line in lines if line.startswith("#include")]
    # Taken out line by line, so that the compiler's line numbers are those of the page.
    body = "".join("\n" if re.match(r"\s*(#include|using namespace glissade;)", line) else line for line in lines)
    marked = f'#line {block.line} "{block.where.rpartition(":")[0]}"\n{body}'
    if says == "file" or head and not says:
        return head, marked
    extra = says.removeprefix("with ") if says.startswith("with ") else ""
    if says not in ("", "body") and not extra:
        raise ValueError(f"{block.where}: what is 'code: {says}'?")
    known = CONTEXT if not head else ""
    return head, f"void Snippet({extra.rstrip('; ').replace(';', ',')}) {{{known}\n{marked}}}\n"


def blocks():
    return [block for page in markdown_blocks.pages() if not markdown_blocks.is_program(page)
            for block in markdown_blocks.blocks(page)
            if block.language == "cpp" and not block.says.startswith("code: not compiled:")]


def source_of(all_blocks):
    """One translation unit of all."""
    includes, parts = [], []
    for k, block in enumerate(all_blocks):
        head, body = body_of(block)
        needed = [f"__has_include(<{name}>)" for line in head for name in OPTIONAL.findall(line)]
        open_if, close_if = (f"#if {' && '.join(needed)}\n", "#endif\n") if needed else ("", "")
        includes.append(open_if + "".join(head) + close_if)
        parts.append(f"{open_if}namespace block_{k} {{\n{body}}}\n{close_if}")
    return f"{INCLUDES}{''.join(includes)}using namespace glissade;\n{''.join(parts)}"


class CodeBlocks(unittest.TestCase):
    def test_the_code_of_the_docs_compiles_without_warnings(self):
        found = blocks()
        self.assertGreater(len(found), 20, "README.md has two blocks, docs/ has more")
        self.compile(source_of(found))

    def test_a_mistake_is_found_and_said_where(self):
        page = markdown_blocks.ROOT / "docs/some_page.md"
        wrong = markdown_blocks.Block(page, 17, "cpp", "", "auto handle = problem.AddVertex(VertexPose{});\nhandel;\n")
        result = self.run_compiler(source_of([wrong]))
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("docs/some_page.md:18", result.stderr)

    def test_a_warning_is_found(self):
        self.assertNotEqual(self.run_compiler("bool F(unsigned a, int b) { return a < b; }\n").returncode, 0)

    def run_compiler(self, source):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "blocks.cpp"
            file.write_text(source, encoding="utf-8")
            return subprocess.run([*COMMAND, str(file)], capture_output=True, text=True, check=False)

    def compile(self, source):
        result = self.run_compiler(source)
        self.assertEqual(result.returncode, 0, result.stderr[:4000])


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    prefix, compiler, *flags = sys.argv[1:]
    COMMAND = [compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror",
               # A block may end with what its reader goes on with.
               "-Wno-unused-variable", "-Wno-unused-but-set-variable",
               "-I", str(pathlib.Path(prefix) / "include"), *flags]
    unittest.main(argv=sys.argv[:1])
