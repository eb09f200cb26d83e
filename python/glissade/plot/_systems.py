# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""The matrices that a solve works with: H, and the reduced system S."""

from __future__ import annotations

import itertools
import re
import typing

import numpy as np
import numpy.typing as npt

from . import _check, _figure
from ._matrix import MAX_PIXELS, fewer, label_groups, matrix
from .. import _core

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_ROWS = 6000
_NAMES = {
    "VertexPose": ("pose", "poses"),
    "VertexInverseDepth": ("inverse depth", "inverse depths"),
    "VertexPointXYZ": ("point", "points"),
    "VertexSpeedBias": ("speed, biases", "speeds, biases"),
    "VertexCameraBal": ("camera", "cameras"),
}


class System(typing.NamedTuple):
    """A symmetric matrix, (n, n), and the groups of its variables: name and number of rows."""

    matrix: _check.Array
    groups: list[tuple[str, int]]


def _groups(vertices: _core.VertexArray, offsets: list[int]) -> list[tuple[str, int]]:
    """Vertices of one type side by side as one group; up to six of several rows each by themselves."""
    sizes = np.diff(offsets[:len(vertices) + 1])
    labelled = [(re.sub(r" #\d+$", "", name), name.rpartition("#")[2], int(size))
                for name, size in zip(vertices.names(), sizes)]
    groups = []
    for kind, run in itertools.groupby(labelled, key=lambda item: item[0]):
        members = list(run)
        one, many = _NAMES.get(kind, (kind, kind))
        if len(members) <= 6 and members[0][2] > 1:
            groups += [(f"{one} {number}", size) for _, number, size in members]
        else:
            name = f"{len(members)} {many}" if len(members) > 1 else one
            groups.append((name, sum(size for _, _, size in members)))
    return groups


def _linearized(problem: _core.Problem) -> tuple[_core.Problem, list[int]]:
    """A copy linearized at the present values, and the offsets of its free vertices."""
    if not isinstance(problem, _core.Problem):
        raise ValueError(f"problem must be a glissade.Problem, not {type(problem).__name__}")
    copy = problem.clone()
    copy.make_hessian()
    offsets = copy.free_offsets()
    if offsets[-1] > MAX_ROWS:
        raise ValueError(f"problem has {offsets[-1]} free variables, too many for a dense matrix (at most "
                         f"{MAX_ROWS}): camera_pairs() draws the blocks of its reduced system")
    return copy, offsets


def hessian_system(problem: _core.Problem) -> System:
    """H = J'J at the present values over all free variables; the problem is not changed."""
    copy, offsets = _linearized(problem)
    return System(copy.hessian(), _groups(copy.free_vertices(), offsets))


def schur_system(problem: _core.Problem) -> System:
    """S = H_kk - H_ke H_ee^-1 H_ek: what is left for the kept variables (k) when those of the eliminated
    vertices (e, landmarks by default) are eliminated, undamped; the problem is not changed.

    An eliminated vertex without full information takes part by the pseudo-inverse of its block.
    """
    copy, offsets = _linearized(problem)
    vertices = copy.free_vertices()
    H = copy.hessian()
    num_kept = copy.solve(max_iterations=0).num_poses
    kept = offsets[num_kept]
    if kept == 0:
        raise ValueError("problem has no free vertices but eliminated ones: nothing is left of it")
    S = H[:kept, :kept].copy()
    for begin, end in zip(offsets[num_kept:-1], offsets[num_kept + 1:]):
        seen = np.flatnonzero(H[:kept, begin:end].any(axis=1))
        coupling = H[np.ix_(seen, np.arange(begin, end))]
        S[np.ix_(seen, seen)] -= coupling @ np.linalg.pinv(H[begin:end, begin:end], hermitian=True) @ coupling.T
    return System(S, _groups(vertices[:num_kept], offsets[:num_kept + 1]))


def hessian(problem: _core.Problem, *, decades: float = 6.0, ax: Axes | None = None) -> Axes:
    """Draws |H| = |J'J| at the present values, groups of variables named; the problem is not changed.

    Kept vertices come first, then eliminated ones: no edge joins two landmarks, so that their part is
    block-diagonal. decades: how far down from the largest entry the scale reaches. ValueError above 6000
    free variables.
    """
    H, groups = hessian_system(problem)
    return matrix(H, groups, decades=decades, ax=ax, label="log$_{10}$ |H$_{ij}$|",
                  title=f"H: {len(H)} variables, {_share(H)} not zero")


def schur(problem: _core.Problem, *, decades: float = 6.0, ax: Axes | None = None) -> Axes:
    """Draws |S|, what is left of H when landmarks are eliminated (schur_system())."""
    S, groups = schur_system(problem)
    return matrix(S, groups, decades=decades, ax=ax, label="log$_{10}$ |S$_{ij}$|",
                  title=f"S: {len(S)} variables, {_share(S)} not zero")


