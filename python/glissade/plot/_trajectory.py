# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories from above, with what is known about their positions."""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

from . import _check, _figure, colors

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes


def ellipse_outlines(centres: npt.ArrayLike, covariances: npt.ArrayLike, sigmas: float = 3.0,
                     points: int = 60) -> _check.Array:
    """Outlines of covariance ellipses, (n, points, 2), closed.

    centres: (n, 2). covariances: (n, 2, 2), symmetric; a negative eigenvalue, which is rounding, counts as
    zero. sigmas: half axes in standard deviations. In two dimensions 3 sigma hold 98.9 %, not 99.7 %.
    """
    c = _check.array("centres", centres, ("n", 2))
    P = _check.rows("covariances", _check.array("covariances", covariances, ("n", 2, 2)), len(c))
    _check.positive("sigmas", sigmas)
    if not np.isfinite(P).all():
        raise ValueError("covariances must be finite")
    values, vectors = np.linalg.eigh(P)
    half = vectors * (sigmas * np.sqrt(np.maximum(values, 0.0)))[:, None, :]
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    return typing.cast(_check.Array, c[:, None, :] + np.swapaxes(half @ circle, 1, 2))


def ellipses(centres: npt.ArrayLike, covariances: npt.ArrayLike, *, sigmas: float = 3.0, color: str = colors.BLUE,
             label: str | None = None, fill: bool = True, ax: Axes | None = None) -> Axes:
    """Draws covariance ellipses; arguments as of ellipse_outlines()."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgba

    outlines = ellipse_outlines(centres, covariances, sigmas)
    ax = _figure.axes(ax)
    ax.add_collection(PolyCollection(list(outlines), facecolors=to_rgba(color, 0.18) if fill else "none",
                                     edgecolors=color, linewidths=0.9, label=label))
    ax.autoscale_view()
    return ax


def _positions(name: str, poses: npt.ArrayLike) -> _check.Array:
    return _check.array(name, poses, ("n", 7), ("n", 3))[:, :3]


def _position_covariances(covariance: npt.ArrayLike, count: int, axes: tuple[int, int]) -> _check.Array:
    """(n, 2, 2) of blocks (n, k, k), or of a joint covariance (k n, k n), k = 3 or 6 or more."""
    P = _check.array("covariance", covariance, ("n", "k", "k"), ("n", "n"))
    if P.ndim == 2:
        k = P.shape[0] // max(count, 1)
        if P.shape[0] != P.shape[1] or count * k != len(P):
            raise ValueError(f"covariance of {count} poses must have rows and columns for each, not {P.shape}")
        P = np.stack([P[k * i:k * i + k, k * i:k * i + k] for i in range(count)])
    _check.rows("covariance", P, count)
    if P.shape[1] != P.shape[2] or P.shape[1] < 3:
        raise ValueError(f"covariance must have blocks of at least 3 x 3, position first, not {P.shape[1:]}")
    return P[:, list(axes)][:, :, list(axes)]


def trajectory(poses: npt.ArrayLike, covariance: npt.ArrayLike | None = None, truth: npt.ArrayLike | None = None, *,
               plane: str = "xy", sigmas: float = 3.0, max_ellipses: int = 40, label: str = "estimate",
               color: str = colors.BLUE, ax: Axes | None = None) -> Axes:
    """Draws positions from above, the start marked, with covariance ellipses and the truth.

    poses: (n, 7) T_world_body or (n, 3) positions [m]. covariance: of their tangents, position first, world
    axes [m^2]: (n, k, k) with k = 3, 6, ..., or the joint one of Problem.covariance(poses).matrix,
    (6 n, 6 n). Of many poses at most max_ellipses ellipses are drawn, evenly; rows with NaN have none.
    truth: (m, 7) or (m, 3), in the same world. plane: what is drawn, 'xy' from above. sigmas: half axes of
    the ellipses; 3 sigma in a plane hold 98.9 %.
    """
    p = _positions("poses", poses)
    i, j = _check.plane(plane)
    if max_ellipses < 1:
        raise ValueError(f"max_ellipses must be at least 1, not {max_ellipses}")
    P = None if covariance is None else _position_covariances(covariance, len(p), (i, j))
    t = None if truth is None else _positions("truth", truth)
    ax = _figure.axes(ax, (6.0, 5.0))
    if t is not None:
        ax.plot(t[:, i], t[:, j], color=colors.GREY, linewidth=2.4, alpha=0.8, label="truth")
    ax.plot(p[:, i], p[:, j], color=color, linewidth=1.2, label=label)
    if P is not None and len(p):
        shown = np.unique(np.linspace(0, len(p) - 1, min(max_ellipses, len(p))).round().astype(int))
        shown = shown[np.isfinite(P[shown]).all(axis=(1, 2))]
        if len(shown):
            ellipses(p[shown][:, [i, j]], P[shown], sigmas=sigmas, color=color, label=f"{sigmas:g} sigma", ax=ax)
    if len(p):
        ax.plot(p[0, i], p[0, j], "o", color=colors.BLACK, markersize=5, label="start")
    ax.set_aspect("equal", adjustable="datalim")
    ax.legend(fontsize=8)
    return _figure.finish(ax, f"{plane[0]} [m]", f"{plane[1]} [m]")
