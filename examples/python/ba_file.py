# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # A bundle adjustment file, before and after
#
# Reads a problem in the format of "Bundle Adjustment in the Large" (text, .gz, .bz2 or .bbal), solves it and
# draws it. The environment variable `BAL_FILE` names one; without it a city of 100 cameras is simulated, with 5 % of
# wrong observations. (A COLMAP model: `glissade.Problem.from_colmap(folder)`.)

# %%
import os

import numpy as np

import glissade as gl
from glissade import plot

name = os.environ.get("BAL_FILE")
bal = gl.read_bal(name) if name else gl.make_city(num_cameras=100, outlier_share=0.05, seed=1)
print(f"{len(bal.cameras)} cameras, {len(bal.points)} points, {len(bal.uv)} observations")
per_point = np.bincount(bal.point_indices)
print(f"a point is seen by {per_point.min()} to {per_point.max()} cameras, {per_point.mean():.2f} on average")

# %%
plot.bal_scene(bal, title="before").figure.savefig("ba_before.png")
plot.camera_pairs(bal).figure.savefig("ba_pairs.png")

# %% [markdown]
# ## Two losses
#
# Squares let a wrong observation pull with all its weight; a robust loss does not. The same problem with both:

# %%
summaries = {}
problems = {}
for label, loss in {"squares": gl.Loss(), "Cauchy, 1 px": gl.Cauchy(1.0)}.items():
    problem, cameras, points, edges = gl.Problem.from_bal(bal, loss=loss)
    problems[label] = problem
    summaries[label] = problem.solve(max_iterations=30, num_threads=2)
    errors = np.sqrt(problem.chi2(edges))
    print(f"{label}: {summaries[label].brief_report()}")
    print(f"  reprojection error [px]: median {np.median(errors):.3f}, 90 % under {np.quantile(errors, 0.9):.3f}")
print(summaries["squares"].linear_solver, "because", summaries["squares"].linear_solver_reason)

# %%
plot.convergence(summaries["Cauchy, 1 px"]).figure.savefig("ba_convergence.png")

# %% [markdown]
# ## Taking the wrong ones out
#
# After the robust solve wrong observations stand out: `outliers()` finds those of more than 9.21 (99 % of two
# degrees of freedom) and those behind a camera. The noise here is 0.5 px, the weights say 1: a squared error
# of 9.21 is a length of 3 px.

# %%
problem = problems["Cauchy, 1 px"]
wrong = problem.outliers()
print(f"{len(wrong)} of {problem.num_edges} observations are taken out ({100 * len(wrong) / problem.num_edges:.1f} %)")
ax = plot.residuals(problem, upper=6.0)
ax.figure.savefig("ba_residuals.png")
problem.remove_edges(wrong)
summary = problem.solve(max_iterations=30, num_threads=2)
chi2 = problem.chi2(problem.edges())
print(f"then rms {np.sqrt(chi2.mean() / 2):.3f} px a coordinate")

# %%
problem.to_bal("ba_solved.bbal")
problem.to_ply("ba_solved.ply")  # for MeshLab
plot.bal_scene(gl.read_bal("ba_solved.bbal"), title="after").figure.savefig("ba_after.png")
