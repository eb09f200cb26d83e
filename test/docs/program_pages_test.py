#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the pages that are programs (`<!-- page: one program -->`): the C++ of such a page, from top to bottom,
is the body of one function, and prints what the page says that it prints.

    program_pages_test.py PREFIX COMPILER WORK_FOLDER

    <!-- code: file -->        before a block: declarations at file scope
    <!-- code: with ... --> and <!-- code: not compiled: why --> are as in code_blocks_test.py
    <!-- output -->            before a block: lines that the page's C++ prints, in this order; and so does
                               its Python, where it has some (python_blocks_test.py)
    <!-- output: cpp -->, <!-- output: python -->    lines that only one of them prints
"""

import pathlib
import re
import subprocess
import sys
import unittest

import markdown_blocks

PREFIX, COMPILER, WORK = pathlib.Path(), "", pathlib.Path()
CMAKE = """cmake_minimum_required(VERSION 3.22)
project(pages CXX)
find_package(glissade REQUIRED COMPONENTS io)
add_executable(pages pages.cpp)
target_link_libraries(pages PRIVATE glissade::io)
target_compile_options(pages PRIVATE -O0 -Wall -Wextra -Werror)
"""
INCLUDES = "#include <cstdio>\n#include <cstring>\n#include <glissade/glissade.h>\n#include <glissade/testing.h>\n"


def programs():
    return [page for page in markdown_blocks.pages() if markdown_blocks.is_program(page)]


def source_of(pages):
    """A program that runs the page of the number that it is given."""
    includes, parts, calls = [], [], []
    for k, page in enumerate(pages):
        declared, body = [], []
        for block in markdown_blocks.blocks(page):
            if block.language != "cpp" or block.says.startswith("code: not compiled:"):
                continue
            lines = block.code.splitlines(keepends=True)
            includes += [line for line in lines if line.startswith("#include")]
            code = "".join("\n" if re.match(r"(#include|using namespace glissade;)", line) else line for line in lines)
            (declared if block.says == "code: file" else body).append(
                f'#line {block.line} "{page.relative_to(markdown_blocks.ROOT)}"\n{code}')
        parts.append(f"namespace page_{k} {{\n{''.join(declared)}\nint Run() {{\n{''.join(body)}\nreturn 0;\n}}\n}}\n")
        calls.append(f'  if (std::strcmp(argv[1], "{k}") == 0) return page_{k}::Run();\n')
    return (f"{INCLUDES}{''.join(includes)}using namespace glissade;\n{''.join(parts)}"
            f"int main(int argc, char** argv) {{\n  if (argc < 2) return 2;\n{''.join(calls)}  return 2;\n}}\n")


class ProgramPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        WORK.mkdir(parents=True, exist_ok=True)
        (WORK / "CMakeLists.txt").write_text(CMAKE, encoding="utf-8")
        (WORK / "pages.cpp").write_text(source_of(programs()), encoding="utf-8")
        for command in (["cmake", "-S", WORK, "-B", WORK / "build", f"-DCMAKE_PREFIX_PATH={PREFIX}",
                         f"-DCMAKE_CXX_COMPILER={COMPILER}"], ["cmake", "--build", WORK / "build"]):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                said = done.stdout + done.stderr
                raise AssertionError("\n".join(re.findall(r".*error.*", said)[:20]) or said[-3000:])

    def test_pages_print_what_they_say(self):
        outputs = 0
        for k, page in enumerate(programs()):
            with self.subTest(page=str(page.relative_to(markdown_blocks.ROOT))):
                done = subprocess.run([WORK / "build/pages", str(k)], capture_output=True, text=True, check=False,
                                      cwd=markdown_blocks.ROOT, timeout=300)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                rest = done.stdout
                for block in markdown_blocks.blocks(page):
                    if block.says in ("output", "output: cpp"):
                        outputs += 1
                        self.assertTrue(block.code.strip(), f"{block.where} says nothing")
                        self.assertEqual(markdown_blocks.missing_lines(block.code, rest), [],
                                         f"{block.where}; printed was\n{done.stdout}")
        self.assertGreater(outputs, 4)

    def test_a_line_that_is_not_printed_is_missed(self):
        self.assertEqual(markdown_blocks.missing_lines("one\n...\nthree\n", "one\ntwo\nthree\n"), [])
        self.assertEqual(markdown_blocks.missing_lines("three\none\n", "one\ntwo\nthree\n"), ["one"])


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    PREFIX, COMPILER, WORK = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3])
    unittest.main(argv=sys.argv[:1])
