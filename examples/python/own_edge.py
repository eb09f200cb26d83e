# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # An edge of your own
#
# A robot drives a curve between eight radio beacons whose places are known. It measures its distance to each
# of them, to a centimetre, and each of its moves, roughly. There is no built-in edge for distances: we write
# one, for all distances at once, on numpy arrays.

# %%
import numpy as np

import glissade as gl
from glissade import plot, quaternions


class Range(gl.EdgeKind):
    """Distance between an antenna on the body and a beacon: r = |beacon - antenna| - measured."""

    residual_dim = 1

    def __init__(self, antenna):
        self.antenna = np.asarray(antenna, float)  # in the body [m]

    def ray(self, pose, beacon):
        antenna = np.broadcast_to(self.antenna, (len(pose), 3))
        return beacon - (pose[:, :3] + quaternions.rotate(pose[:, 3:], antenna))

    def residual(self, pose, beacon, measured):  # (n, 7), (n, 3), (n,) -> (n, 1)
        return (np.linalg.norm(self.ray(pose, beacon), axis=1) - measured)[:, None]

    def jacobian(self, pose, beacon, measured):  # -> (n, 1, 6) for the pose, (n, 1, 3) for the beacon
        ray = self.ray(pose, beacon)
        direction = ray / np.linalg.norm(ray, axis=1, keepdims=True)
        in_body = quaternions.rotate(quaternions.inverse(pose[:, 3:]), direction)
        # The tangent of a pose: [dp in world axes, dtheta in body axes].
        d_pose = np.concatenate([-direction, np.cross(in_body, self.antenna)], axis=1)
        return d_pose[:, None, :], direction[:, None, :]


# %% [markdown]
# ## The problem
#
# Twelve poses on a circle. The start is dead reckoning: the measured moves, one after the other, from a first
# pose that is off by 0.3 m and 0.2 rad. Every tenth range is too long by a metre, as radio ranges are where
# the way is not free.

# %%
def drive(seed=5):
    random = np.random.default_rng(seed)
    beacons = np.array([[x, y, z] for x in (0.0, 6.0) for y in (0.0, 6.0) for z in (0.2, 3.0)])
    angle = 0.25 * np.arange(12)
    turn = quaternions.exp(np.stack([0 * angle, 0 * angle, angle], axis=1))
    truth = np.concatenate([np.stack([3 + 2 * np.sin(angle), 3 - 2 * np.cos(angle), 0.3 + 0 * angle], 1), turn], 1)
    pose, beacon = (i.ravel() for i in np.meshgrid(np.arange(12), np.arange(8), indexing="ij"))
    ranges = np.linalg.norm(Range([0.0, 0.1, 0.2]).ray(truth[pose], beacons[beacon]), axis=1)
    ranges += random.normal(scale=0.01, size=len(ranges))
    wrong = np.arange(len(ranges)) % 10 == 7
    ranges[wrong] += 1.0
    back = quaternions.inverse(truth[:-1, 3:])
    moves = np.concatenate([quaternions.rotate(back, truth[1:, :3] - truth[:-1, :3]),
                            quaternions.multiply(back, truth[1:, 3:])], axis=1)
    moves[:, :3] += random.normal(scale=0.05, size=(11, 3))
    return truth, beacons, pose, beacon, ranges, moves


truth, beacons, pose, beacon, ranges, moves = drive()


def dead_reckoning():
    start = np.zeros((12, 7))
    start[0, :3] = truth[0, :3] + [0.2, -0.2, 0.1]
    start[0, 3:] = quaternions.exp([0.0, 0.0, 0.2])
    for k in range(11):
        start[k + 1, :3] = start[k, :3] + quaternions.rotate(start[k, 3:], moves[k, :3])
        start[k + 1, 3:] = quaternions.multiply(start[k, 3:], moves[k, 3:])
    return start


def build(loss):
    problem = gl.Problem()
    poses = problem.add_poses(dead_reckoning())
    points = problem.add_points(beacons)
    problem.fix(points)
    problem.add_relative_poses(poses[:-1], poses[1:], moves, sqrt_information=20.0)  # 0.05 m, 0.05 rad
    # 0.01 m; the data arrays have a row for each edge.
    edges = problem.add_edges(Range([0.0, 0.1, 0.2]), [poses[pose], points[beacon]], ranges, sqrt_information=100.0,
                              loss=loss)
    return problem, poses, edges


# %% [markdown]
# ## Are the derivatives right?
#
# `check_jacobian()` compares them with differences. About 1e-9 where they are right; a wrong sign says 1.

# %%
problem, poses, edges = build(gl.Loss())
print(f"Jacobian against differences: {problem.check_jacobian(edges):.1e}")


class WrongSign(Range):
    def jacobian(self, pose, beacon, measured):
        d_pose, d_beacon = super().jacobian(pose, beacon, measured)
        return -d_pose, d_beacon


trap = gl.Problem()
trap_edges = trap.add_edges(WrongSign([0.0, 0.1, 0.2]), [trap.add_poses(truth)[pose], trap.add_points(beacons)[beacon]],
                            ranges)
print(f"with a wrong sign:            {trap.check_jacobian(trap_edges):.1e}")

# %% [markdown]
# ## Squares, and a loss that lets wrong ranges go

# %%
summaries = {}
for name, loss in {"squares": gl.Loss(), "Huber, 2 sigma": gl.Huber(2.0), "Tukey": gl.Tukey()}.items():
    problem, poses, edges = build(gl.Huber(2.0) if name == "Tukey" else loss)
    if name == "Tukey":  # not convex: begins where Huber ended
        problem.solve()
        values = problem.values(poses)
        problem, poses, edges = build(loss)
        problem.set_values(poses, values)
    summaries[name] = problem.solve(cost_tolerance=1e-10)
    error = np.linalg.norm(problem.values(poses)[:, :3] - truth[:, :3], axis=1)
    beyond = np.flatnonzero(problem.chi2(edges) > 9.0)
    print(f"{name:15} {len(summaries[name].iterations) - 1:2} iterations, positions off by "
          f"{1e3 * error.mean():5.1f} mm on average, {1e3 * error.max():5.1f} at most; "
          f"{len(beyond)} ranges beyond 3 sigma")
    found = set(map(int, beyond))
wrong = {k for k in range(len(ranges)) if k % 10 == 7}
print(f"{len(wrong)} are wrong; Tukey's loss finds {len(found & wrong)} of them, and {len(found - wrong)} others")

# %%
covariance = problem.covariance(poses)
ax = plot.trajectory(problem.values(poses), covariance.matrix, truth, sigmas=3)
ax.plot(beacons[:, 0], beacons[:, 1], "^", color=plot.colors.RED, label="beacons")
ax.legend(fontsize=8)
ax.figure.savefig("own_edge_trajectory.png")
plot.residuals(problem, edges, dim=1, bins=30, upper=6.0).figure.savefig("own_edge_residuals.png")
plot.convergence(summaries["Huber, 2 sigma"]).figure.savefig("own_edge_convergence.png")
