#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what bench_ba measured:

  bench_ba_profile.png   performance profile (Dolan and More 2002): of how many problems a solver comes
                         within 1e-1, 1e-2, 1e-3 of (initial - best cost) in at most so many times the
                         time of the fastest
  bench_ba_cost.png      cost over time, problem by problem
  bench_ba_growth.png    with --growth: time of a step and peak memory over the observations, with the
                         exponents of a straight line through them

    bench_ba --city 200,1000 --json compare.json
    bench_ba --city 40,100,200,500,1000,2000,5000,10000 --only glissade-auto --json growth.json
    scripts/plot_bench_ba.py compare.json docs/images --growth growth.json

Several results may be given: runs of one problem are put together. The best cost is the least that any
solver has come to, audited.

Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import json
import math
import pathlib

from plot_util import fail, np, plot, plt, save

C = plot.colors
TOLERANCES = (1e-1, 1e-2, 1e-3)
# Ours blue, Ceres's red and yellow; lines tell the solvers of a family apart.
LIGHT_BLUE = "#6699cc"
STYLES = {
    "glissade-auto": (C.BLUE, "-"), "glissade-dense": (C.BLUE, ":"), "glissade-sparse": (C.BLUE, "--"),
    "glissade-pcg": (LIGHT_BLUE, "-"), "glissade-pcg-cluster": (LIGHT_BLUE, "--"),
    "glissade-implicit": (C.GREY, "-"), "glissade-implicit-cluster": (C.GREY, "--"),
    "glissade-implicit-power": (C.GREY, ":"),
    "ceres-dense": (C.RED, ":"), "ceres-dense-lapack": (C.RED, "-."), "ceres-sparse": (C.RED, "-"),
    "ceres-iterative": (C.YELLOW, "-"), "ceres-iterative-explicit": (C.YELLOW, "--"),
    "ceres-iterative-cluster": (C.YELLOW, ":"),
}


# ---- Results -------------------------------------------------------------------------------------
def merged(paths):
    """{problem: {"observations", "initial", "best", "runs": {solver: [run]}}}, all files together."""
    problems = {}
    for path in paths:
        result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        if result.get("tool") != "bench_ba":
            raise ValueError(f"{path} is no result of bench_ba")
        for p in result["problems"]:
            name = pathlib.Path(p["name"]).name.removesuffix(".txt.gz")
            problem = problems.setdefault(name, {"observations": p["observations"], "initial": p["initial_cost"],
                                                 "runs": {}})
            for solver in p["solvers"]:
                problem["runs"].setdefault(solver["name"], []).extend(solver["runs"])
    for problem in problems.values():
        costs = [run["audited_cost"] for runs in problem["runs"].values() for run in runs
                 if run["audited_cost"] is not None]
        problem["best"] = min(costs) if costs else math.nan
    return problems


