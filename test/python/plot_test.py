# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""glissade.plot: what is drawn, from small made data; warnings are errors."""

import pathlib
import subprocess
import sys

import numpy as np
import pytest

import glissade as gl
from glissade import quaternions

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from glissade import plot  # noqa: E402

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(autouse=True)
def drawn_and_closed():
    """Every picture is rendered: much goes wrong only then. Nothing changes the settings."""
    settings = dict(matplotlib.rcParams)
    yield
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()
    plt.close("all")
    assert dict(matplotlib.rcParams) == settings


def course():
    problem = gl.Problem()
    return problem, problem.add_course_scene()


def ticks(ax):
    return [text.get_text() for text in ax.get_yticklabels()]


def test_colours_differ_in_greyscale():
    def lightness(color):
        rgb = np.array(matplotlib.colors.to_rgb(color))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return 116 * np.cbrt(np.dot([0.2126, 0.7152, 0.0722], linear) + 1e-9) - 16

    levels = sorted(lightness(plot.colors.series(k).color) for k in range(5))
    assert min(np.diff(levels)) > 9 and levels[-1] < 80
    assert len({plot.colors.series(k) for k in range(5)}) == 5 and plot.colors.series(5) == plot.colors.series(0)
    assert len(set(plot.colors.sequence(4))) == 4


def test_hessian_of_the_course():
    problem, _ = course()
    cost = problem.cost()
    ax = plot.hessian(problem, decades=5)
    assert ticks(ax) == ["pose 0", "pose 1", "pose 2", "20 inverse depths"]
    image = ax.images[0]
    assert image.get_array().shape == (38, 38)
    low, high = image.get_clim()
    assert high - low == pytest.approx(5)
    # No edge joins pose 1 to pose 2: a white block. The depths are a diagonal.
    drawn = ~np.ma.getmaskarray(image.get_array())
    assert not drawn[6:12, 12:18].any() and drawn[:6, 6:12].any()
    np.testing.assert_array_equal(drawn[18:, 18:], np.eye(20, dtype=bool))
    assert "38 variables" in ax.get_title()
    # The problem is as it was: nothing has been linearized in it.
    assert problem.hessian().shape == (0, 0) and problem.cost() == cost


def test_schur_complement_is_what_a_dense_inverse_says():
    problem, _ = course()
    S, groups = plot.schur_system(problem)
    H, _ = plot.hessian_system(problem)
    expected = H[:18, :18] - H[:18, 18:] @ np.linalg.inv(H[18:, 18:]) @ H[18:, :18]
    np.testing.assert_allclose(S, expected, atol=1e-12 * np.abs(H).max())
    assert groups == [("pose 0", 6), ("pose 1", 6), ("pose 2", 6)]
    # The gauge of one camera: 7 directions that nothing observes.
    assert np.sum(np.linalg.eigvalsh(S) < 1e-10 * np.abs(S).max()) == 7
    ax = plot.schur(problem)
    assert "S: 18 variables, 100 % not zero" == ax.get_title()


def test_groups_of_a_visual_inertial_window(window):
    problem = gl.Problem()
    problem.add_window(window)
    assert ticks(plot.schur(problem)) == ["10 poses", "10 speeds, biases"]
    ax = plot.camera_pairs(problem)
    assert ticks(ax) == ["poses", "speeds, biases"]
    # Blocks that are not zero are those of S.
    S, _ = plot.schur_system(problem)
    begin = [6 * k for k in range(10)] + [60 + 9 * k for k in range(10)]
    size = [6] * 10 + [9] * 10
    blocks = [[S[a:a + m, b:b + n].any() for b, n in zip(begin, size)] for a, m in zip(begin, size)]
    np.testing.assert_array_equal(np.asarray(ax.images[0].get_array(), bool), blocks)


