#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what vio_replay --states has written: trajectory against truth, error with its 3-sigma band,
biases, size of the window, time per frame.

    vio_replay data/flight --states flight.csv
    scripts/plot_trajectory.py flight.csv data/flight flight.png

The second argument is the folder of the recording (VIOTRACKS) or its groundtruth.csv(.gz); "-" for none.
The error is that of the newest frame as seen from the window's oldest, whose position and yaw (without an
IMU: whose pose) are exact in the band: what the estimator claims to know.

Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import gzip
import json
import pathlib
import typing

from plot_util import fail, gl, np, plot, plt, quaternions, save

C = plot.colors


# ---- Files -------------------------------------------------------------------------------------------
def lines_of(path):
    """Lines of a text file, .gz or not, without comments and empty ones."""
    with (gzip.open if path.suffix == ".gz" else open)(path, "rt", encoding="utf-8") as file:
        return [line.strip() for line in file if line.strip() and not line.startswith("#")]


def read_states(path):
    """Columns by name; stamps as exact integers."""
    names, *rows = (line.split(",") for line in lines_of(path))
    if names[0] != "timestamp_ns" or "oldest_ns" not in names:
        raise ValueError("no states of vio_replay")
    if not rows or any(len(row) != len(names) for row in rows):
        raise ValueError("no states, or rows of different lengths")
    columns = {}
    for name, column in zip(names, zip(*rows)):
        stamp = name.endswith("_ns")
        columns[name] = np.array([int(x) if stamp else float(x) if x else np.nan for x in column])
    return columns


def columns_of(s, *names):
    return np.stack([s[name] for name in names], axis=1)


class Truth(typing.NamedTuple):
    """Stamps (n,) ns, poses (n, 7) in a world whose z points up, biases (n, 6) [gyro, accel] or None."""

    stamps: np.ndarray
    poses: np.ndarray
    biases: np.ndarray | None

    def at(self, stamps):
        """Poses at stamps, interpolated: rows of NaN where there are none."""
        t = stamps.astype(float)
        p = [np.interp(t, self.stamps, column) for column in self.poses[:, :3].T]
        poses = np.concatenate([np.stack(p, axis=1), quaternions.interpolate(stamps, self.stamps, self.poses[:, 3:])], 1)
        poses[(stamps < self.stamps[0]) | (stamps > self.stamps[-1])] = np.nan
        return poses


def turn_to_z(up):
    """The shortest rotation that takes a direction to z, x y z w."""
    up = up / np.linalg.norm(up)
    axis = np.array([up[1], -up[0], 0.0])
    length = np.linalg.norm(axis)
    axis = axis / length if length > 1e-12 else np.array([1.0, 0.0, 0.0])
    return quaternions.exp(np.arctan2(length, up[2]) * axis)


def read_truth(path):
    """None where a folder has none."""
    turn = None
    if path.is_dir():
        gravity = np.array(json.loads((path / "calibration.json").read_text(encoding="utf-8"))["gravity"], float)
        turn = turn_to_z(-gravity) if np.linalg.norm(gravity) > 0 else None
        path = next((p for p in (path / "groundtruth.csv", path / "groundtruth.csv.gz") if p.exists()), None)
        if path is None:
            return None
    rows = [line.split(",") for line in lines_of(path) if line.split(",")[0].strip().isdigit()]
    stamps = np.array([int(row[0]) for row in rows])  # nanoseconds have more digits than a double
    table = np.array([[float(word) for word in row[1:]] for row in rows])
    p, q = table[:, :3], table[:, [4, 5, 6, 3]]
    if turn is not None:
        p, q = quaternions.rotate(np.tile(turn, (len(p), 1)), p), quaternions.multiply(np.tile(turn, (len(q), 1)), q)
    return Truth(stamps, np.concatenate([p, q], axis=1), table[:, 10:16] if table.shape[1] >= 16 else None)


