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

Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import pathlib

from plot_util import fail, np, plot, plt, read_json, save

C = plot.colors
METHODS = (("fixed", C.GREY), ("free", C.BLUE), ("prior", C.YELLOW))
WEIGHT = "prior weight [1/m$^2$, 1/rad$^2$]"


def of_sweep(study):
    """The configuration that the weights belong to."""
    for row in study["configurations"]:
        if f"{row['trajectory']} {row['points']}" == study["sweep_configuration"]:
            return row
    raise KeyError(study["sweep_configuration"])


def plot_accuracy(study):
    rows = [r for r in study["weights"] if r["weight"] > 0]
    methods = of_sweep(study)["methods"]
    figure, axes = plt.subplots(3, 1, figsize=(7.2, 7.6), sharex=True, layout="constrained")
    for ax, (key, label) in zip(axes, (("p_m", "position"), ("phi_deg", "rotation"), ("v_mps", "velocity"))):
        fixed = methods["fixed"][key]
        ax.plot([r["weight"] for r in rows], [100 * (r[key] / fixed - 1) for r in rows], marker="o", markersize=4,
                color=C.BLUE, label="prior")
        ax.axhline(0, color=C.BLACK, linestyle="--", linewidth=1.1, label="fixed")
        ax.axhline(100 * (methods["free"][key] / fixed - 1), color=C.RED, linestyle=":", label="free")
        ax.set_xscale("log")
        plot.finish(ax, None, f"{label} RMSE,\nagainst fixed [%]")
    axes[0].legend(loc="best", fontsize=9)
    axes[0].set_title(f"Accuracy against the weight of the prior ({study['sweep_configuration']})")
    axes[2].set_xlabel(WEIGHT)
    return figure


def plot_iterations(study):
    rows = study["weights"]
    x = range(len(rows))
    fixed = of_sweep(study)["methods"]["fixed"]
    figure, axes = plt.subplots(2, 1, figsize=(7.6, 6.2), sharex=True, layout="constrained")
    low = [r["iterations"] - r["iterations_quartiles"][0] for r in rows]
    high = [r["iterations_quartiles"][1] - r["iterations"] for r in rows]
    axes[0].errorbar(x, [r["iterations"] for r in rows], yerr=(low, high), capsize=3, marker="o", markersize=4,
                     color=C.BLUE, label="as in the paper: $\\lambda_0 = 10^{-4}$")
    axes[1].plot(x, [r["time_ms"] for r in rows], marker="o", markersize=4, color=C.BLUE)
    light = [r["light_damping"] for r in rows]
    axes[0].plot(x, [r["iterations"] for r in light], marker="s", markersize=4, color=C.RED,
                 label="light damping: $\\lambda_0 = 10^{-9}$")
    axes[1].plot(x, [r["time_ms"] for r in light], marker="s", markersize=4, color=C.RED)
    axes[0].axhline(fixed["iterations"], color=C.BLACK, linestyle="--", linewidth=1.1, label="fixed")
    axes[1].axhline(fixed["time_ms"], color=C.BLACK, linestyle="--", linewidth=1.1)
    for ax, label in zip(axes, ("iterations (median, quartiles)", "time [ms] (median)")):
        ax.set_ylim(bottom=0)
        plot.finish(ax, None, label)
    axes[0].legend(loc="upper right", fontsize=9)
    axes[0].set_title(f"Cost of a solve against the weight ({study['sweep_configuration']})")
    names = ["0 (free)" if r["weight"] == 0 else f"{r['weight']:g}" for r in rows]
    axes[1].set_xticks(list(x), names, rotation=45, ha="right")
    axes[1].set_xlabel(WEIGHT)
    return figure


def plot_path(study):
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 4.6), sharey=True, layout="constrained")
    for ax, key, label in ((axes[0], "prior_position_m", "prior error, position [m]"),
                           (axes[1], "prior_yaw_rad", "prior error, yaw [rad]")):
        paths = [(row["weight"], [(s[key], s["reprojection_px"]) for s in row["steps"]]) for row in study["paths"]]
        plot.step_paths(ax, paths, label, free="free")
    plot.plain_ticks(axes[0])
    axes[0].set_ylabel("mean reprojection error [px]")
    axes[1].legend(loc="best", fontsize=9)
    figure.suptitle("The way to the solution, step by step")
    return figure


