# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of problems, solves and trajectories; needs matplotlib: pip install "glissade[plot]".

    from glissade import plot

    plot.convergence(problem.solve())
    ax = plot.hessian(problem)
    ax.figure.savefig("hessian.png")

A function draws on the axes it is given (ax=...) or on new ones, and returns them; those that need several
return their Figure. None of them shows a window, changes matplotlib's settings, or changes a problem. An
argument that cannot be drawn is a ValueError that names it.
"""

from . import colors
from ._bands import band, errors
from ._convergence import convergence
from ._figure import finish, plain_ticks
from ._matrix import label_groups, matrix, scaled_to_unit_diagonal
from ._prior_weight import prior_weight_path, prior_weight_time, prior_weights, step_paths
from ._residuals import chi_density, residual_norms, residuals
from ._scene import bal_poses, bal_scene, scene
from ._systems import System, camera_pairs, hessian, hessian_system, schur, schur_system, shared_points
from ._trajectory import ellipse_outlines, ellipses, trajectory

__all__ = [
    "System", "bal_poses", "bal_scene", "band", "camera_pairs", "chi_density", "colors", "convergence",
    "ellipse_outlines", "ellipses", "errors", "finish", "hessian", "hessian_system", "label_groups", "matrix",
    "plain_ticks", "prior_weight_path", "prior_weight_time", "prior_weights", "residual_norms", "residuals",
    "scaled_to_unit_diagonal", "scene", "schur", "schur_system", "shared_points", "step_paths", "trajectory",
]