def test_pairs_of_a_file_and_of_its_problem():
    bal = gl.make_city(num_cameras=30)
    seen = plot.shared_points(bal.camera_indices, bal.point_indices)
    assert seen.shape == (30, 30) and (seen == seen.T).all() and seen.diagonal().all()
    by_hand = np.eye(30, dtype=bool)
    for point in range(len(bal.points)):
        cameras = bal.camera_indices[bal.point_indices == point]
        by_hand[np.ix_(cameras, cameras)] = True
    np.testing.assert_array_equal(seen, by_hand)
    for given in (bal, gl.Problem.from_bal(bal)[0]):
        ax = plot.camera_pairs(given)
        np.testing.assert_array_equal(np.asarray(ax.images[0].get_array(), bool), by_hand)
        assert f"{100 * by_hand.mean():.3g} % of 30 x 30" in ax.get_title() and ax.get_xlabel() == "cameras"


def test_matrix_scale_groups_and_size():
    values = np.array([[1000.0, -1.0], [0.0, 1e-9]])
    ax = plot.matrix(values, [("a", 1), ("b", 1)], decades=4, title="M")
    array = ax.images[0].get_array()
    assert array[0, 0] == pytest.approx(3) and array[0, 1] == pytest.approx(0) and array.mask[1, 0]
    assert ax.images[0].get_clim() == pytest.approx((-1, 3)) and ax.get_title() == "M"
    assert len(ax.lines) == 2 and len(ax.figure.axes) == 2
    assert plot.matrix(np.zeros((3, 3)), colorbar=False).images[0].get_array().mask.all()
    # One entry of many is still seen in a picture of fewer pixels.
    large = np.zeros((3200, 3200))
    large[17, 2999] = 2.0
    shown = plot.matrix(large).images[0].get_array()
    assert max(shown.shape) <= 1500 and shown.count() == 1
    unit = plot.scaled_to_unit_diagonal([[4.0, 2.0], [2.0, 0.0]])
    np.testing.assert_array_equal(unit, [[1.0, 0.0], [0.0, 0.0]])


def test_convergence_of_one_and_of_several():
    problem, handles = course()
    other = problem.clone()
    problem.fix(handles.poses[:2])
    other.fix(handles.poses[:2])
    a, b = problem.solve(), other.solve(method=gl.Method.DOGLEG)
    ax = plot.convergence(a)
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), [it.cost for it in a.iterations])
    assert ax.get_yscale() == "log" and ax.get_xlabel() == "iteration" and ax.get_legend() is None
    ax = plot.convergence({"LM": a.to_dict(), "dogleg": b}, against="time", excess=True)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["LM", "dogleg"]
    assert ax.lines[0].get_ydata()[0] == pytest.approx(1) and ax.get_xlabel() == "time [s]"
    rejected = a.to_dict()
    rejected["iterations"][1]["accepted"] = False
    assert len(plot.convergence(rejected).lines) == 3


def test_trajectory_and_its_ellipses(window):
    problem = gl.Problem()
    handles = problem.add_window(window)
    gauge = gl.Gauge.fixed(handles.poses[0])
    problem.solve(gauge=gauge)
    covariance = problem.covariance(handles.poses, gauge=gauge).matrix
    poses = problem.values(handles.poses)
    ax = plot.trajectory(poses, covariance, window.true_poses, sigmas=2)
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert names == ["truth", "estimate", "2 sigma", "start"]
    assert len(ax.collections[0].get_paths()) == 10
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("x [m]", "y [m]", 1.0)
    blocks = np.array([covariance[6 * k:6 * k + 6, 6 * k:6 * k + 6] for k in range(10)])
    blocks[4, 0, 0] = np.nan
    ax = plot.trajectory(poses[:, :3], blocks, plane="xz", max_ellipses=5)
    assert len(ax.collections[0].get_paths()) in (4, 5) and ax.get_ylabel() == "z [m]"
    outline = plot.ellipse_outlines([[1.0, 2.0]], [[[4.0, 0.0], [0.0, 1.0]]], sigmas=3)[0]
    np.testing.assert_allclose(np.ptp(outline, axis=0), [12, 6], rtol=1e-2)
    np.testing.assert_allclose(outline[0], outline[-1])
    np.testing.assert_allclose(outline[:-1].mean(axis=0), [1, 2], atol=1e-12)


