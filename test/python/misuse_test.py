# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a user should not do, and what then happens: no crash, a word that helps, nothing changed."""

import copy
import pathlib
import pickle
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import vision_problem

import glissade as gl


class Square(gl.EdgeKind):
    residual_dim = 1

    def residual(self, x):
        return x**2 - 2.0


def numbers(n=500, kind=None):
    problem = gl.Problem()
    vertices = problem.add_vectors(np.ones((n, 1)))
    return problem, vertices, problem.add_edges(kind or Square(), [vertices])


def test_a_residual_cannot_change_its_problem():
    refused = []

    class Changes(Square):
        def residual(self, x):
            for change in (lambda: problem.remove_edges(edges), lambda: problem.solve(),
                           lambda: problem.add_edges(Square(), [vertices])):
                with pytest.raises(RuntimeError, match="not changed"):
                    change()
                refused.append(change)
            return super().residual(x)

    problem, vertices, edges = numbers(kind=Changes())
    for ask in (problem.cost, lambda: problem.chi2(edges), lambda: problem.check_jacobian(edges)):
        refused.clear()
        ask()
        assert len(refused) >= 3
    assert problem.num_edges == 500


def test_another_thread_cannot_change_a_problem_that_is_asked():
    class Slow(Square):
        def residual(self, x):
            time.sleep(0.2)
            return super().residual(x)

    problem, vertices, edges = numbers(kind=Slow())
    thread = threading.Thread(target=problem.cost)
    thread.start()
    time.sleep(0.05)
    with pytest.raises(RuntimeError):
        problem.remove_edges(edges)
    thread.join()
    problem.remove_edges(edges)


