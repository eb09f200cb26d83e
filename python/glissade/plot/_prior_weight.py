# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What prior_weight_sweep found: how the weight of a prior changes accuracy, cost and way of a solve.

A sweep is what the program writes as JSON (its --json), or a dict of the same shape made by yourself:

    {"rows": [{"weight": 10.0, "fixed": False, "trials": [{"pose_error_m": 0.01, ...}, ...]}, ...]}

A row is a weight, 0 for none, or two fixed poses ("fixed": True, weight None). Figures are in the manner of
Figs 4 to 6 of Zhang, Gallego, Scaramuzza, "On the Comparison of Gauge Freedom Handling in
Optimization-Based Visual-Inertial State Estimation" (RA-L 2018).
"""

from __future__ import annotations

import statistics
import typing
from collections.abc import Mapping, Sequence

from . import _figure, colors
from ._bands import band

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row: typing.TypeAlias = Mapping[str, typing.Any]
Sweep: typing.TypeAlias = Mapping[str, typing.Any]

_WEIGHT = "prior weight [1/m$^2$, 1/rad$^2$]"


def _rows(sweep: Sweep) -> list[Row]:
    """Rows with a prior, by weight; ValueError where there is none."""
    try:
        rows = [row for row in sweep["rows"] if not row["fixed"] and row["weight"] > 0 and row["trials"]]
    except (KeyError, TypeError) as error:
        raise ValueError(f"sweep must be a dict as prior_weight_sweep writes it: {error!r}") from None
    if not rows:
        raise ValueError("sweep has no weights above 0")
    return sorted(rows, key=lambda row: float(row["weight"]))


def _one(sweep: Sweep, fixed: bool) -> Row | None:
    """The row of fixed poses, or of no prior; None where there is none."""
    return next((row for row in sweep["rows"] if row["fixed"] is fixed and (fixed or row["weight"] == 0)), None)


def _quartiles(row: Row, key: str, scale: float) -> tuple[float, float, float]:
    """Low, median and high of the trials."""
    try:
        values = sorted(scale * trial[key] for trial in row["trials"])
    except KeyError:
        raise ValueError(f"sweep has a trial without {key!r}") from None
    if len(values) == 1:
        return values[0], values[0], values[0]
    quarter = statistics.quantiles(values, n=4, method="inclusive")
    return quarter[0], statistics.median(values), quarter[2]


def _description(sweep: Sweep) -> str:
    """How this sweep was solved, as far as it says."""
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


def _draw(ax: Axes, sweep: Sweep, key: str, k: int, label: str, scale: float = 1.0) -> None:
    """Sweep k: the first one is on top."""
    rows, look = _rows(sweep), colors.series(k)
    low, middle, high = zip(*(_quartiles(row, key, scale) for row in rows))
    band([row["weight"] for row in rows], low, middle, high, color=look.color, label=label, marker=look.marker,
         zorder=3.0 - 0.1 * k, ax=ax)


def _levels(ax: Axes, sweep: Sweep, key: str, free_label: str, scale: float = 1.0) -> None:
    """Lines at what fixed poses and no prior at all give."""
    for fixed, label, line in ((True, "two poses fixed", "--"), (False, free_label, ":")):
        row = _one(sweep, fixed)
        if row is not None:
            ax.axhline(_quartiles(row, key, scale)[1], color=colors.BLACK, linewidth=1.1, linestyle=line, label=label)


def _finish(ax: Axes, ylabel: str, log_y: bool) -> None:
    ax.set_xscale("log")
    if log_y:
        ax.set_yscale("log")
    _figure.finish(ax, None, ylabel)


def prior_weights(*sweeps: Sweep) -> Figure:
    """Draws the errors of poses and points against the weight: medians and quartiles of the trials.

    The first sweep also says what fixed poses and no prior give, and how its pose error comes near that of
    fixed poses as the weight grows (last panel, where it has a row of them). Trials need pose_error_m [m];
    point_error_per_m [1/m] has its panel where the first sweep's trials have it.
    """
    if not sweeps:
        raise ValueError("sweeps: at least one is needed")
    first = sweeps[0]
    has_points = "point_error_per_m" in _rows(first)[0]["trials"][0]
    fixed = _one(first, True)
    heights = [1.25] + [1.0] * (has_points + (fixed is not None))
    fig, axes = _figure.figure(len(heights), 1, (7.4, 2.9 * len(heights)), sharex=True,
                               gridspec_kw={"height_ratios": heights})
    panels = [("pose_error_m", "pose error [mm]"), ("point_error_per_m", "point error [1/km]")][:1 + has_points]
    for ax, (key, ylabel) in zip(axes, panels):
        for k, sweep in enumerate(sweeps):
            _draw(ax, sweep, key, k, _description(sweep), 1e3)
        _levels(ax, first, key, "no prior, aligned to the truth", 1e3)
        _finish(ax, ylabel, log_y=len(sweeps) > 1)
    axes[0].set_title("Accuracy against the weight of the prior")
    axes[0].legend(loc="best", fontsize=8.5)
    if fixed is not None:
        _draw_approach(axes[-1], first, fixed)
    axes[-1].set_xlabel(_WEIGHT)
    return fig


def _draw_approach(ax: Axes, sweep: Sweep, fixed: Row) -> None:
    target = _quartiles(fixed, "pose_error_m", 1e3)[1]
    curve = [(float(row["weight"]), abs(_quartiles(row, "pose_error_m", 1e3)[1] - target)) for row in _rows(sweep)]
    look = colors.series(0)
    ax.plot(*zip(*curve), marker=look.marker, markersize=4, color=look.color, label=_description(sweep))
    heavy = next(((w, e) for w, e in curve if 1e3 <= w <= 1e6 and e > 0), None)
    if heavy is not None:
        ends = (heavy[0] / 10, 1e3 * heavy[0])
        ax.plot(ends, [heavy[0] * heavy[1] / w for w in ends], color=colors.GREY, linestyle="--", label="1 / weight")
    _finish(ax, "pose error, less that of\nfixed poses [mm]", log_y=any(error > 0 for _, error in curve))
    ax.legend(loc="best", fontsize=8.5)


def prior_weight_time(sweep: Sweep) -> Figure:
    """Draws iterations and time [ms] of a solve against the weight: medians and quartiles.

    Trials need iterations and time_ms.
    """
    _rows(sweep)
    fig, axes = _figure.figure(2, 1, (7.0, 5.6), sharex=True)
    for ax, key, ylabel in zip(axes, ("iterations", "time_ms"), ("iterations", "time [ms]")):
        _draw(ax, sweep, key, 0, "with prior (median, quartiles)")
        _levels(ax, sweep, key, "no prior")
        _finish(ax, ylabel, log_y=True)
        _figure.plain_ticks(ax)
    axes[0].set_title("Cost of a solve against the weight of the prior")
    axes[0].legend(loc="best", fontsize=9)
    axes[1].set_xlabel(_WEIGHT)
    return fig


def _chosen(rows: list[Row], weights: Sequence[float]) -> list[Row]:
    """The rows of the given weights; of none given at most five, evenly over them."""
    if weights:
        return [row for row in rows if any(abs(row["weight"] - w) <= 1e-6 * w for w in weights)]
    return rows if len(rows) <= 5 else [rows[round(k * (len(rows) - 1) / 4)] for k in range(5)]


def prior_weight_path(sweep: Sweep, weights: Sequence[float] = ()) -> Figure:
    """Draws the way to the solution, prior error against reprojection error, step by step.

    weights: those to be drawn (default: five of them, evenly). Of each the first trial is drawn; it needs
    "steps" with prior_position_error_m, prior_rotation_error_rad and reprojection_error.
    """
    free = _one(sweep, False)
    rows = ([free] if free is not None else []) + _chosen(_rows(sweep), weights)
    if not rows:
        raise ValueError(f"weights: the sweep has none of {list(weights)}")
    if not all(row["trials"][0].get("steps") for row in rows):
        raise ValueError("sweep has no steps")
    fig, axes = _figure.figure(1, 2, (9.6, 4.6), sharey=True)
    for ax, key, xlabel in zip(axes, ("prior_position_error_m", "prior_rotation_error_rad"),
                               ("prior error, position [m]", "prior error, rotation [rad]")):
        paths = [(row["weight"], [(step[key], step["reprojection_error"]) for step in row["trials"][0]["steps"]])
                 for row in rows]
        step_paths(ax, paths, xlabel)
    axes[0].set_ylabel("reprojection error [RMS, normalized image plane]")
    axes[1].legend(loc="best", fontsize=9)
    fig.suptitle("The way to the solution: prior error against reprojection error, step by step")
    return fig


def step_paths(ax: Axes, paths: Sequence[tuple[float, Sequence[tuple[float, float]]]], xlabel: str,
               free: str = "no prior") -> Axes:
    """Draws ways of several solves from one start: (weight, [(prior error, reprojection error), ...]) of each."""
    for (weight, steps), color, k in zip(paths, colors.sequence(len(paths)), range(len(paths))):
        ax.plot(*zip(*steps), marker="os^Dv"[k % 5], markersize=4, linewidth=1.3, color=color,
                label=free if weight == 0 else f"w = {weight:g}")
    ax.plot(*paths[0][1][0], marker="s", markersize=9, color=colors.BLACK, fillstyle="none", linestyle="none",
            label="start")
    ax.set_yscale("log")
    return _figure.finish(ax, xlabel)
