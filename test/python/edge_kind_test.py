# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Edges whose residual is written in Python."""

import numpy as np
import pytest
from conftest import rotated, vision_problem

import glissade as gl


class PointReprojection(gl.EdgeKind):
    """add_point_reprojections() once more, without an extrinsic."""

    residual_dim = 2

    def in_camera(self, pose, point):
        conjugate = pose[:, 3:] * [-1.0, -1.0, -1.0, 1.0]
        return conjugate, rotated(conjugate, point - pose[:, :3])

    def residual(self, pose, point, uv):
        _, x = self.in_camera(pose, point)
        return x[:, :2] / x[:, 2:] - uv

    def jacobian(self, pose, point, uv):
        conjugate, x = self.in_camera(pose, point)
        z = 1.0 / x[:, 2]
        d = np.zeros((len(x), 2, 3))
        d[:, 0, 0] = d[:, 1, 1] = z
        d[:, :, 2] = -x[:, :2] * (z * z)[:, None]
        R = np.stack([rotated(conjugate, np.broadcast_to(e, (len(x), 3))) for e in np.eye(3)], axis=2)
        hat = np.zeros((len(x), 3, 3))
        hat[:, 0, 1], hat[:, 0, 2], hat[:, 1, 2] = -x[:, 2], x[:, 1], -x[:, 0]
        hat -= hat.transpose(0, 2, 1)
        d_point = d @ R
        return np.concatenate([-d_point, d @ hat], axis=2), d_point


class WithoutJacobian(PointReprojection):
    jacobian = None


def scene(seed=0, poses=6, points=40):
    rng = np.random.default_rng(seed)
    T = np.zeros((poses, 7))
    T[:, 6] = 1.0
    T[:, :3] = rng.normal(0, 0.5, (poses, 3))
    X = rng.normal(0, 1, (points, 3)) + [0, 0, 6]
    i, j = np.divmod(np.arange(poses * points), points)
    uv = (X[j, :2] - T[i, :2]) / (X[j, 2:] - T[i, 2:3]) + rng.normal(0, 1e-3, (len(i), 2))
    return T, X + rng.normal(0, 0.05, X.shape), i, j, uv


def build(add, seed=0):
    T, X, i, j, uv = scene(seed)
    problem = gl.Problem()
    poses, points = problem.add_poses(T), problem.add_points(X)
    problem.fix(poses[:2])
    edges = add(problem, poses[i], points[j], uv)
    return problem, poses, points, edges


def built_in(loss=gl.Loss()):
    return build(lambda p, a, b, uv: p.add_point_reprojections(a, b, uv, sqrt_information=1e3, loss=loss))


def written(kind, loss=gl.Loss()):
    return build(lambda p, a, b, uv: p.add_edges(kind, [a, b], uv, sqrt_information=1e3, loss=loss))


@pytest.mark.parametrize("kind", [PointReprojection(), WithoutJacobian()])
@pytest.mark.parametrize("loss", [gl.Loss(), gl.Huber(1.0)])
def test_says_the_same_as_the_built_in_edge(kind, loss):
    ours, theirs = written(kind, loss), built_in(loss)
    assert ours[0].cost() == pytest.approx(theirs[0].cost(), rel=1e-12)
    np.testing.assert_allclose(ours[0].chi2(ours[3][:5]), theirs[0].chi2(theirs[3][:5]), rtol=1e-9)
    for problem, *_ in (ours, theirs):
        problem.make_hessian()
    H = theirs[0].hessian()
    np.testing.assert_allclose(ours[0].hessian(), H, atol=1e-7 * abs(H).max())
    a, b = ours[0].solve(num_threads=2), theirs[0].solve()
    assert a.converged and a.final_cost == pytest.approx(b.final_cost, rel=1e-9)
    np.testing.assert_allclose(ours[0].values(ours[1]), theirs[0].values(theirs[1]), atol=1e-6)
    assert ours[0].check_jacobian(ours[3]) < 1e-7


def test_a_wrong_jacobian_is_found():
    class Wrong(PointReprojection):
        def jacobian(self, pose, point, uv):
            d_pose, d_point = super().jacobian(pose, point, uv)
            return d_pose, 1.01 * d_point

    problem, _, _, edges = written(Wrong())
    assert problem.check_jacobian(edges) > 1e-3


