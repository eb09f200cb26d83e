# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Monocular bundle adjustment, one step at a time
#
# Three poses, 30 degrees apart on a circle, look at twenty points. Each point is known by its inverse depth
# along the ray of the first pose that saw it (its host); each other pose that sees it gives an edge with a
# residual of two rows. We look at the matrix that a solve works with, do the steps of Levenberg-Marquardt
# by hand, and then eliminate the points: the Schur complement.
#
# Needs `glissade` and matplotlib. Pictures are written into the current folder.

# %%
import numpy as np

import glissade as gl
from glissade import plot

problem = gl.Problem()
scene = problem.add_course_scene()
print(f"{len(scene.poses)} poses, {len(scene.depths)} inverse depths, {len(scene.reprojections)} edges")

# %% [markdown]
# ## The matrix H
#
# A step solves $H\,\delta x = b$ with $H = J^\top J$ and $b = -J^\top r$. An edge touches its host, its target
# and one landmark; no edge joins two landmarks, so their part of H is diagonal. All points have pose 0 as
# host, and no edge joins pose 1 to pose 2: hence the two white blocks.

# %%
plot.hessian(problem, decades=5).figure.savefig("mono_ba_hessian.png")
problem.make_hessian()
H = problem.hessian()
print(f"H is {H.shape[0]} x {H.shape[1]}, of rank {np.linalg.matrix_rank(H, hermitian=True)}")

# %% [markdown]
# H lacks a rank of 7: one camera sees neither where the world is (3), nor how it is turned (3), nor how large
# it is (1). Two poses that are held settle all of it.

# %%
problem.fix(scene.poses[:2])
problem.make_hessian()
print(f"with two poses held: {problem.hessian().shape[0]} variables, rank "
      f"{np.linalg.matrix_rank(problem.hessian(), hermitian=True)}")

# %% [markdown]
# ## The steps of Levenberg-Marquardt
#
# `problem.solve()` is a loop over these calls: linearize, solve the damped system
# $(H + \lambda D)\,\delta x = b$, step; keep the step if the cost has fallen, else go back and damp more.

# %%
by_hand = problem.clone()
damping, cost = 1e-4, by_hand.cost()
print(f"step 0: cost {cost:.6e}")
for step in range(1, 9):
    by_hand.make_hessian()
    by_hand.solve_linear_system(damping)
    by_hand.update_states()
    tried = by_hand.cost()
    if tried < cost:
        damping, cost = 0.1 * damping, tried
    else:
        by_hand.rollback_states()
        damping *= 10.0
    print(f"step {step}: cost {tried:.6e}, |dx| {np.linalg.norm(by_hand.step()):.1e}")
    if np.linalg.norm(by_hand.step()) < 1e-9:
        break

# %%
summary = problem.solve(cost_tolerance=1e-14)
print(summary)
print(f"by hand and by solve(): relative difference of the cost {abs(cost / summary.final_cost - 1):.1e}")
plot.convergence(summary).figure.savefig("mono_ba_convergence.png")

# %% [markdown]
# What is the cost to be? 40 edges have 80 rows, and 26 unknowns take a part of the noise away. A row has the
# noise of two observations in it, 0.001 of the target's coordinate and about as much of the host's, which
# is taken as exact: about $\tfrac12 (80 - 26) \cdot 2 \cdot 0.001^2$.

# %%
rows, unknowns = 2 * len(scene.reprojections), 6 + len(scene.depths)
print(f"cost {summary.final_cost:.3e}, expected about {0.5 * (rows - unknowns) * 2 * 0.001**2:.1e}")

# %% [markdown]
# ## The Schur complement
#
# With poses p and landmarks l, the landmarks can be eliminated first, each by a division:
#
# $$ S = H_{pp} - H_{pl} H_{ll}^{-1} H_{lp}, \qquad g = b_p - H_{pl} H_{ll}^{-1} b_l . $$
#
# $S\,\delta p = g$ has 6 unknowns a pose, however many points there are; then
# $\delta l = H_{ll}^{-1} (b_l - H_{lp}\,\delta p)$. With all poses free again, the white blocks are filled: two poses
# that see the same points know of each other.

# %%
problem.free(scene.poses[:2])
plot.schur(problem, decades=5).figure.savefig("mono_ba_schur.png")
problem.fix(scene.poses[:2])
problem.set_values(scene.depths, problem.values(scene.depths) * 1.2)  # somewhere where a step is to be made

problem.make_hessian()
H, b = problem.hessian(), problem.rhs()
p, l = slice(0, 6), slice(6, None)  # order of free_vertices(): kept ones first
inverse = 1.0 / np.diag(H[l, l])
S = H[p, p] - H[p, l] * inverse @ H[l, p]
g = b[p] - H[p, l] * inverse @ b[l]
dp = np.linalg.solve(S, g)
dl = inverse * (b[l] - H[l, p] @ dp)

problem.solve_linear_system(0.0)
difference = np.linalg.norm(np.concatenate([dp, dl]) - problem.step()) / np.linalg.norm(problem.step())
print(f"a system of {len(S)} instead of {len(H)} unknowns; relative difference of the steps {difference:.1e}")
print(f"and of a dense solve of all {np.linalg.norm(np.linalg.solve(H, b) - problem.step()):.1e}")
