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

Needs numpy, and matplotlib for the pictures (Debian, Ubuntu: python3-matplotlib).
"""

import pathlib
import struct
import sys

MAGIC = b"\x89BBAL\r\n\x1a"


class Problem:
    """A .bbal file (docs/formats.md)."""

    def __init__(self, np, path):
        data = pathlib.Path(path).read_bytes()
        if data[:8] != MAGIC:
            raise ValueError(f"{path} is no .bbal file")
        cameras, points, observations = struct.unpack("=3q", data[16:40])
        if len(data) != 48 + 72 * cameras + 24 * points + 24 * observations:
            raise ValueError(f"{path} is not as long as its counts say")
        self.cameras = np.frombuffer(data, "=f8", 9 * cameras, 48).reshape(cameras, 9)
        at = 48 + 72 * cameras
        self.points = np.frombuffer(data, "=f8", 3 * points, at).reshape(points, 3)
        record = np.dtype([("camera", "=i4"), ("point", "=i4"), ("uv", "=f8", 2)])
        self.observations = np.frombuffer(data, record, observations, at + 24 * points)

    def rotations(self, np):
        """World to camera, by Rodrigues' formula."""
        w = self.cameras[:, :3]
        angle = np.linalg.norm(w, axis=1)
        axis = w / np.maximum(angle, 1e-300)[:, None]
        K = np.zeros((len(w), 3, 3))
        K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
        K -= K.transpose(0, 2, 1)
        s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
        return np.eye(3) + s * K + (1 - c) * (K @ K)

    def errors(self, np):
        """Of each point, rms over its observations, px."""
        camera, point = self.observations["camera"], self.observations["point"]
        X = np.einsum("kij,kj->ki", self.rotations(np)[camera], self.points[point])
        X += self.cameras[camera, 3:6]
        p = -X[:, :2] / X[:, 2:]
        n = (p ** 2).sum(axis=1)
        f, k1, k2 = self.cameras[camera, 6:].T
        r = (f * (1 + n * (k1 + k2 * n)))[:, None] * p - self.observations["uv"]
        sums = np.bincount(point, (r ** 2).sum(axis=1), len(self.points))
        return np.sqrt(sums / np.maximum(np.bincount(point, minlength=len(self.points)), 1))

    def pairs(self, np):
        """Which cameras see a point together; also the lengths of the tracks."""
        order = np.argsort(self.observations["point"], kind="stable")
        cameras = self.observations["camera"][order]
        lengths = np.bincount(self.observations["point"], minlength=len(self.points))
        begin = np.concatenate([[0], np.cumsum(lengths)[:-1]])
        seen = np.eye(len(self.cameras), dtype=bool)
        for length in np.unique(lengths):
            tracks = cameras[begin[lengths == length][:, None] + np.arange(length)]
            for a in range(length):
                for b in range(length):
                    seen[tracks[:, a], tracks[:, b]] = True
        return seen, lengths


def describe(np, problem):
    seen, lengths = problem.pairs(np)
    per_camera = np.bincount(problem.observations["camera"], minlength=len(problem.cameras))
    print(f"{len(problem.cameras)} cameras, {len(problem.points)} points, {len(problem.observations)} observations")
    print(f"a camera has {per_camera.min()} to {per_camera.max()} observations, mean {per_camera.mean():.0f}")
    print(f"a point is seen by {lengths.min()} to {lengths.max()} cameras, mean {lengths.mean():.2f}")
    print(f"blocks of the reduced system: {100 * seen.mean():.2f} %, {seen.sum(axis=1).mean():.0f} in a row")
    return seen


def draw(np, plt, axis, problem, title):
    R = problem.rotations(np)
    centre = -np.einsum("kji,kj->ki", R, problem.cameras[:, 3:6])
    error = problem.errors(np)
    shown = axis.scatter(problem.points[:, 0], problem.points[:, 1], c=error, s=0.3, cmap="turbo", vmin=0, vmax=4)
    axis.quiver(centre[:, 0], centre[:, 1], -R[:, 2, 0], -R[:, 2, 1], color="k", angles="xy", scale_units="xy",
                scale=0.3, width=0.0015)
    axis.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"{title}: rms {np.sqrt((error ** 2).mean()):.2f} px")
    plt.colorbar(shown, ax=axis, shrink=0.7, label="reprojection error of a point [px]")


def main():
    if len(sys.argv) not in (2, 4):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        import numpy as np
        before = Problem(np, sys.argv[1])
        seen = describe(np, before)
        if len(sys.argv) == 2:
            return 0
        after = Problem(np, sys.argv[2])
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError as error:
        print(f"plot_bal.py: {error} (Debian, Ubuntu: python3-matplotlib)", file=sys.stderr)
        return 2
    except (OSError, ValueError, struct.error) as error:
        print(f"plot_bal.py: {error}", file=sys.stderr)
        return 2
    figure, axes = plt.subplots(1, 3, figsize=(16, 5), layout="constrained")
    draw(np, plt, axes[0], before, "before")
    draw(np, plt, axes[1], after, "after")
    for axis in axes[:2]:
        axis.set(xlim=axes[1].get_xlim(), ylim=axes[1].get_ylim())
    axes[2].imshow(seen, cmap="gray_r", interpolation="antialiased")
    axes[2].set(xlabel="camera", ylabel="camera", title=f"pairs that see a point together: {100 * seen.mean():.1f} %")
    figure.savefig(sys.argv[3], dpi=75)
    return 0


if __name__ == "__main__":
    sys.exit(main())
