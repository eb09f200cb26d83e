# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sparse bundle adjustment and sliding-window visual-inertial estimation.

    import glissade

    problem, cameras, points, edges = glissade.Problem.from_bal(glissade.make_ring())
    summary = problem.solve()
    print(summary)

Frames and units: poses are T_world_body, 7 numbers, position [m] and unit quaternion x y z w
(Hamilton); their tangent is [dp (world axes), dtheta (body axes)]. SI units; stamps in integer
nanoseconds. Calls that are refused raise glissade.Error.
"""

from ._core import *  # noqa: F403
from ._core import version as _version
from ._edge_kind import EdgeKind as EdgeKind
from ._errors import Error as Error

__version__: str = _version
