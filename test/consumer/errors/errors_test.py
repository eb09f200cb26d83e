#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What GCC says of mistakes in an edge, a vertex or handles: in the first ten lines it must name what
is wrong and show what is expected, and nothing of it is "no matching function".

    errors_test.py COMPILER FLAGS...     as a consumer of the installed package gives them
"""

import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent / "mistakes.cpp"
command = []

EVALUATE = ("VertexPose&", "VertexPointXYZ&", "expected::Vector<1>&", "expected::Jacobian<1, 6>*",
            "expected::Jacobian<1, 3>*", ") const")
RANGE_HANDLES = "Expected = glissade::expected::Braces<glissade::VertexHandle<glissade::VertexPose>, " \
                "glissade::VertexHandle<glissade::VertexPointXYZ> >"

MISTAKES = {
    "JACOBIAN_SIZE": ("the Jacobian of vertex 1 has the wrong type", *EVALUATE),
    "JACOBIAN_SIZE_FIRST": ("the Jacobian of vertex 0 has the wrong type", *EVALUATE),
    "MISSING_CONST": ("Evaluate must be const", *EVALUATE),
    "RESIDUAL_SIZE": ("the residual has the wrong type", *EVALUATE),
    "VERTEX_ORDER": ("Evaluate must take the vertices in the order of Vertices", *EVALUATE),
    "RETURNS_VOID": ("Evaluate must return bool", *EVALUATE),
    "NO_VERTICES": ("`using Vertices = VertexList<...>`", "EdgeRange"),
    "NO_RESIDUAL_DIM": ("kResidualDim", "EdgeRange"),
    "SWAPPED_HANDLES": ("the handles must be those of the edge's Vertices", RANGE_HANDLES),
    "TOO_FEW_HANDLES": ("the handles must be those of the edge's Vertices", RANGE_HANDLES),
    "ANY_HANDLE": ("the handles must be those of the edge's Vertices", RANGE_HANDLES, "AnyVertex"),
    "SWAPPED_HANDLES_BUILT_IN": (
        "the handles must be those of the edge's Vertices",
        "Expected = glissade::expected::Braces<glissade::VertexHandle<glissade::VertexPose>, "
        "glissade::VertexHandle<glissade::VertexPose>, "
        "glissade::VertexHandle<glissade::VertexInverseDepth> >"),
    "RELATIVE_POSE_OF_A_POINT": ("vertices 0 and 1 must be of type VertexPose for kRelativePose",
                                 "EdgeRange"),
    "VERTEX_WITHOUT_CONST_DATA": ("`const double* Data() const`", "VertexScale"),
}


class Errors(unittest.TestCase):
    def compile(self, mistake):
        return subprocess.run([*command, "-fsyntax-only", f"-DMISTAKE={mistake}", str(SOURCE)],
                              capture_output=True, text=True, check=False, env={"LC_ALL": "C",
                              "PATH": "/usr/bin:/bin"})

    def test_right(self):
        result = self.compile("RIGHT")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_every_mistake_is_in_the_table(self):
        text = SOURCE.read_text(encoding="utf-8")
        names = set(re.findall(r"^#define (\w+) \d+", text, re.MULTILINE)) - {"RIGHT"}
        self.assertEqual(names, set(MISTAKES))


def check(mistake):
    def test(self):
        result = self.compile(mistake)
        self.assertNotEqual(result.returncode, 0)
        head = "\n".join(result.stderr.splitlines()[:10])
        self.assertIn("error:", head, result.stderr)
        for words in MISTAKES[mistake]:
            self.assertIn(words, head, result.stderr)
        self.assertNotIn("no matching function", result.stderr)
    return test


for name in MISTAKES:
    setattr(Errors, f"test_{name.lower()}", check(name))

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    command = sys.argv[1:]
    unittest.main(argv=sys.argv[:1])
