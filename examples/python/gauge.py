# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Gauge: what nothing observes
#
# A camera with an IMU sees neither where it began (3) nor its heading (1); the direction of gravity and the
# scale it does see. So the cost is the same along a 4-dimensional orbit. A solve can hold a keyframe
# ("fixed"), add a prior, or leave it to the damping ("free"): the answers are the same scene at different places.

# %%
import numpy as np

import glissade as gl
from glissade import plot

window = gl.make_window(num_keyframes=10, landmarks_per_keyframe=25, seed=1)
problem = gl.Problem()
handles = problem.add_window(window)
edges = problem.edges()
problem.remove_edges(edges[["Prior" in name for name in edges.names()]])  # they would say where the world is
poses, first = handles.poses, handles.poses[0]

# %%
report = problem.check_nullspace()
print(f"{report.group.name}: {len(report.directions)} directions")
for direction in report.directions:
    print(f"  {direction.name}: kappa {direction.kappa:.1e}")

# %% [markdown]
# ## Three ways, one answer

# %%
ways = {"free": gl.Gauge(), "fixed": gl.Gauge.fixed(first), "prior": gl.Gauge.prior(first, weight=1e5)}
solved = {}
for name, gauge in ways.items():
    solved[name] = problem.clone()
    summary = solved[name].solve(gauge=gauge, cost_tolerance=1e-14)
    print(f"{name:6} {len(summary.iterations) - 1} iterations, cost {summary.final_cost:.10f}")

# %% [markdown]
# The scenes lie apart by yaw and translation; moved to one gauge they are the same.

# %%
reference = solved["fixed"].values(poses)[:, :3]
for name in ("free", "prior"):
    apart = np.linalg.norm(solved[name].values(poses)[:, :3] - reference, axis=1).max()
    solved[name].move_to_gauge(gl.Gauge.fixed(first, reference=solved["fixed"].values(first)[0]))
    left = np.linalg.norm(solved[name].values(poses)[:, :3] - reference, axis=1).max()
    print(f"{name}: {apart:.1e} m from the fixed one as it is, {left:.1e} m in its gauge")

# %% [markdown]
# ## A covariance is one in a gauge
#
# Without a gauge there is no covariance: four directions have no information, and the call says so. Which
# keyframe is called certain changes every number. It is the same knowledge all the same: each can be
# transformed into the other (Zhang, Gallego, Scaramuzza, RA-L 2018, Eqs. 12 to 15).

# %%
scene = solved["fixed"]
try:
    scene.covariance(poses)
except gl.Error as error:
    print(error)

first_certain = scene.covariance(poses, gauge=gl.Gauge.fixed(first))
last_certain = scene.covariance(poses, gauge=gl.Gauge.fixed(poses[-1]))
transformed = first_certain.transform(gl.Gauge.fixed(poses[-1]))
named = {"first certain": first_certain, "last certain": last_certain, "first, transformed to last": transformed}
print("position sigma [mm] of the first, the middle and the last keyframe, largest axis:")
for name, covariance in named.items():
    sigma = 1e3 * np.sqrt(np.maximum(np.diag(covariance.matrix), 0.0)).reshape(-1, 6)[:, :3].max(axis=1)
    print(f"  {name:27} {sigma[0]:8.4f} {sigma[len(sigma) // 2]:8.4f} {sigma[-1]:8.4f}")
difference = np.linalg.norm(transformed.matrix - last_certain.matrix) / np.linalg.norm(last_certain.matrix)
print(f"transformed against computed: {difference:.1e} of the norm")

# %%
for name, covariance in list(named.items())[:2]:
    ax = plot.trajectory(scene.values(poses), covariance.matrix, sigmas=10)
    ax.set_title(f"{name}: positions with 10 sigma", fontsize=10)
    ax.figure.savefig(f"gauge_{name.replace(' ', '_')}.png")
    ax = plot.matrix(covariance.matrix, [(f"pose {k}", 6) for k in range(len(poses))],
                     label="log$_{10}$ |covariance|", title=name)
    ax.figure.savefig(f"gauge_covariance_{name.replace(' ', '_')}.png")
