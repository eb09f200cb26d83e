#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws H of monocular bundle adjustment at its solution: the course's 3 poses and 20 inverse depths.

    scripts/plot_hessian.py docs/images/mono_ba_hessian.png

Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import pathlib

from plot_util import gl, plot, save


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=pathlib.Path, help=".png (or .pdf, .svg) to write")
    args = parser.parse_args()
    problem = gl.Problem()
    scene = problem.add_course_scene(fix_poses=2)
    problem.solve()
    problem.free(scene.poses)
    save(plot.hessian(problem, decades=5).figure, args.picture)


if __name__ == "__main__":
    main()