def median(values):
    return sorted(values)[len(values) // 2]


def seconds_to(runs, wanted):
    """Median over the runs of when the cost was there; infinity where one has not come to it."""
    times = []
    for run in runs:
        times.append(next((seconds for seconds, cost, accepted, _ in run["trace"]
                           if accepted and cost is not None and cost <= wanted), math.inf))
    return median(times)


def step_seconds(runs):
    """Median over the runs of the median over accepted steps but the first."""
    medians = []
    for run in runs:
        trace = run["trace"]
        steps = [trace[k][0] - trace[k - 1][0] for k in range(2, len(trace)) if trace[k][2]]
        if steps:
            medians.append(median(steps))
    return median(medians) if medians else math.nan


def order(names):
    known = list(STYLES)
    return sorted(names, key=lambda name: (known.index(name) if name in STYLES else len(known), name))


# ---- Pictures ------------------------------------------------------------------------------------
def draw_profile(problems):
    names = order({name for problem in problems.values() for name in problem["runs"]})
    figure, axes = plt.subplots(1, len(TOLERANCES), figsize=(13, 4.2), sharey=True, layout="constrained")
    for axis, tolerance in zip(axes, TOLERANCES):
        ratios = {name: [] for name in names}
        for problem in problems.values():
            wanted = problem["best"] + tolerance * (problem["initial"] - problem["best"])
            times = {name: seconds_to(runs, wanted) for name, runs in problem["runs"].items()}
            fastest = min(times.values())
            for name in names:
                time = times.get(name, math.inf)
                ratios[name].append(time / fastest if fastest < math.inf else math.inf)
        right = 1.3 * max(r for rs in ratios.values() for r in rs if r < math.inf)
        for name in names:
            solved = sorted(r for r in ratios[name] if r < math.inf)
            x = [1.0] + [value for r in solved for value in (r, r)] + [right]
            y = [0.0] + [value for k in range(len(solved)) for value in (k, k + 1)] + [len(solved)]
            color, line = STYLES.get(name, (C.GREY, "-"))
            axis.plot(x, [100 * value / len(problems) for value in y], line, color=color, label=name,
                      lw=2.4 if name == "glissade-auto" else 1.4)
        axis.set(xscale="log", xlim=(1, right), ylim=(-2, 104), xlabel="time over that of the fastest",
                 title=f"within {tolerance:g} of (initial - best)")
        plot.plain_ticks(axis, "x")
        plot.finish(axis)
    axes[0].set_ylabel(f"of {len(problems)} problems [%]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center", fontsize=8)
    return figure


def draw_cost(problems):
    columns = min(3, len(problems))
    rows = -(-len(problems) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4.6 * columns, 3.4 * rows + 0.3), squeeze=False,
                                layout="constrained")
    handles = {}
    for axis, (name, problem) in zip(axes.flat, problems.items()):
        scale = problem["initial"] - problem["best"]
        for solver in order(problem["runs"]):
            run = problem["runs"][solver][0]
            x, y = [], []
            for seconds, cost, accepted, _ in run["trace"]:
                if not accepted or cost is None:
                    continue
                x.append(seconds)
                y.append(max((cost - problem["best"]) / scale, 1e-7))
                if y[-1] < 1e-6:  # below is what stopping rules are for
                    break
            color, line = STYLES.get(solver, (C.GREY, "-"))
            handles[solver], = axis.plot(x, y, line, color=color, label=solver, marker=".", markersize=3,
                                         lw=2.2 if solver == "glissade-auto" else 1.2)
        axis.set(xscale="log", yscale="log", ylim=(1e-6, 2), xlabel="time since the solve began [s]",
                 ylabel="(cost - best) / (initial - best)", title=f"{name}: {problem['observations']} observations")
        axis.title.set_fontsize(9)
        plot.plain_ticks(axis, "x")
        plot.finish(axis)
    for axis in axes.flat[len(problems):]:
        axis.set_axis_off()
    names = order(handles)
    figure.legend([handles[name] for name in names], names, loc="outside right center", fontsize=8)
    return figure


def draw_growth(problems):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    names = order({name for problem in problems.values() for name in problem["runs"]})
    for axis, what, unit in ((axes[0], "time of a step", "s"), (axes[1], "peak memory", "MiB")):
        for name in names:
            points = []
            for problem in problems.values():
                runs = problem["runs"].get(name, [])
                peaks = [run["peak_mb"] for run in runs if run["peak_mb"] is not None]
                value = step_seconds(runs) if unit == "s" else max(peaks, default=math.nan)
                if math.isfinite(value):
                    points.append((problem["observations"], value))
            points.sort()
            if len(points) < 2:
                continue
            x, y = np.array(points).T
            slope, offset = np.polyfit(np.log(x), np.log(y), 1)
            color, line = STYLES.get(name, (C.GREY, "-"))
            axis.plot(x, np.exp(offset) * x ** slope, ":", color=color, lw=1)
            axis.plot(x, y, line, color=color, marker="o", markersize=4, label=f"{name}: n^{slope:.2f}")
            print(f"{what}, {name}: n^{slope:.3f}; " +
                  ", ".join(f"{int(n)}: {value:.4g} {unit}" for n, value in points))
        axis.set(xscale="log", yscale="log", xlabel="observations", ylabel=f"{what} [{unit}]")
        plot.plain_ticks(axis)
        plot.finish(axis)
        axis.legend(fontsize=9)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="*", help="of bench_ba --json: profile and cost over time")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    parser.add_argument("--growth", nargs="+", default=[], metavar="RESULT", help="results for the growth")
    args = parser.parse_args()
    try:
        problems, growth = merged(args.results), merged(args.growth)
    except (OSError, ValueError, KeyError) as error:
        fail(error)
    if problems:
        save(draw_profile(problems), args.folder / "bench_ba_profile.png", dpi=90)
        save(draw_cost(problems), args.folder / "bench_ba_cost.png", dpi=90)
    if growth:
        save(draw_growth(growth), args.folder / "bench_ba_growth.png", dpi=90)


if __name__ == "__main__":
    main()