# ---- Errors ------------------------------------------------------------------------------------------
def window_errors(s, truth, has_imu):
    """Error of each newest state where the oldest frame has the truth's position and yaw (without an IMU:
    its whole pose): p [m], axes of the estimate's world as its sigmas, theta [rad], body axes; NaN without truth."""
    p, q = columns_of(s, "px", "py", "pz"), columns_of(s, "qx", "qy", "qz", "qw")
    po, qo = columns_of(s, "opx", "opy", "opz"), columns_of(s, "oqx", "oqy", "oqz", "oqw")
    new, old = truth.at(s["timestamp_ns"]), truth.at(s["oldest_ns"])
    turn = quaternions.multiply(old[:, 3:], quaternions.inverse(qo))
    if has_imu:
        yaw = quaternions.yaw(turn)
        turn = quaternions.exp(np.stack([0 * yaw, 0 * yaw, yaw], axis=1))
    position = p - po - quaternions.rotate(quaternions.inverse(turn), new[:, :3] - old[:, :3])
    there = quaternions.multiply(turn, q)
    return np.concatenate([position, quaternions.log(quaternions.multiply(quaternions.inverse(new[:, 3:]), there))], 1)


# ---- Pictures ------------------------------------------------------------------------------------------
def plot_path(axes, s, t, truth, has_imu):
    top, height = axes
    poses = columns_of(s, "px", "py", "pz", "qx", "qy", "qz", "qw")
    title, reference = "From above", None
    if truth is not None:
        kind = gl.AlignmentKind.YAW if has_imu else gl.AlignmentKind.SE3
        result = gl.evaluate_trajectory(s["timestamp_ns"], poses, truth.stamps, truth.poses, alignment=kind)
        (matched, aligned), (_, reference) = result["aligned"], result["reference"]
        before = poses[np.searchsorted(s["timestamp_ns"], matched[0])]
        turn = quaternions.multiply(aligned[0, 3:], quaternions.inverse(before[3:]))
        poses[:, :3] = aligned[0, :3] + quaternions.rotate(np.tile(turn, (len(poses), 1)), poses[:, :3] - before[:3])
        length = np.linalg.norm(np.diff(reference[:, :3], axis=0), axis=1).sum()
        title += f": ATE {result['translation_m']['rmse']:.3g} m over {length:.0f} m"
        height.plot(1e-9 * (matched - s["timestamp_ns"][0]), reference[:, 2], color=C.GREY, linewidth=2.2, alpha=0.8)
    plot.trajectory(poses, truth=reference, label="estimate, causal", ax=top)
    top.set_title(title, fontsize=10)
    height.plot(t, poses[:, 2], color=C.BLUE, linewidth=1.1)
    plot.finish(height, "", "height [m]")


def plot_errors(axes, s, t, errors):
    meters = np.nanquantile(abs(errors[:, :3]), 0.9) > 0.3
    unit, scale = ("m", 1.0) if meters else ("mm", 1e3)
    what = "newest frame as seen from the oldest"
    plot.errors(t, scale * errors[:, :3], scale * columns_of(s, "s_px", "s_py", "s_pz"), xlabel="",
                ylabel=f"position error [{unit}]", what=what, ax=axes[0])
    plot.errors(t, np.degrees(errors[:, 3:]), np.degrees(columns_of(s, "s_rx", "s_ry", "s_rz")), xlabel="",
                ylabel="rotation error [deg]", what=what, ax=axes[1])
    axes[0].legend(fontsize=8, loc="upper right", ncols=4)