def test_errors_count_what_is_inside():
    t = np.arange(100.0)
    sigma = np.full((100, 2), 0.5)
    error = np.zeros((100, 2))
    error[:10, 0] = 2.0
    error[99] = np.nan
    ax = plot.errors(t, error, sigma, ylabel="error [m]", what="position")
    assert ax.get_title() == f"position: {100 * (1 - 10 / 198):.1f} % within 3 sigma"
    assert ax.get_ylabel() == "error [m]" and [line.get_label() for line in ax.lines] == ["x", "y"]
    assert plot.errors(t, error[:, 0], sigma[:, 0]).lines[0].get_label() == "x"
    ax = plot.band([1, 2], [0, 0], [1, 1], [2, 3], label="a")
    assert len(ax.collections) == 1 and len(ax.lines) == 1


def test_residuals_against_chi():
    for dim in (1, 2, 6, 15):
        x = np.linspace(0, 12, 20001)
        density = plot.chi_density(x, dim)
        assert np.sum(density) * x[1] == pytest.approx(1, abs=1e-3)
        assert np.sum(density * x**2) * x[1] == pytest.approx(dim, rel=1e-3)
    norms = np.sqrt((np.random.default_rng(1).normal(size=(20000, 2)) ** 2).sum(axis=1))
    ax = plot.residual_norms(norms, 2)
    heights = np.array([bar.get_height() for bar in ax.patches])
    centres = np.array([bar.get_x() + 0.5 * bar.get_width() for bar in ax.patches])
    np.testing.assert_allclose(heights, plot.chi_density(centres, 2), atol=0.05)
    assert sum(bar.get_height() * bar.get_width() for bar in ax.patches) == pytest.approx(1)
    problem, handles = course()
    problem.fix(handles.poses[:2])
    ax = plot.residuals(problem, handles.reprojections, bins=20)
    assert len(ax.patches) == 20 and "2 degrees of freedom" in ax.get_legend().get_texts()[0].get_text()
    assert f"{len(handles.reprojections)} EdgeReprojection" in ax.get_legend().get_texts()[1].get_text()


def test_scene_and_where_bal_cameras_are():
    bal = gl.make_ring(num_cameras=6, num_points=40)
    poses = plot.bal_poses(bal.cameras)
    back = -quaternions.rotate(quaternions.inverse(poses[:, 3:]), poses[:, :3])
    np.testing.assert_allclose(back, bal.cameras[:, 3:6], atol=1e-12)
    # All cameras of a ring look at its middle.
    looks = quaternions.rotate(poses[:, 3:], np.tile([0.0, 0.0, -1.0], (6, 1)))
    assert np.all(np.sum(looks * (bal.points.mean(axis=0) - poses[:, :3]), axis=1) > 0)
    ax = plot.bal_scene(bal, title="ring")
    assert ax.get_title().startswith("ring: rms ") and len(ax.collections[0].get_offsets()) == 40
    assert len(ax.collections[1].get_offsets()) == 6
    ax = plot.scene(bal.points, plane="xz")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "z [m]") and len(ax.collections) == 1


def sweep(fixed=True):
    def trials(error):
        steps = [{"prior_position_error_m": 0.1 * k, "prior_rotation_error_rad": 0.01 * k,
                  "reprojection_error": 10.0 ** -k} for k in range(3)]
        return [{"pose_error_m": error * s, "point_error_per_m": error * s, "iterations": 5 + s, "time_ms": 2.0 + s,
                 "steps": steps} for s in (1, 2, 3)]

    rows = [{"fixed": False, "weight": w, "trials": trials(0.1 + 1.0 / w)} for w in (1e4, 1.0, 100.0)]
    rows += [{"fixed": False, "weight": 0, "trials": trials(0.2)}]
    rows += [{"fixed": True, "weight": None, "trials": trials(0.1)}] if fixed else []
    return {"rows": rows, "pose_noise_m_rad": 0.1}