@pytest.mark.parametrize("work", ["problem.solve(**endless)", "problem.solve(callback=lambda it: None, **endless)"])
def test_the_interpreter_ends_while_a_thread_solves(work):
    code = f"""
import threading, time, glissade as gl
endless = dict(cost_tolerance=0, step_tolerance=0, gradient_tolerance=0, max_iterations=10**6, max_time_s=60)
problem, *_ = gl.Problem.from_bal(gl.make_ring(40, 2000))
threading.Thread(target=lambda: {work}, daemon=True).start()
time.sleep(0.4)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_lists_of_options_are_copies():
    options = gl.SlidingWindowOptions()
    options.cameras = [gl.WindowCamera(400, 400)]
    before = options.cameras
    options.cameras = [gl.WindowCamera(1, 1)] * 400
    assert before[0].fx == 400 and len(options.cameras) == 400


def test_one_row_is_one_row():
    for rows in (0, 2):
        with pytest.raises(ValueError, match=f"T_body_camera has {rows} rows where 1 are needed"):
            gl.WindowCamera(T_body_camera=np.zeros((rows, 7)))
        with pytest.raises(ValueError, match="accel_bias"):
            gl.preintegrate([0, 1], np.zeros((2, 3)), np.zeros((2, 3)), accel_bias=np.zeros((rows, 3)))


def test_errors_can_be_pickled():
    with pytest.raises(gl.Error) as error:
        gl.Problem().solve()
    again = pickle.loads(pickle.dumps(error.value))
    assert again.code == gl.StatusCode.NOTHING_TO_SOLVE and str(again) == str(error.value)
    assert str(copy.copy(error.value)) == str(error.value)


def test_what_an_argument_raises_comes_out():
    class Stubborn:
        def __array__(self, dtype=None, copy=None):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gl.Problem().add_poses(Stubborn())


def test_words_for_wrong_arguments(window):
    problem, poses, depths, _ = vision_problem(window)
    for bad in ("text", 1j * np.ones((1, 7)), np.array([object()]), np.array(["a"])):
        with pytest.raises(TypeError, match="poses must be real numbers, not "):
            problem.add_poses(bad)
    with pytest.raises(TypeError, match=r"solve\(\): option 'max_iterations' cannot be '5'"):
        problem.solve(max_iterations="5")
    with pytest.raises(TypeError, match="no option '__class__'"):
        problem.solve(__class__=int)
    with pytest.raises(TypeError, match=r"Kind\(\)"):
        problem.add_edges(Square, [depths])

    class Wide(Square):
        residual_dim = 1.5

    with pytest.raises(ValueError, match="residual_dim"):
        problem.add_edges(Wide(), [depths])
    with pytest.raises(gl.Error) as error:
        problem.add_edges(Square(), [depths], sqrt_information=np.nan)
    assert error.value.code == gl.StatusCode.NOT_FINITE
    with pytest.raises(OverflowError, match="stamps_ns"):
        gl.preintegrate(np.array([2**63 + 1, 2**63 + 2], np.uint64), np.zeros((2, 3)), np.zeros((2, 3)))
    for loss in (gl.Huber, gl.Cauchy, gl.Tukey):
        with pytest.raises(gl.Error):
            loss(-1.0)
    for policy in (lambda: gl.OkvisPolicy(0, 0), lambda: gl.TwoWayPolicy(-5), lambda: gl.FixedLagPolicy(np.nan)):
        with pytest.raises(ValueError):
            policy()
    # A vertex alone needs no list; nothing is no error.
    assert len(problem.add_edges(Square(), depths)) == len(depths)
    assert len(problem.add_points([])) == 0


def test_indices(window):
    _, poses, _, _ = vision_problem(window)
    for index in (np.int64(2), np.uint8(2), np.array(2)):
        assert poses[index] == poses[2]
    for index in (True, 1.5, "a", [[0, 1]], ..., poses, [0.5]):
        with pytest.raises(TypeError):
            poses[index]
    with pytest.raises(IndexError):
        poses[10**30]


def test_bulk_calls_are_all_or_nothing():
    problem = gl.Problem()
    v = problem.add_vectors([[1.0], [2.0]])
    with pytest.raises(gl.Error):
        problem.set_values(v[[0, 0, 1]], [[5.0], [6.0], [np.nan]])
    np.testing.assert_array_equal(problem.values(v), [[1], [2]])
    with pytest.raises(gl.Error, match="twice"):
        problem.remove_vertices(v[[0, 0]])
    assert problem.num_vertices == 2
    edges = problem.add_edges(Square(), [v])
    with pytest.raises(gl.Error, match="twice"):
        problem.remove_edges(edges[[1, 1]])
    assert problem.num_edges == 2
    course = gl.Problem()
    handles = course.add_course_scene()
    course.fix(handles.poses[0], gl.Fix.POSITION)
    with pytest.raises(gl.Error):
        course.fix(handles.poses + handles.depths, gl.Fix.POSITION_AND_YAW)
    assert course.fixed(handles.poses) == [gl.Fix.POSITION, gl.Fix.FREE, gl.Fix.FREE]
    with pytest.raises(gl.Error):
        course.fixed(v)


def test_data_of_edges_is_theirs():
    class Shift(gl.EdgeKind):
        residual_dim = 1

        def residual(self, x, m):
            with pytest.raises(ValueError):
                m += 1.0
            return x - m

    problem = gl.Problem()
    v = problem.add_vectors([[1.0], [2.0]])
    data = np.zeros((2, 1))
    problem.add_edges(Shift(), [v], data)
    cost = problem.cost()
    data[:] = 100.0
    assert problem.cost() == cost


def test_a_jacobian_of_poses_far_away():
    class Position(gl.EdgeKind):
        residual_dim = 3

        def residual(self, pose, m):
            return pose[:, :3] - m

        def jacobian(self, pose, m):
            return (np.tile(np.eye(3, 6), (len(pose), 1, 1)),)

    problem = gl.Problem()
    poses = problem.add_poses([[5e6, 4e5, 1e2, 0, 0, 0, 1]])
    assert problem.check_jacobian(problem.add_edges(Position(), poses, [[5e6, 4e5, 0]])) < 1e-8


def test_callbacks_stop_with_what_is_false(window):
    for answer in (False, np.False_, 0):
        problem, *_ = vision_problem(window)
        assert problem.solve(callback=lambda it, a=answer: a).termination == gl.Termination.CANCELLED
    problem, *_ = vision_problem(window)
    assert problem.solve(callback=lambda it: None).converged


def test_copies_and_names(window, tmp_path):
    problem, *_ = vision_problem(window)
    assert copy.deepcopy(problem).cost() == problem.cost()
    assert repr(problem) == f"<Problem: {problem.num_vertices} vertices, {problem.num_edges} edges>"
    path = tmp_path / "ring.txt"
    gl.make_ring(4, 20).write(path)
    assert isinstance(path, pathlib.Path) and len(gl.read_bal(path).points) == 20


def test_many_edges_are_asked_together():
    calls = []

    class Counts(Square):
        def residual(self, x):
            calls.append(len(x))
            return super().residual(x)

    problem, _, edges = numbers(kind=Counts())
    np.testing.assert_allclose(problem.chi2(edges), 1.0)
    assert calls == [500]


def test_types_of_a_users_program():
    pytest.importorskip("mypy")
    code = """
import glissade
import numpy as np
import numpy.typing as npt

class Kind(glissade.EdgeKind):
    residual_dim = 1
    def residual(self, *arguments: npt.NDArray[np.float64]) -> npt.ArrayLike:
        return arguments[0]

problem = glissade.Problem()
try:
    problem.add_edges(Kind(), [problem.add_vectors([[1.0]])])
except glissade.Error as error:
    code: glissade.StatusCode = error.code
vertices = problem.vertices()[np.int64(0)][[0]][np.array([True])]
print(glissade.__version__)
"""
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "-c", code], capture_output=True, text=True)
    assert "Success" in done.stdout, done.stdout + done.stderr
