#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what gauge_study found, in the manner of the figures of Zhang, Gallego, Scaramuzza, "On the
Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial State Estimation" (RA-L
2018):

  gauge_study_accuracy.png      errors against the weight of the prior (Fig. 4)
  gauge_study_iterations.png    iterations and time against the weight (Fig. 5)
  gauge_study_path.png          prior error against reprojection error, step by step (Fig. 6)
  gauge_study_methods.png       iterations and time of fixed, free, prior (Figs 7, 11)
  gauge_study_covariance.png    free, transformed and fixed covariance, simulated (Fig. 9)
  gauge_study_ellipses.png      what they say of the positions (Fig. 1)
  gauge_study_real_NAME.png     covariances of a recording (Fig. 10)

    gauge_study --trials 50 --vio DIR --json study.json
    scripts/plot_gauge_study.py study.json docs/images

Needs matplotlib and numpy (Debian, Ubuntu: python3-matplotlib).
"""

import argparse
import json
import pathlib
import sys

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c03028", "#2a8a4a", "#707070"
METHODS = (("fixed", GREY), ("free", BLUE), ("prior", GREEN))


def clean(ax, grid="major"):
    ax.grid(True, which=grid, color="#dddddd", linewidth=0.7)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def of_sweep(study):
    """The configuration that the weights belong to."""
    for row in study["configurations"]:
        if f"{row['trajectory']} {row['points']}" == study["sweep_configuration"]:
            return row
    raise KeyError(study["sweep_configuration"])


def plot_accuracy(plt, study, path):
    rows = [r for r in study["weights"] if r["weight"] > 0]
    methods = of_sweep(study)["methods"]
    fig, axes = plt.subplots(3, 1, figsize=(7.2, 7.6), sharex=True, layout="constrained")
    for ax, (key, label) in zip(axes, (("p_m", "position"), ("phi_deg", "rotation"),
                                       ("v_mps", "velocity"))):
        fixed = methods["fixed"][key]
        ax.plot([r["weight"] for r in rows], [100 * (r[key] / fixed - 1) for r in rows], marker="o",
                markersize=4, color=GREEN, label="prior")
        ax.axhline(0, color=GREY, linestyle="--", label="fixed")
        ax.axhline(100 * (methods["free"][key] / fixed - 1), color=BLUE, linestyle=":", label="free")
        ax.set_xscale("log")
        ax.set_ylabel(f"{label} RMSE,\nagainst fixed [%]")
        clean(ax)
    axes[0].legend(loc="best", fontsize=9)
    axes[0].set_title(f"Accuracy against the weight of the prior ({study['sweep_configuration']})")
    axes[2].set_xlabel("prior weight [1/m$^2$, 1/rad$^2$]")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def plot_iterations(plt, study, path):
    rows = study["weights"]
    names = ["0 (free)" if r["weight"] == 0 else f"{r['weight']:g}" for r in rows]
    x = range(len(rows))
    fixed = of_sweep(study)["methods"]["fixed"]
    fig, axes = plt.subplots(2, 1, figsize=(7.6, 6.2), sharex=True, layout="constrained")
    low = [r["iterations"] - r["iterations_quartiles"][0] for r in rows]
    high = [r["iterations_quartiles"][1] - r["iterations"] for r in rows]
    axes[0].errorbar(x, [r["iterations"] for r in rows], yerr=(low, high), capsize=3, marker="o",
                     markersize=4, color=GREEN, label="as in the paper: $\\lambda_0 = 10^{-4}$")
    axes[1].plot(x, [r["time_ms"] for r in rows], marker="o", markersize=4, color=GREEN)
    light = [r["light_damping"] for r in rows]
    axes[0].plot(x, [r["iterations"] for r in light], marker="s", markersize=4, color=RED,
                 label="light damping: $\\lambda_0 = 10^{-9}$")
    axes[1].plot(x, [r["time_ms"] for r in light], marker="s", markersize=4, color=RED)
    axes[0].axhline(fixed["iterations"], color=GREY, linestyle="--", label="fixed")
    axes[1].axhline(fixed["time_ms"], color=GREY, linestyle="--")
    for ax, label in zip(axes, ("iterations (median, quartiles)", "time [ms] (median)")):
        ax.set_ylabel(label)
        ax.set_ylim(bottom=0)
        clean(ax)
    axes[0].legend(loc="upper right", fontsize=9)
    axes[0].set_title(f"Cost of a solve against the weight ({study['sweep_configuration']})")
    axes[1].set_xticks(list(x), names, rotation=45, ha="right")
    axes[1].set_xlabel("prior weight [1/m$^2$, 1/rad$^2$]")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def plot_path(plt, study, path):
    fig, axes = plt.subplots(1, 2, figsize=(9.6, 4.6), sharey=True, layout="constrained")
    panels = (("prior_position_m", "prior error, position [m]"),
              ("prior_yaw_rad", "prior error, yaw [rad]"))
    for ax, (key, label) in zip(axes, panels):
        for k, row in enumerate(study["paths"]):
            color = plt.cm.viridis(0.92 * k / max(1, len(study["paths"]) - 1))
            name = "free" if row["weight"] == 0 else f"w = {row['weight']:g}"
            ax.plot([s[key] for s in row["steps"]], [s["reprojection_px"] for s in row["steps"]],
                    marker="o", markersize=4, linewidth=1.3, color=color, label=name)
        start = study["paths"][0]["steps"][0]
        ax.plot(start[key], start["reprojection_px"], marker="s", markersize=9, color="black",
                fillstyle="none", linestyle="none", label="start")
        ax.set_yscale("log")
        ax.set_xlabel(label)
        clean(ax)
    values = [s["reprojection_px"] for row in study["paths"] for s in row["steps"]]
    ticks = [t for t in (0.5, 1, 2, 3, 5, 10, 20, 30, 50, 100) if min(values) / 2 <= t <= 2 * max(values)]
    axes[0].set_yticks(ticks, [f"{t:g}" for t in ticks])
    axes[0].yaxis.set_minor_locator(plt.NullLocator())
    axes[0].set_ylabel("mean reprojection error [px]")
    axes[1].legend(loc="best", fontsize=9)
    fig.suptitle("The way to the solution, step by step")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def plot_methods(plt, study, path):
    rows = [(f"{r['trajectory']}\n{r['points']}", r["methods"]) for r in study["configurations"]]
    rows += [(r["dataset"].replace("_semi", "").replace("_", "\n", 1), r["methods"])
             for r in study["real"]]
    fig, axes = plt.subplots(2, 1, figsize=(8.6, 6.2), sharex=True, layout="constrained")
    for ax, key, label in zip(axes, ("iterations", "time_ms"),
                              ("iterations (median)", "time, against fixed")):
        for k, (method, color) in enumerate(METHODS):
            scale = [m["fixed"][key] if key == "time_ms" else 1 for _, m in rows]
            ax.bar([i + 0.27 * (k - 1) for i in range(len(rows))],
                   [m[method][key] / s for (_, m), s in zip(rows, scale)], width=0.25, color=color,
                   label=method)
        ax.set_ylabel(label)
        clean(ax)
    axes[0].legend(loc="best", fontsize=9, ncols=3)
    axes[0].set_ylim(top=1.25 * axes[0].get_ylim()[1])
    axes[0].set_title("Iterations and time of the three ways")
    axes[1].set_xticks(range(len(rows)), [name for name, _ in rows], fontsize=9)
    fig.savefig(path, dpi=100)
    plt.close(fig)


def by_quantity(matrix, np):
    """[p, theta, v] of each keyframe in turn -> all p, all theta, all v."""
    order = [9 * k + 3 * q + i for q in range(3) for k in range(len(matrix) // 9) for i in range(3)]
    return np.array([[np.nan if x is None else x for x in row] for row in matrix])[np.ix_(order, order)]


def plot_covariance(plt, covariance, title, path):
    import numpy as np

    names = (("log10_free", "free (pseudo-inverse)"), ("log10_transformed", "free, transformed"),
             ("log10_fixed", "fixed"), ("log10_difference", "transformed less fixed"))
    fig, axes = plt.subplots(1, 4, figsize=(14.4, 3.9), layout="constrained")
    matrices = {key: by_quantity(covariance[key], np) for key, _ in names}
    n = 3 * covariance["keyframes"]
    top = max(np.nanmax(matrices[key]) for key, _ in names[:3])
    for ax, (key, label) in zip(axes, names):
        image = matrices[key]
        # The largest of each 3 x 3: axes alternate, which says little and is a pattern of its own.
        blocks = image.reshape(len(image) // 3, 3, len(image) // 3, 3)
        image = np.fmax.reduce(np.fmax.reduce(blocks, axis=3), axis=1)
        last = key == "log10_difference"
        shown = ax.imshow(image, cmap="magma" if last else "viridis", vmin=-16 if last else -7,
                          vmax=-8 if last else top, interpolation="nearest",
                          extent=(0, 3 * n, 3 * n, 0))
        ax.set_title(label, fontsize=11)
        ax.set_xticks([n / 2, 3 * n / 2, 5 * n / 2], ["position", "rotation", "velocity"], fontsize=9)
        ax.set_yticks([n / 2, 3 * n / 2, 5 * n / 2], ["position", "rotation", "velocity"], fontsize=9,
                      rotation=90, va="center")
        ax.tick_params(length=0)
        for edge in (n, 2 * n):
            ax.axhline(edge, color="white", lw=0.6)
            ax.axvline(edge, color="white", lw=0.6)
        if key == "log10_fixed":
            fig.colorbar(shown, ax=axes[:3], shrink=0.8, label="log$_{10}$(|covariance| + 10$^{-7}$)")
        if last:
            fig.colorbar(shown, ax=ax, shrink=0.8,
                         label="log$_{10}$ |difference| / sqrt(var$_i$ var$_j$)")
    fig.suptitle(f"{title}: {covariance['keyframes']} keyframes, first to last within a quantity; "
                 f"transformed against fixed {covariance['relative_error']:.1e} of the norm")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def plot_ellipses(plt, covariance, title, path):
    import numpy as np

    circle = np.array([[np.cos(t), np.sin(t)] for t in np.linspace(0, 2 * np.pi, 60)])
    sets = covariance["ellipses_x_y_xx_xy_yy"]
    wide = max(np.ptp(np.array(sets["fixed"])[:, 0]), 1e-9) > np.ptp(np.array(sets["fixed"])[:, 1])
    fig, axes = plt.subplots(3 if wide else 1, 1 if wide else 3, layout="constrained", sharex=True,
                             sharey=True, figsize=(8.0, 6.6) if wide else (12.0, 4.6))
    for ax, key, color in zip(axes, ("free", "transformed", "fixed"), (BLUE, GREEN, GREY)):
        rows = np.array(sets[key])
        ax.plot(rows[:, 0], rows[:, 1], color=color, linewidth=1, marker=".", markersize=4)
        for x, y, xx, xy, yy in rows:
            values, vectors = np.linalg.eigh([[xx, xy], [xy, yy]])
            half = vectors * (3 * np.sqrt(np.maximum(values, 0)))
            ellipse = circle @ half.T + (x, y)
            ax.plot(ellipse[:, 0], ellipse[:, 1], color=color, linewidth=1)
        ax.set_title(key, fontsize=11)
        ax.set_ylabel("y [m]")
        ax.set_aspect("equal")
        clean(ax)
    axes[-1].set_xlabel("x [m]")
    fig.suptitle(f"{title}: positions with 3 sigma")
    fig.savefig(path, dpi=100)
    plt.close(fig)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path, help=".json file of gauge_study")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    parser.add_argument("--recordings", action="store_true", help="gauge_study_real_NAME.png only")
    args = parser.parse_args()
    try:
        with open(args.study, encoding="utf-8") as file:
            study = json.load(file)
        of_sweep(study)
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"plot_gauge_study.py: {args.study}: {error}", file=sys.stderr)
        return 2
    try:
        import matplotlib
    except ImportError:
        print("plot_gauge_study.py: needs matplotlib (Debian, Ubuntu: python3-matplotlib)",
              file=sys.stderr)
        return 2
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    args.folder.mkdir(parents=True, exist_ok=True)

    def to(name):
        return args.folder / f"gauge_study_{name}.png"

    for row in study["real"]:
        plot_covariance(plt, row["covariance"], row["dataset"], to(f"real_{row['dataset']}"))
    if args.recordings:
        return 0
    plot_accuracy(plt, study, to("accuracy"))
    plot_iterations(plt, study, to("iterations"))
    plot_path(plt, study, to("path"))
    plot_methods(plt, study, to("methods"))
    plot_covariance(plt, study["covariance"], study["sweep_configuration"], to("covariance"))
    plot_ellipses(plt, study["covariance"], study["sweep_configuration"], to("ellipses"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
