# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Visual-inertial odometry on a recording
#
# A sliding window takes frames of tracked features and IMU samples in the order of time, and gives the newest
# state after each frame. The recording is a simulated flight of 12 s, two cameras and an IMU (`data/flight` of
# the repository); the environment variable `RECORDING` names another folder in the layout VIOTRACKS
# (`docs/formats.md`).

# %%
import os

import numpy as np

import glissade as gl
from glissade import plot, quaternions

recording = gl.read_viotracks(os.environ.get("RECORDING", "data/flight"))
imu_stamps, gyro, accel = recording.imu
frames = recording.frame_stamps_ns
print(f"{len(frames)} frames in {1e-9 * (frames[-1] - frames[0]):.1f} s, {len(recording.cameras)} cameras, "
      f"{len(imu_stamps)} IMU samples")

# %% [markdown]
# ## The loop
#
# IMU samples up to the frame's stamp go in first (one more where there is none at the stamp itself), then the
# frame, then a few iterations. `glissade.replay(recording, window)` is this loop; here it is written out, to
# keep the covariance of every state. Each of them holds with respect to the window's oldest frame, whose
# position and yaw are certain in it.

# %%
window = gl.SlidingWindow(recording.options())
stamps, poses, covariances = [], [], []
begin = 0
for k, stamp in enumerate(frames):
    end = min(int(np.searchsorted(imu_stamps, stamp)) + 1, len(imu_stamps))
    if end > begin:
        window.add_imu(imu_stamps[begin:end], gyro[begin:end], accel[begin:end])
        begin = end
    window.add_frame(int(stamp), *recording.observations(k))
    window.optimize()
    if window.running:
        stamps.append(int(stamp))
        poses.append(window.newest.pose)
        covariances.append(window.covariance())
stamps, poses, covariances = (np.array(x) for x in (stamps, poses, covariances))
print(f"running after {1e-9 * (stamps[0] - frames[0]):.1f} s; {len(stamps)} states")
print(f"the window holds {len(window.poses)} frames and {len(window.points)} landmarks")
print({name: count for name, count in window.events().items() if count})

# %% [markdown]
# ## How good is it?
#
# The absolute trajectory error, after the estimate is moved by yaw and translation, which nothing observes.

# %%
truth_stamps, truth = recording.ground_truth
result = gl.evaluate_trajectory(stamps, poses, truth_stamps, truth, alignment=gl.AlignmentKind.YAW)
length = np.linalg.norm(np.diff(truth[:, :3], axis=0), axis=1).sum()
print(f"ATE {result['translation_m']['rmse']:.4f} m over {length:.1f} m, "
      f"largest {result['translation_m']['max']:.4f} m, rotation {result['rotation_deg']['rmse']:.2f} deg")

# %%
aligned, reference = result["aligned"][1], result["reference"][1]
turn = quaternions.multiply(aligned[0, 3:], quaternions.inverse(poses[0, 3:]))
R = quaternions.rotate(turn, np.eye(3)).T  # the covariance turns with the estimate
position = R @ covariances[:, :3, :3] @ R.T
ax = plot.trajectory(aligned, position, reference, sigmas=3, max_ellipses=30)
ax.set_title(f"ATE {1e3 * result['translation_m']['rmse']:.1f} mm", fontsize=10)
ax.figure.savefig("vio_trajectory.png")
sigma = np.sqrt(np.array([np.diag(P) for P in covariances]))
print(f"claimed sigma of the newest position: {1e3 * np.median(sigma[:, :3].max(axis=1)):.1f} mm (median, worst axis)")

# %% [markdown]
# ## Does it know how good it is?
#
# The claimed covariance is that of the newest frame as seen from the window's oldest, a second or two before. The
# error after alignment has the drift of the whole flight in it as well: it may leave three sigma more often than
# the 0.3 % of an honest Gaussian. (`vio_replay --consistency` holds the one against the other
# from the same frame.)

# %%
matched = result["aligned"][0]
error = aligned[:, :3] - reference[:, :3]
sigma = np.sqrt(np.einsum("nii->ni", position))
ax = plot.errors(1e-9 * (matched - matched[0]), 1e3 * error, 1e3 * sigma, ylabel="position error [mm]",
                 what="after alignment")
ax.figure.savefig("vio_errors.png")
print(ax.get_title())