def plot_methods(study):
    rows = [(f"{r['trajectory']}\n{r['points']}", r["methods"]) for r in study["configurations"]]
    rows += [(r["dataset"].replace("_semi", "").replace("_", "\n", 1), r["methods"]) for r in study["real"]]
    figure, axes = plt.subplots(2, 1, figsize=(8.6, 6.2), sharex=True, layout="constrained")
    for ax, key, label in zip(axes, ("iterations", "time_ms"), ("iterations (median)", "time, against fixed")):
        for k, (method, color) in enumerate(METHODS):
            scale = [m["fixed"][key] if key == "time_ms" else 1 for _, m in rows]
            ax.bar([i + 0.27 * (k - 1) for i in range(len(rows))],
                   [m[method][key] / s for (_, m), s in zip(rows, scale)], width=0.25, color=color, label=method)
        plot.finish(ax, None, label)
    axes[0].legend(loc="best", fontsize=9, ncols=3)
    axes[0].set_ylim(top=1.25 * axes[0].get_ylim()[1])
    axes[0].set_title("Iterations and time of the three ways")
    axes[1].set_xticks(range(len(rows)), [name for name, _ in rows], fontsize=9)
    return figure


def largest_of_blocks(log10_values):
    """Of [p, theta, v] of each keyframe in turn: all p, all theta, all v, and of each 3 x 3 the largest, no
    longer as a logarithm (axes alternate, which says little and is a pattern of its own)."""
    order = [9 * k + 3 * q + i for q in range(3) for k in range(len(log10_values) // 9) for i in range(3)]
    values = np.array([[-np.inf if x is None else x for x in row] for row in log10_values])[np.ix_(order, order)]
    n = len(values) // 3
    return 10.0 ** values.reshape(n, 3, n, 3).max(axis=(1, 3))


def plot_covariance(covariance, title):
    groups = [(name, covariance["keyframes"]) for name in ("position", "rotation", "velocity")]
    matrices = {name: largest_of_blocks(covariance[f"log10_{name}"])
                for name in ("free", "transformed", "fixed", "difference")}
    top = max(float(np.log10(matrices[name].max())) for name in ("free", "transformed", "fixed"))
    figure, axes = plt.subplots(1, 4, figsize=(14.4, 3.9), layout="constrained")
    titles = ("free (pseudo-inverse)", "free, transformed", "fixed", "transformed less fixed")
    for ax, (name, values), label in zip(axes, matrices.items(), titles):
        last = name == "difference"
        plot.matrix(values, groups, decades=8 if last else top + 7, top=-8 if last else top, title=label,
                    colorbar=False, ax=ax)
    figure.colorbar(axes[0].images[0], ax=axes[:3], shrink=0.8, label="log$_{10}$(|covariance| + 10$^{-7}$)")
    figure.colorbar(axes[3].images[0], ax=axes[3], shrink=0.8,
                    label="log$_{10}$ |difference| / (var$_i$ var$_j$)$^{1/2}$")
    figure.suptitle(f"{title}: {covariance['keyframes']} keyframes, first to last within a quantity; "
                    f"transformed against fixed {covariance['relative_error']:.1e} of the norm")
    return figure


def plot_ellipses(covariance, title):
    sets = {name: np.array(rows) for name, rows in covariance["ellipses_x_y_xx_xy_yy"].items()}
    wide = np.ptp(sets["fixed"][:, 0]) > np.ptp(sets["fixed"][:, 1])
    figure, axes = plt.subplots(3 if wide else 1, 1 if wide else 3, layout="constrained", sharex=True, sharey=True,
                                figsize=(8.0, 6.6) if wide else (12.0, 4.6))
    for ax, name, color in zip(axes, ("free", "transformed", "fixed"), (C.BLUE, C.RED, C.BLACK)):
        rows = sets[name]
        ax.plot(rows[:, 0], rows[:, 1], color=color, linewidth=1, marker=".", markersize=4)
        plot.ellipses(rows[:, :2], rows[:, [2, 3, 3, 4]].reshape(-1, 2, 2), color=color, fill=False, ax=ax)
        ax.set_title(name, fontsize=11)
        ax.set_aspect("equal")
        plot.finish(ax, None, "y [m]")
    axes[-1].set_xlabel("x [m]")
    figure.suptitle(f"{title}: positions with 3 sigma")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path, help=".json file of gauge_study")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    parser.add_argument("--recordings", action="store_true", help="gauge_study_real_NAME.png only")
    args = parser.parse_args()
    study = read_json(args.study)
    try:
        pictures = {f"real_{row['dataset']}": plot_covariance(row["covariance"], row["dataset"])
                    for row in study["real"]}
        if not args.recordings:
            name = study["sweep_configuration"]
            pictures |= {"accuracy": plot_accuracy(study), "iterations": plot_iterations(study),
                         "path": plot_path(study), "methods": plot_methods(study),
                         "covariance": plot_covariance(study["covariance"], name),
                         "ellipses": plot_ellipses(study["covariance"], name)}
    except (KeyError, TypeError, ValueError) as error:
        fail(f"{args.study} is no result of gauge_study: {error!r}")
    for name, figure in pictures.items():
        save(figure, args.folder / f"gauge_study_{name}.png")


if __name__ == "__main__":
    main()