def _share(values: _check.Array) -> str:
    return f"{100 * np.count_nonzero(values) / values.size:.3g} %"


def shared_points(camera_indices: typing.Any, point_indices: typing.Any,
                  num_cameras: int | None = None) -> npt.NDArray[np.bool_]:
    """Which cameras see a point together: (n, n), symmetric, True on the diagonal.

    camera_indices, point_indices: (k,) integers from 0, one of each for an observation. These are the
    blocks of the reduced system that are not zero. Takes n^2 bytes.
    """
    camera, point = np.asarray(camera_indices), np.asarray(point_indices)
    for name, value in (("camera_indices", camera), ("point_indices", point)):
        if value.ndim != 1 or (value.size and (not np.issubdtype(value.dtype, np.integer) or value.min() < 0)):
            raise ValueError(f"{name} must be integers from 0 of the shape (k,)")
    if len(camera) != len(point):
        raise ValueError(f"point_indices has {len(point)} rows where {len(camera)} are needed")
    needed = int(camera.max(initial=-1)) + 1
    n = needed if num_cameras is None else num_cameras
    if n < needed:
        raise ValueError(f"num_cameras is {n}, but camera_indices has {needed - 1}")
    order = np.argsort(point, kind="stable")
    camera = camera[order]
    lengths = np.bincount(point) if len(point) else np.zeros(0, int)
    begin = np.cumsum(lengths) - lengths
    seen = np.eye(n, dtype=bool)
    for length in np.unique(lengths[lengths > 1]):  # all tracks of one length at once
        tracks = camera[begin[lengths == length][:, None] + np.arange(length)]
        for k in range(1, length):
            seen[tracks, np.roll(tracks, k, axis=1)] = True
    return seen


class _Shared(typing.NamedTuple):
    camera: npt.NDArray[np.int64]
    point: npt.NDArray[np.int64]
    num_cameras: int
    groups: list[tuple[str, int]]  # of cameras


def _shared(problem: _core.Problem | _core.BalProblem) -> _Shared:
    if isinstance(problem, _core.BalProblem):
        count = len(problem.cameras)
        return _Shared(problem.camera_indices, problem.point_indices, count, [("cameras", count)])
    if not isinstance(problem, _core.Problem):
        raise ValueError(f"problem must be a glissade.Problem or BalProblem, not {type(problem).__name__}")
    copy = problem.clone()
    num_kept = copy.solve(max_iterations=0).num_poses
    copy.make_hessian()
    vertices = copy.free_vertices()
    place = {vertex: k for k, vertex in enumerate(vertices)}
    camera, point, extra = [], [], len(vertices)
    for edge in copy.edges():
        places = [place[vertex] for vertex in copy.vertices_of(edge) if vertex in place]
        kept = [k for k in places if k < num_kept]
        landmark = next((k for k in places if k >= num_kept), extra)
        extra += landmark == extra  # an edge without a landmark joins its vertices by itself
        camera += kept
        point += [landmark] * len(kept)
    kinds = [re.sub(r" #\d+$", "", name) for name in vertices[:num_kept].names()]
    groups = [(_NAMES.get(kind, (kind, kind))[1], len(list(run))) for kind, run in itertools.groupby(kinds)]
    return _Shared(np.array(camera, np.int64), np.array(point, np.int64), num_kept, groups)


def camera_pairs(problem: _core.Problem | _core.BalProblem, *, ax: Axes | None = None) -> Axes:
    """Draws which blocks of the reduced system are not zero: which cameras (kept vertices) see a landmark
    together, or are joined by an edge. H is not formed densely: for problems of thousands of cameras.
    """
    from matplotlib.ticker import MaxNLocator

    camera, point, n, groups = _shared(problem)
    if n == 0:
        raise ValueError("problem has no free cameras")
    seen = shared_points(camera, point, n)
    ax = _figure.axes(ax, (5.4, 5.0))
    # A pixel is black where any block under it is there.
    shown = fewer(seen.astype(np.float64)) if n > MAX_PIXELS else seen
    ax.imshow(shown, cmap="gray_r", vmin=0, vmax=1, interpolation="antialiased" if n > 200 else "nearest",
              extent=(-0.5, n - 0.5, n - 0.5, -0.5))
    if len(groups) > 1:
        label_groups(ax, groups)
    else:
        ax.set_xlabel(groups[0][0])
        ax.set_ylabel(groups[0][0])
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(MaxNLocator(integer=True))
    ax.set_title(f"blocks of the reduced system: {100 * seen.mean():.3g} % of {n} x {n}", fontsize=10)
    return ax
