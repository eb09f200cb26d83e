#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what prior_weight_sweep found, in the manner of Figs 4 to 6 of Zhang, Gallego, Scaramuzza,
"On the Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial State Estimation"
(RA-L 2018):

  prior_weight_accuracy.png     errors against the weight of the prior
  prior_weight_time.png         iterations and time against the weight
  prior_weight_path.png         prior error against reprojection error, iteration by iteration

    prior_weight_sweep --pose-noise 0.1 --trials 50 --json sweep.json
    scripts/plot_prior_weight.py sweep.json [more.json ...] docs/images

Further files are drawn into the first picture for comparison. From a .csv file only the first two
pictures can be made: it has no iterations. Needs matplotlib (Debian, Ubuntu: python3-matplotlib).
"""

import argparse
import csv
import json
import pathlib
import statistics
import sys

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c03028", "#2a8a4a", "#707070"


def read_csv(path):
    """The rows of a CSV file in the shape of the JSON's, as far as it goes."""
    rows = {}
    with open(path, newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            fixed = line["weight"] == "fixed"
            weight = None if fixed else float(line["weight"])
            row = rows.setdefault(weight, {"fixed": fixed, "weight": weight, "trials": []})
            row["aligned"] = weight == 0
            row["trials"].append({
                "pose_error_m": float(line["pose_error_m"]),
                "point_error_per_m": float(line["point_error_per_m"]),
                "iterations": int(line["iterations"]),
                "time_ms": float(line["time_ms"]),
                "converged": line["converged"] == "1",
                "steps": [],
            })
    return {"rows": list(rows.values()), "course_stop": False, "method": "", "pose_noise_m_rad": None}


def read(path):
    if path.suffix == ".csv":
        return read_csv(path)
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def quantiles(row, key):
    """Quartiles of the trials: low, median, high."""
    values = sorted(trial[key] for trial in row["trials"])
    if len(values) == 1:
        return values * 3
    quarter = statistics.quantiles(values, n=4, method="inclusive")
    return quarter[0], statistics.median(values), quarter[2]


def weighted(sweep):
    """Rows with a prior, by weight."""
    rows = [r for r in sweep["rows"] if not r["fixed"] and r["weight"] > 0]
    return sorted(rows, key=lambda r: r["weight"])


def one_row(sweep, kind):
    """The row of fixed poses, or of no prior; None where there is none."""
    for row in sweep["rows"]:
        if kind == "fixed" and row["fixed"]:
            return row
        if kind == "free" and not row["fixed"] and row["weight"] == 0:
            return row
    return None


def band(ax, sweep, key, color, label, marker="o", scale=1.0, zorder=3):
    rows = weighted(sweep)
    x = [r["weight"] for r in rows]
    low, middle, high = zip(*([scale * v for v in quantiles(r, key)] for r in rows))
    ax.fill_between(x, low, high, color=color, alpha=0.18, linewidth=0, zorder=zorder)
    ax.plot(x, middle, marker=marker, markersize=4, color=color, label=label, zorder=zorder)


def level(ax, row, key, color, label, style, scale=1.0):
    if row is not None:
        ax.axhline(scale * quantiles(row, key)[1], color=color, linestyle=style, label=label)


def describe(sweep):
    if sweep.get("course_stop"):
        name = "course's damping and stop"
    elif sweep.get("method") == "course":
        name = "course's damping, converged"
    else:
        name = "converged"
    noise = sweep.get("pose_noise_m_rad")
    if noise is None:
        return name
    return name + (f", start {noise:g} m and rad off" if noise > 0 else ", start at the truth")


def style(ax, ylabel, log_y=False):
    ax.set_xscale("log")
    if log_y:
        ax.set_yscale("log")
    ax.set_ylabel(ylabel)
    ax.grid(True, which="major", color="#dddddd", linewidth=0.7)
    ax.spines[["top", "right"]].set_visible(False)


def plot_accuracy(plt, sweeps, path):
    fig, axes = plt.subplots(3, 1, figsize=(7.4, 8.6), sharex=True, layout="constrained",
                             gridspec_kw={"height_ratios": (1.25, 1, 1)})
    colors = (BLUE, RED, GREEN)
    fixed = one_row(sweeps[0], "fixed")
    quantities = (("pose_error_m", 1e3, "pose error [mm]"), ("point_error_per_m", 1e3, "point error [1/km]"))
    for ax, (key, scale, label) in zip(axes, quantities):
        for k, (sweep, color, marker) in enumerate(zip(sweeps, colors, "os^")):
            band(ax, sweep, key, color, describe(sweep), marker, scale, zorder=5 - k)
        level(ax, fixed, key, GREY, "two poses fixed", "--", scale)
        level(ax, one_row(sweeps[0], "free"), key, GREY, "no prior, aligned to the truth", ":", scale)
        style(ax, label, log_y=len(sweeps) > 1)
    axes[0].set_title("Accuracy against the weight of the prior")
    axes[0].legend(loc="lower left", fontsize=8.5)

    rows = weighted(sweeps[0])
    x = [r["weight"] for r in rows]
    target = quantiles(fixed, "pose_error_m")[1]
    y = [1e3 * abs(quantiles(r, "pose_error_m")[1] - target) for r in rows]
    axes[2].plot(x, y, marker="o", markersize=4, color=BLUE, label=describe(sweeps[0]))
    tail = [(w, e) for w, e in zip(x, y) if 1e3 <= w <= 1e6]
    if tail:
        w0, e0 = tail[0]
        guide = [w0 / 10, 1e3 * w0]
        axes[2].plot(guide, [e0 * w0 / w for w in guide], color=GREY, linestyle="--",
                     label="1 / weight")
    style(axes[2], "pose error, less that of\nfixed poses [mm]", log_y=True)
    axes[2].legend(loc="lower left", fontsize=8.5)
    axes[2].set_xlabel("prior weight [1/m$^2$, 1/rad$^2$]")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def plot_time(plt, sweep, path):
    fig, axes = plt.subplots(2, 1, figsize=(7.0, 5.6), sharex=True, layout="constrained")
    for ax, key, label in zip(axes, ("iterations", "time_ms"), ("iterations", "time [ms]")):
        band(ax, sweep, key, BLUE, "with prior (median, quartiles)")
        level(ax, one_row(sweep, "fixed"), key, GREY, "two poses fixed", "--")
        level(ax, one_row(sweep, "free"), key, GREY, "no prior", ":")
        style(ax, label, log_y=True)
    # Plain numbers: 5, 10, 20, 50 instead of powers of ten.
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
    low, high = axes[0].get_ylim()
    axes[0].yaxis.set_major_locator(FixedLocator([t for t in (1, 2, 3, 5, 7, 10, 20, 40, 80, 160)
                                                  if 0.7 * low <= t <= 1.4 * high]))
    axes[0].yaxis.set_minor_locator(NullLocator())
    axes[0].yaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes[1].yaxis.set_major_locator(FixedLocator([m * 10.0**e for e in range(-4, 3) for m in (1, 2, 5)]))
    axes[1].yaxis.set_minor_locator(NullLocator())
    axes[1].yaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes[0].set_title("Cost of a solve against the weight of the prior")
    axes[0].legend(loc="best", fontsize=9)
    axes[1].set_xlabel("prior weight [1/m$^2$, 1/rad$^2$]")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def choose(rows, weights):
    """The rows of the given weights; of none given, at most five, evenly over the weights."""
    if weights:
        return [r for r in rows if any(abs(r["weight"] - w) <= 1e-6 * w for w in weights)]
    if len(rows) <= 5:
        return rows
    return [rows[round(k * (len(rows) - 1) / 4)] for k in range(5)]


def plot_path(plt, sweep, weights, path):
    rows = choose(weighted(sweep), weights)
    free = one_row(sweep, "free")
    rows = ([free] if free else []) + rows
    panels = (("prior_position_error_m", "prior error, position [m]"),
              ("prior_rotation_error_rad", "prior error, rotation [rad]"))
    fig, axes = plt.subplots(1, 2, figsize=(9.6, 4.6), sharey=True, layout="constrained")
    for ax, (key, label) in zip(axes, panels):
        for k, row in enumerate(rows):
            steps = row["trials"][0]["steps"]
            color = plt.cm.viridis(0.92 * k / max(1, len(rows) - 1))
            name = "no prior" if row["weight"] == 0 else f"w = {row['weight']:g}"
            ax.plot([s[key] for s in steps], [s["reprojection_error"] for s in steps], marker="o",
                    markersize=4, linewidth=1.3, color=color, label=name)
        start = rows[0]["trials"][0]["steps"][0]
        ax.plot(start[key], start["reprojection_error"], marker="s", markersize=8, color="black",
                fillstyle="none", linestyle="none", label="start")
        ax.set_yscale("log")
        ax.set_xlabel(label)
        ax.grid(True, which="major", color="#dddddd", linewidth=0.7)
        ax.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("reprojection error [RMS, normalized image plane]")
    axes[1].legend(loc="best", fontsize=9)
    fig.suptitle("The way to the solution: prior error against reprojection error, step by step")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sweep", type=pathlib.Path, nargs="+",
                        help=".json (or .csv) files of prior_weight_sweep")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    parser.add_argument("--path-weights", type=float, nargs="+", default=[], metavar="W",
                        help="weights in prior_weight_path.png (default: five of them, evenly)")
    args = parser.parse_args()

    try:
        sweeps = [read(path) for path in args.sweep]
        if not weighted(sweeps[0]):
            raise ValueError("no weights above 0")
    except (OSError, ValueError, KeyError) as error:
        print(f"plot_prior_weight.py: {args.sweep[0]}: {error}", file=sys.stderr)
        return 2
    try:
        import matplotlib
    except ImportError:
        print("plot_prior_weight.py: needs matplotlib (Debian, Ubuntu: python3-matplotlib)",
              file=sys.stderr)
        return 2
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    args.folder.mkdir(parents=True, exist_ok=True)
    plot_accuracy(plt, sweeps, args.folder / "prior_weight_accuracy.png")
    plot_time(plt, sweeps[0], args.folder / "prior_weight_time.png")
    if sweeps[0]["rows"][0]["trials"][0]["steps"]:
        plot_path(plt, sweeps[0], args.path_weights, args.folder / "prior_weight_path.png")
    else:
        print("plot_prior_weight.py: no iterations in a .csv: prior_weight_path.png is left out",
              file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
