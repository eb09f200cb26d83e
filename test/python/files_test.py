# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files in and out."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import glissade as gl

DATA = pathlib.Path(os.environ.get("GLISSADE_SOURCE", pathlib.Path(__file__).parents[2])) / "data"


def test_bal_round_trip_and_arrays(tmp_path):
    bal = gl.make_ring(num_cameras=8, num_points=60)
    for name in ("a.txt", "a.txt.gz", "a.txt.bz2", "a.bbal"):
        path = str(tmp_path / name)
        bal.write(path)
        again = gl.read_bal(path)
        np.testing.assert_array_equal(again.cameras, bal.cameras)
        np.testing.assert_array_equal(again.uv, bal.uv)
    # From arrays: the same problem.
    problem, cameras, points, edges = gl.Problem.from_bal(path)
    ours = gl.Problem()
    c, x = ours.add_bal_cameras(bal.cameras), ours.add_points(bal.points)
    ours.add_bal_observations(c[bal.camera_indices], x[bal.point_indices], bal.uv)
    assert ours.cost() == problem.cost()
    a, b = ours.solve(), problem.solve()
    assert a.final_cost == b.final_cost and a.converged
    problem.to_bal(str(tmp_path / "solved.txt"))
    np.testing.assert_array_equal(gl.read_bal(str(tmp_path / "solved.txt")).points, ours.values(x))
    problem.to_ply(str(tmp_path / "scene.ply"))
    assert (tmp_path / "scene.ply").read_bytes().startswith(b"ply")


def test_files_that_are_none(tmp_path):
    with pytest.raises(gl.Error) as error:
        gl.read_bal(str(tmp_path / "nowhere"))
    assert error.value.code == gl.StatusCode.IO_ERROR
    (tmp_path / "bad.txt").write_text("2 1 1\n0 0 1 x\n")
    with pytest.raises(gl.Error, match=r"bad.txt:2: ") as error:
        gl.Problem.from_bal(str(tmp_path / "bad.txt"))
    assert error.value.code == gl.StatusCode.PARSE_ERROR
    with pytest.raises(gl.Error):
        gl.Problem.from_colmap(str(tmp_path))
    problem = gl.Problem()
    problem.add_poses([[0, 0, 0, 0, 0, 0, 1]])
    with pytest.raises(gl.Error):
        problem.to_bal(str(tmp_path / "x.txt"))
    assert not (tmp_path / "x.txt").exists()


def test_viowin_round_trip(tmp_path, window):
    path = str(tmp_path / "w.txt.gz")
    gl.write_viowin([window, window], path)
    again = gl.read_viowin(path)
    assert len(again) == 2
    np.testing.assert_array_equal(again[1].poses, window.poses)
    costs = []
    for w in (window, again[0]):
        problem = gl.Problem()
        problem.add_window(w)
        costs.append(problem.solve().final_cost)
    assert costs[0] == costs[1]


def test_trajectories_and_their_errors(tmp_path):
    stamps = np.arange(100, dtype=np.int64) * 50_000_000 + 1_403_636_579_763_555_584
    poses = np.zeros((100, 7))
    poses[:, 6] = 1.0
    poses[:, :3] = np.random.default_rng(1).normal(size=(100, 3)).cumsum(axis=0)
    times = str(tmp_path / "times")
    for form in gl.TrajectoryFormat:
        path = str(tmp_path / form.name)
        kitti = form == gl.TrajectoryFormat.KITTI
        gl.write_trajectory(path, stamps, poses, form, times if kitti else "")
        s, p = gl.read_trajectory(path, times if kitti else "")
        np.testing.assert_array_equal(s, stamps)
        np.testing.assert_array_equal(p, poses)
    with pytest.raises(gl.Error, match="stamps"):
        gl.read_trajectory(path)
    with pytest.raises(TypeError):
        gl.write_trajectory(path, stamps, poses, "xml")
    turned = poses.copy()
    turned[:, :3] = poses[:, [1, 0, 2]] * [-1, 1, 1] + [3, 4, 5]  # a quarter turn about z
    turned[:, 3:] = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]
    errors = gl.evaluate_trajectory(stamps, turned, stamps, poses)
    assert errors["translation_m"]["rmse"] < 1e-12 and errors["translation_m"]["count"] == 100
    errors = gl.evaluate_trajectory(stamps, turned, stamps, poses, gl.AlignmentKind.NONE)
    assert errors["translation_m"]["rmse"] > 1.0


def test_g2o_round_trip(tmp_path):
    rng = np.random.default_rng(4)
    poses = np.tile([0.0, 0, 0, 0, 0, 0, 1], (5, 1))
    poses[:, :3] = rng.normal(size=(5, 3))
    problem = gl.Problem()
    vertices = problem.add_poses(poses)
    steps = np.tile([0.0, 0, 0, 0, 0, 0, 1], (4, 1))
    steps[:, :3] = np.diff(poses[:, :3], axis=0)
    problem.add_relative_poses(vertices[:-1], vertices[1:], steps, information=np.diag([4.0, 4, 4, 9, 9, 9]))
    problem.add_relative_poses(vertices[4], vertices[0], [0, 0, 0, 0, 0, 0, 1])
    path = str(tmp_path / "graph.g2o")
    problem.to_g2o(path)
    again, scene = gl.Problem.from_g2o(path)
    assert again.cost() == pytest.approx(problem.cost(), rel=1e-12)
    assert scene.held == 0 and len(scene.relative_poses) == 5
    problem.fix(vertices[0])
    assert again.solve().final_cost == pytest.approx(problem.solve().final_cost, rel=1e-9)
    scene.write(again, str(tmp_path / "solved.g2o"))
    solved, _ = gl.Problem.from_g2o(str(tmp_path / "solved.g2o"))
    assert solved.cost() == pytest.approx(again.cost(), rel=1e-9)
    (tmp_path / "other.g2o").write_text("VERTEX_SE2 0 1 2 3\n")
    with pytest.raises(gl.Error, match=r"other.g2o:1: "):
        gl.Problem.from_g2o(str(tmp_path / "other.g2o"))


def test_evo_reads_our_trajectories(tmp_path):
    evo = pytest.importorskip("evo.tools.file_interface")
    stamps = np.arange(5, dtype=np.int64) * 50_000_000
    poses = np.tile([1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8], (5, 1))
    gl.write_trajectory(str(tmp_path / "t.txt"), stamps, poses)
    read = evo.read_tum_trajectory_file(str(tmp_path / "t.txt"))
    np.testing.assert_allclose(read.positions_xyz, poses[:, :3])
    np.testing.assert_allclose(read.orientations_quat_wxyz, poses[:, [6, 3, 4, 5]])
    np.testing.assert_allclose(read.timestamps, stamps * 1e-9)


def test_the_package_has_types_for_all_of_its_names():
    """mypy sees the installed package, and no name that it has is untyped or wrong."""
    pytest.importorskip("mypy")
    code = """
import numpy as np
import glissade as gl
problem, cameras, points, edges = gl.Problem.from_bal(gl.make_ring())
summary: gl.SolveSummary = problem.solve(max_iterations=3, callback=lambda it: it.cost > 0)
H: np.ndarray = problem.hessian()
stamps, poses = gl.read_trajectory("x")
reveal_type(summary.final_cost)
"""
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "-c", code], capture_output=True, text=True)
    assert 'Revealed type is "float"' in done.stdout.replace("builtins.", ""), done.stdout
    assert "Success" in done.stdout, done.stdout + done.stderr
