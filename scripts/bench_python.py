#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time of the Python package over that of C++ for the same work, both sides in turn:

    window   building and solving a window of ten keyframes from arrays
    bal      reading and solving a BAL file
    edges    three steps on 100 000 residuals, by an edge written in Python with its Jacobian and by the
             built-in one

    scripts/bench_python.py build/release/bin/bench_python data/win10.txt.gz data/ring.txt.gz

Needs the installed package.
"""

import statistics
import subprocess
import sys
import time

import numpy as np

import glissade as gl

ROUNDS, REPETITIONS, RESIDUALS = 5, 9, 100_000


class PointReprojection(gl.EdgeKind):
    """add_point_reprojections() in numpy."""

    residual_dim = 2

    def in_camera(self, pose, point):
        x, y, z, w = pose[:, 3], pose[:, 4], pose[:, 5], pose[:, 6]
        R = np.empty((len(pose), 3, 3))  # body to world
        R[:, 0, 0], R[:, 0, 1], R[:, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
        R[:, 1, 0], R[:, 1, 1], R[:, 1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
        R[:, 2, 0], R[:, 2, 1], R[:, 2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
        return R, np.einsum("nij,ni->nj", R, point - pose[:, :3])

    def residual(self, pose, point, uv):
        _, x = self.in_camera(pose, point)
        return x[:, :2] / x[:, 2:] - uv

    def jacobian(self, pose, point, uv):
        R, x = self.in_camera(pose, point)
        z = 1.0 / x[:, 2]
        u, v = x[:, 0] * z, x[:, 1] * z
        d_point = np.empty((len(x), 2, 3))
        d_point[:, 0] = z[:, None] * (R[:, :, 0] - u[:, None] * R[:, :, 2])
        d_point[:, 1] = z[:, None] * (R[:, :, 1] - v[:, None] * R[:, :, 2])
        d_pose = np.empty((len(x), 2, 6))
        d_pose[:, :, :3] = -d_point
        d_pose[:, 0, 3], d_pose[:, 0, 4], d_pose[:, 0, 5] = u * v, -1 - u * u, v
        d_pose[:, 1, 3], d_pose[:, 1, 4], d_pose[:, 1, 5] = 1 + v * v, -u * v, -u
        return d_pose, d_point


def window_arrays(path):
    window = gl.read_viowin(path)[0]
    fx, _, _, _, sigma = window.camera
    return window.poses, window.inverse_depths, window.observations(), window.T_body_camera, fx / sigma


def build_and_solve(arrays):
    poses, inverse_depths, (landmark, host, target, uv_host, uv_target), T_body_camera, weight = arrays
    start = time.perf_counter()
    problem = gl.Problem()
    p, d = problem.add_poses(poses), problem.add_inverse_depths(inverse_depths)
    problem.add_reprojections(d[landmark], p[host], p[target], uv_host, uv_target, T_body_camera,
                              sqrt_information=weight)
    problem.fix(p[[0, -1]])
    problem.solve(max_iterations=10)
    return time.perf_counter() - start


def read_and_solve(path):
    start = time.perf_counter()
    problem, *_ = gl.Problem.from_bal(path)
    problem.solve(max_iterations=20)
    return time.perf_counter() - start


def solve_points(residuals, kind=PointReprojection()):
    poses = 20
    points = residuals // 2 // poses
    T = np.zeros((poses, 7))
    T[:, 0], T[:, 6] = 0.1 * np.arange(poses), 1.0
    j = np.arange(points)
    X = np.stack([j % 50 * 0.1 - 2.5, j // 50 * 0.05 - 1.25, 6.0 + 0.5 * (j % 7)], axis=1)
    start_X = X + 0.02 * ((j[:, None] + np.arange(3)) % 5 - 2)
    l, i = np.divmod(np.arange(points * poses), poses)
    uv = (X[l, :2] - T[i, :2]) / X[l, 2:]
    problem = gl.Problem()
    p, x = problem.add_poses(T), problem.add_points(start_X)
    problem.add_edges(kind, [p[i], x[l]], uv)
    problem.fix(p[:2])
    start = time.perf_counter()
    problem.solve(max_iterations=3, cost_tolerance=0, gradient_tolerance=0, step_tolerance=0)
    return time.perf_counter() - start


def main():
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    program, window_file, bal_file = sys.argv[1:]
    arrays = window_arrays(window_file)
    works = {
        "window": (window_file, lambda: build_and_solve(arrays), 10 * REPETITIONS),
        "bal": (bal_file, lambda: read_and_solve(bal_file), REPETITIONS),
        "edges": (str(RESIDUALS), lambda: solve_points(RESIDUALS), REPETITIONS // 3),
    }
    for name, (argument, python, repetitions) in works.items():
        cpp_times, python_times = [], []
        for _ in range(ROUNDS):
            done = subprocess.run([program, name, argument], capture_output=True, text=True, check=True)
            cpp_times.append(statistics.median(float(line) for line in done.stdout.split()))
            python_times.append(statistics.median(python() for _ in range(repetitions)))
        cpp, ours = statistics.median(cpp_times), statistics.median(python_times)
        ratio = statistics.median(b / a for a, b in zip(cpp_times, python_times))
        print(f"{name:8} C++ {1e3 * cpp:9.3f} ms, Python {1e3 * ours:9.3f} ms, ratio {ratio:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