def test_prior_weights():
    figure = plot.prior_weights(sweep(), sweep())
    assert len(figure.axes) == 3
    line = figure.axes[0].lines[0]
    np.testing.assert_array_equal(line.get_xdata(), [1, 100, 1e4])
    np.testing.assert_allclose(line.get_ydata(), [2200, 220, 200.2])  # medians, mm
    assert figure.axes[0].get_xscale() == "log" and "mm" in figure.axes[0].get_ylabel()
    assert len(plot.prior_weights(sweep(fixed=False)).axes) == 2
    poses_only = {"rows": [{**row, "trials": [{"pose_error_m": 1.0}]} for row in sweep()["rows"]]}
    assert [ax.get_ylabel() for ax in plot.prior_weights(poses_only).axes][0] == "pose error [mm]"
    assert len(plot.prior_weights(poses_only).axes) == 2
    assert len(plot.prior_weight_time(sweep()).axes) == 2
    figure = plot.prior_weight_path(sweep(), weights=[1.0])
    assert [text.get_text() for text in figure.axes[1].get_legend().get_texts()] == ["no prior", "w = 1", "start"]


@pytest.mark.parametrize(("call", "says"), [
    (lambda p: plot.hessian(3), "problem must be a glissade.Problem, not int"),
    (lambda p: plot.schur(None), "problem"),
    (lambda p: plot.camera_pairs("x"), "problem"),
    (lambda p: plot.shared_points([0, 1], [0]), "point_indices has 1 rows where 2 are needed"),
    (lambda p: plot.shared_points([0, -1], [0, 0]), "camera_indices"),
    (lambda p: plot.shared_points([0, 5], [0, 0], 3), "num_cameras is 3"),
    (lambda p: plot.matrix(np.zeros(3)), r"values must have the shape \(n, m\), not \(3,\)"),
    (lambda p: plot.matrix(np.zeros((0, 0))), "values"),
    (lambda p: plot.matrix(np.eye(3), [("a", 2)]), "groups has 2 rows"),
    (lambda p: plot.matrix(np.eye(3), decades=0), "decades"),
    (lambda p: plot.scaled_to_unit_diagonal(np.zeros((2, 3))), "values must be square"),
    (lambda p: plot.convergence(3), "summary"),
    (lambda p: plot.convergence({}), "summary"),
    (lambda p: plot.convergence({"a": 3}), r"summary\['a'\]"),
    (lambda p: plot.convergence(p.clone().solve(), against="cost"), "against"),
    (lambda p: plot.trajectory(np.zeros((3, 6))), r"poses must have the shape \(n, 7\) or \(n, 3\)"),
    (lambda p: plot.trajectory(np.zeros((3, 3)), np.zeros((2, 3, 3))), "covariance has 2 rows"),
    (lambda p: plot.trajectory(np.zeros((3, 3)), np.zeros((8, 8))), "covariance of 3 poses"),
    (lambda p: plot.trajectory(np.zeros((3, 3)), truth=np.zeros(3)), "truth"),
    (lambda p: plot.trajectory(np.zeros((3, 3)), plane="xx"), "plane"),
    (lambda p: plot.trajectory(np.zeros((3, 3)), max_ellipses=0), "max_ellipses"),
    (lambda p: plot.ellipses([[0, 0]], [[[np.nan, 0], [0, 1]]]), "covariances must be finite"),
    (lambda p: plot.ellipses([[0, 0]], [np.eye(2)], sigmas=-1), "sigmas"),
    (lambda p: plot.errors([0, 1], [[0, 0]], [[1, 1]]), "error has 1 rows"),
    (lambda p: plot.errors([0, 1], [0, 0], [1, 1, 1]), "sigma must have the shape of error"),
    (lambda p: plot.band([0, 1], [0], [0, 0], [0, 0]), "low has 1 rows"),
    (lambda p: plot.residuals(p, p.edges()[[]]), "edges is empty"),
    (lambda p: plot.residuals(3), "problem"),
    (lambda p: plot.residual_norms([-1.0], 2), "norms"),
    (lambda p: plot.residual_norms([1.0], 0), "dim"),
    (lambda p: plot.residual_norms([1.0], 2, bins=0), "bins"),
    (lambda p: plot.scene(np.zeros((3, 2))), "points"),
    (lambda p: plot.scene(np.zeros((3, 3)), errors=[1.0]), "errors has 1 rows"),
    (lambda p: plot.bal_scene(p), "bal must be"),
    (lambda p: plot.bal_poses(np.zeros((2, 6))), "cameras"),
    (lambda p: plot.prior_weights(), "sweeps"),
    (lambda p: plot.prior_weights({"rows": []}), "no weights above 0"),
    (lambda p: plot.prior_weights({}), "sweep must be a dict"),
    (lambda p: plot.prior_weight_time({"rows": [{"fixed": False, "weight": 1, "trials": [{}]}]}), "iterations"),
    (lambda p: plot.prior_weight_path({"rows": [{"fixed": False, "weight": 1, "trials": [{}]}]}), "no steps"),
])
def test_wrong_arguments_are_named(call, says):
    problem, handles = course()
    problem.fix(handles.poses[:2])
    with pytest.raises(ValueError, match=says):
        call(problem)


