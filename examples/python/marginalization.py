# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Marginalization
#
# A sliding window stays small because old keyframes leave it. What they knew about the others stays as a
# *prior*: their variables are eliminated from the linear system, as landmarks are by the Schur complement,
# and what is left is kept as a residual $r(x) = r_0 + J (x \boxminus x_0)$ on the variables that they touched.
#
# Here the oldest keyframe of a visual-inertial window goes, with the landmarks that it hosts.

# %%
import numpy as np

import glissade as gl
from glissade import plot

window = gl.make_window(num_keyframes=10, landmarks_per_keyframe=25, seed=3)
problem = gl.Problem()
handles = problem.add_window(window)
problem.solve(cost_tolerance=1e-14)
print(f"{problem.num_vertices} vertices, {problem.num_edges} edges, cost {problem.cost():.6g}")

# %%
landmark, host, *_ = window.observations()
host_of = np.zeros(len(handles.depths), int)
host_of[landmark] = host
going = handles.poses[0] + handles.speed_biases[0] + handles.depths[host_of == 0]
print(f"going: {len(going)} vertices")

# %% [markdown]
# `marginal_prior()` computes the prior and changes nothing: as numbers.

# %%
prior = problem.marginal_prior(going)
touched = [name.split()[0] for name in prior.vertices.names()]
print(f"J is {prior.jacobian.shape[0]} x {prior.jacobian.shape[1]}, on",
      ", ".join(f"{touched.count(kind)} {kind}" for kind in sorted(set(touched))))
print(f"{prior.report.folded_edges} edges folded, {prior.report.eliminated_landmarks} landmarks among what went")

# %% [markdown]
# ## What it does to the matrix
#
# Before: a pose is tied to those that share landmarks with it, speed and biases to their neighbours. After:
# everything that the oldest keyframe touched is tied to everything else that it touched. That is the price:
# the prior is dense.

# %%
after = problem.clone()
done = after.marginalize(going)

before_H, after_H = plot.hessian_system(problem), plot.hessian_system(after)
for name, (H, groups) in {"before": before_H, "after": after_H}.items():
    ax = plot.matrix(plot.scaled_to_unit_diagonal(H), groups,
                     label="log$_{10}$ |H$_{ij}$| / (H$_{ii}$ H$_{jj}$)$^{1/2}$", title=f"{name}: {len(H)} variables")
    ax.figure.savefig(f"marginalization_{name}.png")
for name, (S, _) in {"before": plot.schur_system(problem), "after": plot.schur_system(after)}.items():
    print(f"{name}: the reduced system is {len(S)} x {len(S)}, {100 * np.mean(S != 0):.0f} % not zero")

# %% [markdown]
# ## What it keeps
#
# At the point of linearization nothing is lost: the rest of the window has the same optimum as before, and
# the same covariance.

# %%
stays = handles.poses[1:]
values = problem.values(stays)
after.solve(cost_tolerance=1e-14)
moved = np.linalg.norm(after.values(stays)[:, :3] - values[:, :3], axis=1).max()
print(f"the optimum has moved by {moved:.1e} m")

newest = handles.poses[-1]
sigma = [np.sqrt(np.diag(p.covariance(newest).matrix)[:3]) for p in (problem, after)]
print("sigma of the newest position [mm]: before", 1e3 * sigma[0].round(6), "after", 1e3 * sigma[1].round(6))

# %% [markdown]
# Dropping the keyframe with its edges instead loses what it knew. The scene is then tied to nothing, and the
# covariance needs a gauge: the position and yaw of the oldest keyframe that is left are called certain. For a
# fair comparison the same gauge is used for both.

# %%
dropped = problem.clone()
dropped.remove_vertices(going)
gauge = gl.Gauge.fixed(handles.poses[1])
for name, p in {"marginalized": after, "dropped": dropped}.items():
    p.solve(gauge=gauge, cost_tolerance=1e-14)
    position = np.sqrt(np.diag(p.covariance(newest, gauge=gauge).matrix)[:3])
    print(f"{name}: sigma of the newest position, seen from the oldest [mm] {1e3 * position.round(6)}")

# %% [markdown]
# ## What it must not claim
#
# A visual-inertial window sees neither its position nor its yaw. A prior linearized at one point and used
# together with edges linearized at another can claim to: `check_nullspace()` measures it, by kappa, the share
# of information along such a direction. (The window's own prior on its first pose is taken out first: it does
# say where the world is.)

# %%
free = gl.Problem()
handles = free.add_window(window)
edges = free.edges()
free.remove_edges(edges[["Prior" in name for name in edges.names()]])
free.solve(gauge=gl.Gauge.fixed(handles.poses[0]))
print(f"all edges at one point: kappa {free.check_nullspace().max_kappa:.1e}")
free.marginalize(handles.poses[0] + handles.speed_biases[0] + handles.depths[host_of == 0])
print(f"with the prior, there: kappa {free.check_nullspace().max_kappa:.1e}")
turned = free.values(handles.poses[1:])
turned[:, :3] += np.random.default_rng(1).normal(scale=0.05, size=(9, 3))
for mode in (gl.FirstEstimates.OFF, gl.FirstEstimates.FULL):
    elsewhere = free.clone()
    elsewhere.first_estimates = mode
    elsewhere.set_values(handles.poses[1:], turned)
    print(f"with the prior, 5 cm off, first estimates {mode.name}: kappa {elsewhere.check_nullspace().max_kappa:.1e}")