def plot_biases(axes, s, t, truth_biases):
    for ax, stem, scale, label, column in ((axes[0], "ba", 1.0, "accelerometer bias [m/s$^2$]", 3),
                                           (axes[1], "bg", 180 / np.pi, "gyroscope bias [deg/s]", 0)):
        ends = []
        for k, (name, color) in enumerate(C.AXES):
            b, sigma = scale * s[stem + name], 3 * scale * s[f"s_{stem}{name}"]
            plot.band(t, b - sigma, b, b + sigma, color=color, label=name, alpha=0.13, linewidth=1.0, ax=ax)
            if truth_biases is not None:
                ax.plot(t, scale * truth_biases[:, column + k], color=color, linewidth=1.0, linestyle=":")
            ends += [(b - sigma)[len(b) // 10:], (b + sigma)[len(b) // 10:]]
        low, high = np.nanquantile(ends, 0.01), np.nanquantile(ends, 0.99)
        ax.set_ylim(low - 0.25 * (high - low), high + 0.25 * (high - low))
        plot.finish(ax, "", label)
    axes[0].set_title("with 3 sigma" + ("; dotted: truth" if truth_biases is not None else ""), fontsize=9)
    axes[0].legend(fontsize=8, loc="upper right", ncols=3)


def plot_window(axes, s, t):
    size, time = axes
    for k, (name, factor, label) in enumerate((("landmarks", 1, "landmarks"), ("observations", 0.1, "observations / 10"),
                                               ("frames", 10, "frames x 10"))):
        size.plot(t, factor * s[name], color=C.series(k).color, linewidth=1.0, label=label)
    size.set_ylim(bottom=0)
    size.legend(fontsize=8, loc="lower right", ncols=3)
    plot.finish(size, "", "window")
    time.plot(t, s["ms"], color=C.BLUE, linewidth=0.7)
    median = np.median(s["ms"])
    time.axhline(median, color=C.RED, linewidth=1.0, linestyle="--", label=f"median {median:.2f} ms")
    time.set_ylim(0, 1.15 * np.max(s["ms"]))
    time.legend(fontsize=8, loc="upper right")
    plot.finish(time, "", "time per frame [ms]")


def draw(s, truth):
    t = 1e-9 * (s["timestamp_ns"] - s["timestamp_ns"][0])
    has_imu = bool(np.isfinite(s["s_bax"]).any())
    errors = biases = None
    if truth is not None and np.isfinite(truth.at(s["timestamp_ns"])[:, 0]).sum() > 2:
        errors = window_errors(s, truth, has_imu)
        if truth.biases is not None:
            biases = np.stack([np.interp(s["timestamp_ns"], truth.stamps, column) for column in truth.biases.T], 1)
    # On the left the way and what is left over, on the right panels of equal height.
    panels = (2 if errors is not None else 0) + (2 if has_imu else 0) + 2
    on_right = panels // 2 + 1
    on_left = panels - on_right
    figure = plt.figure(figsize=(11, max(6.5, 1.5 + 1.15 * panels)), layout="constrained")
    left, right = figure.add_gridspec(1, 2)
    left_grid, right_grid = left.subgridspec(on_left + 3, 1), right.subgridspec(on_right, 1)
    top, height = figure.add_subplot(left_grid[0:2]), figure.add_subplot(left_grid[2])
    slots = [figure.add_subplot(right_grid[k], sharex=height) for k in range(on_right)]
    slots += [figure.add_subplot(left_grid[3 + k], sharex=height) for k in range(on_left)]
    plot_path((top, height), s, t, truth if errors is not None else None, has_imu)
    if errors is not None:
        plot_errors([slots.pop(0), slots.pop(0)], s, t, errors)
    if has_imu:
        plot_biases([slots.pop(0), slots.pop(0)], s, t, biases)
    plot_window([slots.pop(0), slots.pop(0)], s, t)
    for ax in figure.axes[1:]:
        last = ax.get_subplotspec().is_last_row()
        ax.tick_params(labelbottom=last)
        if last:
            ax.set_xlabel("time [s]")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("states", type=pathlib.Path, help="file of vio_replay --states")
    parser.add_argument("truth", type=pathlib.Path, help='folder of the recording, groundtruth.csv, or "-"')
    parser.add_argument("picture", type=pathlib.Path, help=".png (or .pdf, .svg) to write")
    args = parser.parse_args()
    try:
        states = read_states(args.states)
        truth = None if str(args.truth) == "-" else read_truth(args.truth)
    except (OSError, ValueError, KeyError, IndexError) as error:
        fail(f"{args.states}, {args.truth}: {error}")
    save(draw(states, truth), args.picture)


if __name__ == "__main__":
    main()
