# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shared by the tests of the Python package, which run against the installed one."""

import numpy as np
import pytest

import glissade as gl


@pytest.fixture
def window():
    return gl.make_window(num_keyframes=10, seed=3)


def vision_problem(window, **weights):
    """The vision-only problem of a window from numpy arrays alone."""
    problem = gl.Problem()
    poses = problem.add_poses(window.poses)
    depths = problem.add_inverse_depths(window.inverse_depths)
    landmark, host, target, uv_host, uv_target = window.observations()
    fx, fy, _, _, sigma = window.camera
    weights = weights or {"sqrt_information": [fx / sigma, fy / sigma]}
    edges = problem.add_reprojections(
        depths[landmark], poses[host], poses[target], uv_host, uv_target,
        T_body_camera=window.T_body_camera, **weights)
    problem.fix(poses[[0, 9]])
    return problem, poses, depths, edges


def rotated(q, v):
    """R(q) v of (n, 4) x y z w and (n, 3)."""
    t = 2.0 * np.cross(q[:, :3], v)
    return v + q[:, 3:] * t + np.cross(q[:, :3], t)
