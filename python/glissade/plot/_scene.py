# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of points and cameras from above."""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

from . import _check, _figure, colors
from .. import _core, quaternions

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes


def scene(points: npt.ArrayLike, poses: npt.ArrayLike | None = None, *, errors: npt.ArrayLike | None = None,
          max_error: float = 4.0, forward: tuple[float, float, float] = (0.0, 0.0, 1.0), plane: str = "xy",
          label: str = "reprojection error of a point [px]", ax: Axes | None = None) -> Axes:
    """Draws points, and cameras as arrows in the direction that they look.

    points: (n, 3) [m]. poses: (m, 7) T_world_camera [m]. errors: (n,), colours the points, from zero
    (light) to max_error (dark); label says what they are. forward: the axis that cameras look
    along, in their own coordinates. plane: what is drawn, 'xy' from above. The view holds 98 % of the
    points, and all cameras.
    """
    X = _check.array("points", points, ("n", 3))
    T = None if poses is None else _check.array("poses", poses, ("m", 7))
    e = None if errors is None else _check.rows("errors", _check.array("errors", errors, ("n",)), len(X))
    _check.positive("max_error", max_error)
    i, j = _check.plane(plane)
    axis = _check.array("forward", forward, (3,))
    ax = _figure.axes(ax, (6.4, 5.2))
    size = float(np.clip(2000.0 / max(len(X), 1), 0.3, 12.0))
    if e is None:
        ax.scatter(X[:, i], X[:, j], s=size, color=colors.BLUE, linewidths=0, label="points")
    else:
        order = np.argsort(e)  # the worst on top
        shown = ax.scatter(X[order, i], X[order, j], c=e[order], s=size, linewidths=0, cmap="plasma_r", vmin=0.0,
                           vmax=max_error, label="points")
        ax.figure.colorbar(shown, ax=ax, shrink=0.75, label=label, extend="max")
    held = X[np.isfinite(X).all(axis=1)]
    corners = [np.quantile(held, share, axis=0) for share in (0.01, 0.99)] if len(held) else []
    if T is not None and len(T):
        direction = quaternions.rotate(T[:, 3:], np.broadcast_to(axis, (len(T), 3)))
        ax.quiver(T[:, i], T[:, j], direction[:, i], direction[:, j], color=colors.BLACK, angles="xy",
                  scale=25.0 if len(T) <= 200 else 70.0, width=0.004 if len(T) < 100 else 0.0012, label="cameras")
        corners += [T[:, :3].min(axis=0), T[:, :3].max(axis=0)]
    if corners:
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        margin = 0.05 * max(float((high - low).max()), 1e-9)
        ax.set_xlim(low[i] - margin, high[i] + margin)
        ax.set_ylim(low[j] - margin, high[j] + margin)
    ax.set_aspect("equal")
    return _figure.finish(ax, f"{plane[0]} [m]", f"{plane[1]} [m]")


def bal_poses(cameras: npt.ArrayLike) -> _check.Array:
    """Poses T_world_camera, (n, 7), of cameras as BAL files have them.

    cameras: (n, 9), rotation vector and translation from the world to the camera, f, k1, k2. Such a camera
    looks along its negative z axis.
    """
    c = _check.array("cameras", cameras, ("n", 9))
    to_world = quaternions.inverse(quaternions.exp(c[:, :3]))
    return np.concatenate([-quaternions.rotate(to_world, c[:, 3:6]), to_world], axis=1)


def bal_scene(bal: _core.BalProblem, *, max_error: float = 4.0, plane: str = "xy", title: str | None = None,
              ax: Axes | None = None) -> Axes:
    """Draws a bundle adjustment problem: points by the rms of their reprojection errors [px], and cameras."""
    if not isinstance(bal, _core.BalProblem):
        raise ValueError(f"bal must be a glissade.BalProblem, not {type(bal).__name__}")
    problem, _, points, edges = _core.Problem.from_bal(bal)
    count = np.bincount(bal.point_indices, minlength=len(points))
    squares = problem.chi2(edges)
    error = np.sqrt(np.bincount(bal.point_indices, squares, len(points)) / np.maximum(count, 1))
    ax = scene(bal.points, bal_poses(bal.cameras), errors=error, max_error=max_error, forward=(0.0, 0.0, -1.0),
               plane=plane, ax=ax)
    what = f"rms {np.sqrt(squares.mean()):.3g} px" if len(squares) else "no observations"
    ax.set_title(f"{title}: {what}" if title else what, fontsize=10)
    return ax
