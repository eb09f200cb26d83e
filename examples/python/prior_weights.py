# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # How heavy should a prior be that holds the gauge?
#
# Bundle adjustment with one camera leaves seven directions free. They can be held by fixing two poses, or
# by priors on these poses with a weight w, or not at all. Here the same scene is solved for many weights, from starts
# that are off by 0.05 m and rad. (`docs/prior_weight.md` says more; `prior_weight_sweep` is the whole study.)

# %%
import time

import numpy as np

import glissade as gl
from glissade import plot, quaternions

random = np.random.default_rng(7)
noise = [(random.normal(scale=0.05, size=(3, 3)), random.normal(scale=0.05, size=(3, 3))) for _ in range(10)]


def trial(weight, offsets):
    """Solves from a start that is off: errors against the truth, and what the solve took."""
    problem = gl.Problem()
    scene = problem.add_course_scene(fix_poses=2 if weight is None else 0, prior_weight=weight or 0.0)
    truth = problem.values(scene.poses)  # the scene begins at the truth
    free = slice(2, 3) if weight is None else slice(0, 3)
    start = truth.copy()
    start[free, :3] += offsets[0][free]
    start[free, 3:] = quaternions.multiply(start[free, 3:], quaternions.exp(offsets[1][free]))
    problem.set_values(scene.poses, start)
    begin = time.perf_counter()
    summary = problem.solve(max_iterations=200, cost_tolerance=1e-12)
    milliseconds = 1e3 * (time.perf_counter() - begin)
    position = problem.values(scene.poses)[:, :3]
    return {"pose_error_m": float(np.linalg.norm(position - truth[:, :3], axis=1).sum()),
            "iterations": len(summary.iterations) - 1, "time_ms": milliseconds}


def row(weight):
    return {"weight": weight, "fixed": weight is None, "trials": [trial(weight, offsets) for offsets in noise]}


weights = [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8]
sweep = {"rows": [row(None)] + [row(weight) for weight in weights], "pose_noise_m_rad": 0.05}

# %%
print("weight     pose error [mm]   iterations")
for r in sweep["rows"]:
    error = 1e3 * np.median([t["pose_error_m"] for t in r["trials"]])
    iterations = np.median([t["iterations"] for t in r["trials"]])
    print(f"{'fixed' if r['fixed'] else format(r['weight'], 'g'):9}  {error:15.5f}   {iterations:10g}")

# %% [markdown]
# From w = 1e3 on the error differs from that of fixed poses by something that falls as 1/w. A weight of 1e8
# is not more accurate than one of 1e4; it is another way to write "fixed". Below 1, where the observations are the
# heavier ones, the error tends to another limit, and light priors cost iterations: the images are
# explained first, and the gauge follows slowly.

# %%
plot.prior_weights(sweep).savefig("prior_weights_accuracy.png")
plot.prior_weight_time(sweep).savefig("prior_weights_time.png")