def test_a_type_of_edge_whose_rows_are_not_known_needs_dim():
    class First(gl.EdgeKind):
        residual_dim = 1

        def residual(self, x):
            return x[:, :1]

    problem = gl.Problem()
    edges = problem.add_edges(First(), [problem.add_vectors(np.ones((5, 2)))])
    with pytest.raises(ValueError, match="dim must be given"):
        plot.residuals(problem, edges)
    assert len(plot.residuals(problem, edges, dim=1, bins=7).patches) == 7


def test_quaternions():
    random = np.random.default_rng(4)
    w = random.normal(size=(50, 3))
    q = quaternions.exp(w)
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1)
    short = np.linalg.norm(w, axis=1) < np.pi
    np.testing.assert_allclose(quaternions.log(q)[short], w[short], atol=1e-12)
    np.testing.assert_allclose(quaternions.log(quaternions.exp(1e-12 * w)), 1e-12 * w, rtol=1e-9)
    p, v = quaternions.exp(random.normal(size=(50, 3))), random.normal(size=(50, 3))
    np.testing.assert_allclose(quaternions.rotate(quaternions.multiply(p, q), v),
                               quaternions.rotate(p, quaternions.rotate(q, v)), atol=1e-12)
    np.testing.assert_allclose(quaternions.rotate(quaternions.inverse(q), quaternions.rotate(q, v)), v, atol=1e-12)
    angles = np.array([[0.0, 0.0, 0.7], [0.0, 0.0, -2.0]])
    np.testing.assert_allclose(quaternions.yaw(-quaternions.exp(angles)), angles[:, 2])
    times = np.array([10, 20])
    mixed = quaternions.interpolate([0, 10, 15, 20, 99], times, np.stack([q[0], -q[1]]))
    np.testing.assert_allclose(np.abs(np.sum(mixed[[0, 1, 3, 4]] * q[[0, 0, 1, 1]], axis=1)), 1)
    apart = quaternions.multiply(quaternions.inverse(mixed[[2, 2]]), q[:2])
    half = np.linalg.norm(quaternions.log(apart), axis=1)
    assert half[0] == pytest.approx(half[1])


def test_without_matplotlib_the_error_says_what_to_install(tmp_path):
    (tmp_path / "matplotlib.py").write_text("raise ImportError('none here')")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import glissade; import glissade.plot"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and 'pip install "glissade[plot]"' in done.stderr.splitlines()[-1]
    assert pathlib.Path(gl.__file__).parent.name == "glissade"