def test_one_call_for_all_edges_and_the_right_rows_after_a_removal():
    calls = []

    class Counts(PointReprojection):
        def residual(self, pose, point, uv):
            calls.append(len(uv))
            return super().residual(pose, point, uv)

    problem, poses, points, edges = written(Counts())
    n = len(edges)
    problem.cost()
    assert calls == [n]
    problem.solve(max_iterations=3, cost_tolerance=0, gradient_tolerance=0, step_tolerance=0)
    assert set(calls) == {n} and len(calls) < 15
    theirs = built_in()
    for p in (problem, theirs[0]):
        p.remove_edges(p.edges()[::3])
    theirs[0].set_values(theirs[1], problem.values(poses))
    theirs[0].set_values(theirs[2], problem.values(points))
    assert problem.cost() == pytest.approx(theirs[0].cost(), rel=1e-12)
    clone = problem.clone()
    assert clone.cost() == problem.cost()
    assert problem.solve().final_cost == pytest.approx(theirs[0].solve().final_cost, rel=1e-9)


def test_marginalization_and_first_estimates_with_edges_in_python():
    results = []
    for make in (lambda: written(PointReprojection()), built_in):
        problem, poses, points, _ = make()
        problem.first_estimates = gl.FirstEstimates.FULL
        problem.solve()
        problem.marginalize(poses[2] + points[:10])
        problem.set_values(points[20], problem.values(points[20]) + 0.01)
        summary = problem.solve(max_iterations=5)
        results.append((summary.final_cost, problem.values(poses[3:])))
    assert results[0][0] == pytest.approx(results[1][0], rel=1e-6)
    np.testing.assert_allclose(results[0][1], results[1][1], atol=1e-6)


def test_what_python_gets_wrong_comes_out_of_the_solve():
    class Throws(PointReprojection):
        def residual(self, pose, point, uv):
            raise ZeroDivisionError("mine")

    class WrongShape(PointReprojection):
        def residual(self, pose, point, uv):
            return np.zeros(len(uv))

    class OneMissing(PointReprojection):
        def jacobian(self, pose, point, uv):
            return super().jacobian(pose, point, uv)[:1]

    class NotANumber(PointReprojection):
        def residual(self, pose, point, uv):
            r = super().residual(pose, point, uv)
            r[7] = np.nan
            return r

    with pytest.raises(ZeroDivisionError, match="mine"):
        written(Throws())[0].solve()
    with pytest.raises(ValueError, match=r"WrongShape.residual\(\) must return numbers of the shape \(240, 2\)"):
        written(WrongShape())[0].solve()
    with pytest.raises(ValueError, match="2 arrays"):
        written(OneMissing())[0].solve()
    problem, _, _, edges = written(NotANumber())
    with pytest.raises(gl.Error) as error:
        problem.solve()
    assert error.value.code == gl.StatusCode.EVALUATION_FAILED and error.value.edge == edges[7]


def test_arguments_of_add_edges():
    problem = gl.Problem()
    poses = problem.add_poses([[0, 0, 0, 0, 0, 0, 1]] * 3)
    points = problem.add_points(np.ones((3, 3)))
    kind = PointReprojection()
    with pytest.raises(ValueError, match="data must have 3 rows"):
        problem.add_edges(kind, [poses, points], np.zeros((2, 2)))
    with pytest.raises(ValueError, match="needs a vertex"):
        problem.add_edges(kind, [])
    with pytest.raises(TypeError, match="EdgeKind"):
        problem.add_edges(object(), [poses])
    with pytest.raises(gl.Error):  # twice the same vertex in one edge
        problem.add_edges(kind, [poses, poses], np.zeros((3, 2)))
    assert problem.num_edges == 0
    # One vertex, a Jacobian that is an array and not a tuple.

    class Square(gl.EdgeKind):
        residual_dim = 1

        def residual(self, x):
            return x**2 - 2.0

        def jacobian(self, x):
            return 2.0 * x[:, :, None]

    numbers = problem.add_vectors([[1.0], [3.0]])
    problem.add_edges(Square(), [numbers])
    assert problem.solve().converged
    np.testing.assert_allclose(problem.values(numbers)[:, 0], np.sqrt(2.0), rtol=1e-6)
