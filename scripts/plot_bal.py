#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Describes a bundle adjustment problem, and draws it before and after a solve.

    make_data city city.bbal --cameras 1000
    ba_solve city.bbal --output solved.bbal
    scripts/plot_bal.py city.bbal                              what it consists of
    scripts/plot_bal.py city.bbal solved.bbal city.png         and three pictures side by side

The pictures: points from above, coloured by their reprojection error, and cameras as arrows, before and
after; and which pairs of cameras see a point together, that is the blocks of the reduced system.

Files are BAL's: text, .gz, .bz2 or .bbal. Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import pathlib

from plot_util import fail, gl, np, plot, plt, save


def describe(bal):
    seen = plot.shared_points(bal.camera_indices, bal.point_indices, len(bal.cameras))
    lengths = np.bincount(bal.point_indices, minlength=len(bal.points))
    per_camera = np.bincount(bal.camera_indices, minlength=len(bal.cameras))
    print(f"{len(bal.cameras)} cameras, {len(bal.points)} points, {len(bal.uv)} observations")
    print(f"a camera has {per_camera.min()} to {per_camera.max()} observations, mean {per_camera.mean():.0f}")
    print(f"a point is seen by {lengths.min()} to {lengths.max()} cameras, mean {lengths.mean():.2f}")
    print(f"blocks of the reduced system: {100 * seen.mean():.2f} %, {seen.sum(axis=1).mean():.0f} in a row")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", help="BAL file")
    parser.add_argument("after", nargs="?", help="the same, solved")
    parser.add_argument("picture", nargs="?", type=pathlib.Path, help=".png (or .pdf, .svg) to write")
    args = parser.parse_args()
    if args.after is not None and args.picture is None:
        parser.error("a solved file needs the name of a picture")
    try:
        before = gl.read_bal(args.before)
        after = gl.read_bal(args.after) if args.after is not None else None
    except gl.Error as error:
        fail(error)
    describe(before)
    if after is None:
        return
    figure, axes = plt.subplots(1, 3, figsize=(16, 5), layout="constrained")
    plot.bal_scene(before, title="before", ax=axes[0])
    plot.bal_scene(after, title="after", ax=axes[1])
    axes[0].set(xlim=axes[1].get_xlim(), ylim=axes[1].get_ylim())
    plot.camera_pairs(after, ax=axes[2])
    save(figure, args.picture, dpi=75)


if __name__ == "__main__":
    main()
