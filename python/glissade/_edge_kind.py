# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Edges of your own, in Python."""

from __future__ import annotations

import typing

import numpy.typing as npt


class EdgeKind:
    """An edge whose residual is written in Python, for all edges of one add_edges() at once.

        class Range(EdgeKind):
            residual_dim = 1

            def residual(self, pose, point, measured):   # (n, 7), (n, 3), (n,)
                d = np.linalg.norm(point - pose[:, :3], axis=1)
                return (d - measured)[:, None]           # (n, 1)

        problem.add_edges(Range(), [poses[i], points[j]], measured, sqrt_information=10.0)

    residual() gets the states of each vertex, (n, numbers of the state), then the data of
    add_edges(), and returns (n, residual_dim): predicted - measured, not yet weighted. It must be a
    function of its arguments alone. A row with NaN has no value there: a step that leads to it is
    rejected.

    jacobian(), if given, returns an array (n, residual_dim, tangent) for each vertex, with respect
    to its tangent: of a pose [dp (world axes), dtheta (body axes)], 6; of all other types the
    numbers themselves. Without it, differences are taken: two calls of residual() for each number of
    each tangent. Problem.check_jacobian() compares the two.

    A kind that keeps its problem (self.problem = problem) is never freed: keep a weakref, or hand over
    what is needed as data.
    """

    residual_dim: int = 0

    def residual(self, *arguments: typing.Any) -> npt.ArrayLike:
        raise NotImplementedError(f"{type(self).__name__} needs a residual()")

    jacobian: typing.Any = None
