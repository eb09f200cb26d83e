#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what vio_replay --states has written: trajectory against truth, error with its 3-sigma band,
biases, size of the window, time per frame.

    vio_replay data/flight --states flight.csv
    scripts/plot_trajectory.py flight.csv data/flight flight.png

The second argument is the folder of the recording (VIOTRACKS) or its groundtruth.csv(.gz); "-" for none.
The error is that of the newest frame as seen from the window's oldest, whose position and yaw (without an
IMU: whose pose) are exact in the band: what the estimator claims to know. Needs numpy and matplotlib (Debian, Ubuntu: python3-matplotlib).
"""

import argparse
import gzip
import json
import pathlib
import sys

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c03028", "#2a8a4a", "#707070"
AXES = (("x", RED), ("y", GREEN), ("z", BLUE))


def open_text(path):
    return gzip.open(path, "rt", encoding="utf-8") if path.suffix == ".gz" else open(path, encoding="utf-8")


def read_states(np, path):
    """Columns by name; stamps as exact integers."""
    with open_text(path) as file:
        lines = [line.strip() for line in file if line.strip() and not line.startswith("#")]
    names = lines[0].split(",")
    if names[0] != "timestamp_ns" or "oldest_ns" not in names:
        raise ValueError("no states of vio_replay")
    rows = [line.split(",") for line in lines[1:]]
    if not rows or any(len(row) != len(names) for row in rows):
        raise ValueError("no states, or rows of different lengths")
    columns = {}
    for k, name in enumerate(names):
        if name.endswith("_ns"):
            columns[name] = np.array([int(row[k]) for row in rows])
        else:
            columns[name] = np.array([float(row[k]) if row[k] else np.nan for row in rows])
    return columns


def read_truth(np, path):
    """Stamps, positions, quaternions (x y z w), biases ([bg, ba], or None); turned so that z is up."""
    up = None
    if path.is_dir():
        with open(path / "calibration.json", encoding="utf-8") as file:
            up = -np.array(json.load(file)["gravity"], float)
        path = next((p for p in (path / "groundtruth.csv", path / "groundtruth.csv.gz") if p.exists()), None)
        if path is None:
            return None
    stamps, rows = [], []
    with open_text(path) as file:
        for line in file:
            words = line.strip().split(",")
            if line.startswith("#") or not words[0].strip().isdigit():
                continue
            stamps.append(int(words[0]))
            rows.append([float(word) for word in words[1:]])
    table = np.array(rows)
    p, q = table[:, :3], table[:, [4, 5, 6, 3]]
    biases = table[:, 10:16] if table.shape[1] >= 16 else None
    if up is not None and np.linalg.norm(up) > 0:
        R = rotation_to_z(np, up / np.linalg.norm(up))
        p = p @ R.T
        q = np.array([quaternion_of(np, R @ matrix_of(np, x)) for x in q])
    return np.array(stamps), p, q, biases


# ---- Rotations -----------------------------------------------------------------------------------
def matrix_of(np, q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def quaternion_of(np, R):
    """x y z w, by the largest of the four (Shepperd)."""
    t = [R[0, 0] - R[1, 1] - R[2, 2], R[1, 1] - R[0, 0] - R[2, 2], R[2, 2] - R[0, 0] - R[1, 1],
         R[0, 0] + R[1, 1] + R[2, 2]]
    k = int(np.argmax(t))
    off = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    q = np.empty(4)
    q[k] = 1 + t[k]
    if k == 3:
        q[:3] = off
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q[3], q[i], q[j] = off[k], R[k, i] + R[i, k], R[k, j] + R[j, k]
    return q / np.linalg.norm(q)


def rotation_to_z(np, u):
    """The shortest rotation that takes a unit vector to z."""
    v, c = np.array([u[1], -u[0], 0.0]), u[2]
    if c < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    K = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + K + K @ K / (1 + c)


def rot_z(np, yaw):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def log_so3(np, R):
    q = quaternion_of(np, R)
    q = q if q[3] >= 0 else -q
    n = np.linalg.norm(q[:3])
    return 2 * q[:3] if n < 1e-12 else 2 * np.arctan2(n, q[3]) * q[:3] / n


def twist_yaw(np, R):
    """The rotation that R makes about z."""
    q = quaternion_of(np, R)
    return 2 * np.arctan2(q[2], q[3]) if q[3] >= 0 else 2 * np.arctan2(-q[2], -q[3])


# ---- Truth at the estimate's stamps ------------------------------------------------------------------
class Truth:
    def __init__(self, np, data):
        self.np, (self.stamps, self.p, self.q, self.biases) = np, data

    def at(self, stamp):
        """Position and rotation, interpolated; None outside."""
        np = self.np
        k = int(np.searchsorted(self.stamps, stamp))
        if k < len(self.stamps) and self.stamps[k] == stamp:
            return self.p[k], matrix_of(np, self.q[k])
        if k == 0 or k == len(self.stamps):
            return None
        u = float(stamp - self.stamps[k - 1]) / float(self.stamps[k] - self.stamps[k - 1])
        a, b = self.q[k - 1], self.q[k] if self.q[k - 1] @ self.q[k] >= 0 else -self.q[k]
        return (1 - u) * self.p[k - 1] + u * self.p[k], matrix_of(np, (1 - u) * a + u * b)


def aligned_by_yaw(np, p, reference):
    """The trajectory moved by yaw and translation to where the truth is nearest (least squares)."""
    a, b = p - p.mean(0), reference - reference.mean(0)
    yaw = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a[:, :2] * b[:, :2]).sum())
    R = rot_z(np, yaw)
    return R, reference.mean(0) - R @ p.mean(0)


def aligned_rigidly(np, p, reference):
    """By SE(3) (Umeyama)."""
    U, _, Vt = np.linalg.svd((reference - reference.mean(0)).T @ (p - p.mean(0)))
    R = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    return R, reference.mean(0) - R @ p.mean(0)


def window_errors(np, s, truth, has_imu):
    """Error of each newest state where the oldest frame has the truth's position and yaw (without an IMU:
    its whole pose): p (m), theta (rad, body axes); rows of NaN where there is no truth."""
    errors = np.full((len(s["timestamp_ns"]), 6), np.nan)
    for k, stamp in enumerate(s["timestamp_ns"]):
        new, old = truth.at(stamp), truth.at(s["oldest_ns"][k])
        if new is None or old is None:
            continue
        p = np.array([s[c][k] for c in ("px", "py", "pz")])
        R = matrix_of(np, np.array([s[c][k] for c in ("qx", "qy", "qz", "qw")]))
        po = np.array([s[c][k] for c in ("opx", "opy", "opz")])
        Ro = matrix_of(np, np.array([s[c][k] for c in ("oqx", "oqy", "oqz", "oqw")]))
        turn = rot_z(np, -twist_yaw(np, Ro @ old[1].T)) if has_imu else old[1] @ Ro.T
        errors[k, :3] = turn @ (p - po) - (new[0] - old[0])
        errors[k, 3:] = log_so3(np, new[1].T @ turn @ R)
        # Sigmas are along the axes of the estimate's world: so are the errors.
        errors[k, :3] = turn.T @ errors[k, :3]
    return errors


# ---- Pictures ------------------------------------------------------------------------------------------
def style(ax, xlabel, ylabel):
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)
    ax.grid(True, color="#dddddd", linewidth=0.7)
    ax.spines[["top", "right"]].set_visible(False)


def plot_path(np, axes, s, t, matched, has_imu):
    p = np.stack([s["px"], s["py"], s["pz"]], 1)
    top, height = axes
    title = "From above"
    if matched is not None:
        use, reference = matched
        R, shift = (aligned_by_yaw if has_imu else aligned_rigidly)(np, p[use], reference)
        p = p @ R.T + shift
        rms = np.sqrt(((p[use] - reference) ** 2).sum(1).mean())
        title += f": ATE {rms:.3g} m over {np.linalg.norm(np.diff(reference, axis=0), axis=1).sum():.0f} m"
        top.plot(reference[:, 0], reference[:, 1], color=GREY, linewidth=2.2, alpha=0.7, label="truth")
        height.plot(t[use], reference[:, 2], color=GREY, linewidth=2.2, alpha=0.7, label="truth")
    top.plot(p[:, 0], p[:, 1], color=BLUE, linewidth=1.1, label="estimate, causal")
    top.plot(p[0, 0], p[0, 1], marker="o", color="black", markersize=5, linestyle="none", label="start")
    height.plot(t, p[:, 2], color=BLUE, linewidth=1.1)
    top.set_aspect("equal", adjustable="datalim")
    top.set_title(title, fontsize=10)
    top.legend(fontsize=8, loc="best")
    style(top, "x [m]", "y [m]")
    style(height, "", "height [m]")


def plot_errors(np, axes, s, t, errors):
    meters = np.nanquantile(abs(errors[:, :3]), 0.9) > 0.3
    rows = ((axes[0], 0, ("s_px", "s_py", "s_pz"), 1 if meters else 1e3,
             f"position error [{'m' if meters else 'mm'}]"),
            (axes[1], 3, ("s_rx", "s_ry", "s_rz"), 180 / np.pi, "rotation error [deg]"))
    for ax, first, names, scale, label in rows:
        band = 3 * scale * np.maximum.reduce([s[name] for name in names])  # NaN where not known
        ax.fill_between(t, -band, band, color=GREY, alpha=0.18, linewidth=0, label="3 sigma, worst axis")
        inside, count = 0, 0
        for k, (name, color) in enumerate(AXES):
            e = scale * errors[:, first + k]
            ax.plot(t, e, color=color, linewidth=0.8, label=name)
            known = np.isfinite(e) & np.isfinite(s[names[k]])
            inside += (abs(e[known]) <= 3 * scale * s[names[k]][known]).sum()
            count += known.sum()
        limit = 1.3 * max(np.nanquantile(abs(scale * errors[:, first:first + 3]), 0.995),
                          np.nanquantile(band, 0.9))
        ax.set_ylim(-limit, limit)
        if count:
            ax.set_title(f"newest frame as seen from the oldest: {100 * inside / count:.1f} % within 3 sigma",
                         fontsize=9)
        style(ax, "", label)
    axes[0].legend(fontsize=8, loc="upper right", ncols=4)


def plot_biases(np, axes, s, t, truth_biases):
    for ax, stem, scale, label, column in ((axes[0], "ba", 1.0, "accelerometer bias [m/s$^2$]", 3),
                                           (axes[1], "bg", 180 / np.pi, "gyroscope bias [deg/s]", 0)):
        values = []
        for k, (name, color) in enumerate(AXES):
            b, sigma = scale * s[stem + name], 3 * scale * s[f"s_{stem}{name}"]
            ax.fill_between(t, b - sigma, b + sigma, color=color, alpha=0.13, linewidth=0)
            ax.plot(t, b, color=color, linewidth=1.0, label=name)
            if truth_biases is not None:
                ax.plot(t, scale * truth_biases[:, column + k], color=color, linewidth=1.0, linestyle=":")
            values += [b[len(b) // 10:] - sigma[len(b) // 10:], b[len(b) // 10:] + sigma[len(b) // 10:]]
        low, high = np.nanquantile(values, 0.01), np.nanquantile(values, 0.99)
        ax.set_ylim(low - 0.25 * (high - low), high + 0.25 * (high - low))
        style(ax, "", label)
    axes[0].set_title("with 3 sigma" + ("; dotted: truth" if truth_biases is not None else ""), fontsize=9)
    axes[0].legend(fontsize=8, loc="upper right", ncols=3)


def plot_window(np, axes, s, t):
    size, time = axes
    size.plot(t, s["landmarks"], color=GREEN, linewidth=1.0, label="landmarks")
    size.plot(t, s["observations"] / 10, color=BLUE, linewidth=1.0, label="observations / 10")
    size.plot(t, 10 * s["frames"], color=RED, linewidth=1.0, label="frames x 10")
    size.set_ylim(bottom=0)
    size.legend(fontsize=8, loc="lower right", ncols=3)
    style(size, "", "window")
    time.plot(t, s["ms"], color=BLUE, linewidth=0.7)
    median = np.median(s["ms"])
    time.axhline(median, color=RED, linewidth=1.0, linestyle="--", label=f"median {median:.2f} ms")
    time.set_ylim(0, 1.15 * np.max(s["ms"]))
    time.legend(fontsize=8, loc="upper right")
    style(time, "", "time per frame [ms]")


def draw(np, plt, s, truth, path):
    t = 1e-9 * (s["timestamp_ns"] - s["timestamp_ns"][0])
    has_imu = bool(np.isfinite(s["s_bax"]).any())
    matched = errors = biases = None
    if truth is not None:
        at = [truth.at(stamp) for stamp in s["timestamp_ns"]]
        use = np.array([x is not None for x in at])
        if use.sum() > 2:
            matched = use, np.array([x[0] for x in at if x is not None])
            errors = window_errors(np, s, truth, has_imu)
        if truth.biases is not None:
            biases = np.stack([np.interp(s["timestamp_ns"], truth.stamps, column) for column in truth.biases.T], 1)
    # On the left the way and what is left over, on the right panels of equal height.
    panels = (2 if errors is not None else 0) + (2 if has_imu else 0) + 2
    on_right = panels // 2 + 1
    on_left = panels - on_right
    fig = plt.figure(figsize=(11, max(6.5, 1.5 + 1.15 * panels)), layout="constrained")
    left, right = fig.add_gridspec(1, 2)
    left_grid = left.subgridspec(on_left + 3, 1)
    right_grid = right.subgridspec(on_right, 1)
    top, height = fig.add_subplot(left_grid[0:2]), fig.add_subplot(left_grid[2])
    slots = [fig.add_subplot(right_grid[k], sharex=height) for k in range(on_right)]
    slots += [fig.add_subplot(left_grid[3 + k], sharex=height) for k in range(on_left)]
    plot_path(np, (top, height), s, t, matched, has_imu)
    if errors is not None:
        plot_errors(np, [slots.pop(0), slots.pop(0)], s, t, errors)
    if has_imu:
        plot_biases(np, [slots.pop(0), slots.pop(0)], s, t, biases)
    plot_window(np, [slots.pop(0), slots.pop(0)], s, t)
    for ax in fig.axes[1:]:
        last = ax.get_subplotspec().is_last_row()
        ax.tick_params(labelbottom=last)
        if last:
            ax.set_xlabel("time [s]")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("states", type=pathlib.Path, help="file of vio_replay --states")
    parser.add_argument("truth", type=pathlib.Path, help='folder of the recording, groundtruth.csv, or "-"')
    parser.add_argument("picture", type=pathlib.Path, help=".png (or .pdf, .svg) to write")
    args = parser.parse_args()
    try:
        import matplotlib
        import numpy as np
    except ImportError:
        print("plot_trajectory.py: needs matplotlib (Debian, Ubuntu: python3-matplotlib)", file=sys.stderr)
        return 2
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    try:
        states = read_states(np, args.states)
        data = None if str(args.truth) == "-" else read_truth(np, args.truth)
        truth = Truth(np, data) if data is not None else None
    except (OSError, ValueError, KeyError, IndexError) as error:
        print(f"plot_trajectory.py: {args.states}, {args.truth}: {error}", file=sys.stderr)
        return 2
    draw(np, plt, states, truth, args.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
