# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the cost went down."""

from __future__ import annotations

import typing
from collections.abc import Mapping

import numpy as np

from . import _figure, colors
from .. import _core

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes

Summary: typing.TypeAlias = "_core.SolveSummary | Mapping[str, typing.Any]"

_AGAINST = {"iteration": ("iteration", "iteration"), "time": ("total_time_s", "time [s]")}


def _iterations(name: str, summary: object) -> list[Mapping[str, typing.Any]]:
    """What to_dict() calls iterations."""
    if isinstance(summary, _core.SolveSummary):
        summary = summary.to_dict()
    if not isinstance(summary, Mapping) or not summary.get("iterations"):
        raise ValueError(f"summary{name} must be a SolveSummary, or its to_dict(), with iterations")
    return list(summary["iterations"])


def _by_name(summary: Summary | Mapping[str, Summary]) -> dict[str, list[Mapping[str, typing.Any]]]:
    if isinstance(summary, Mapping) and "iterations" not in summary:
        if not summary:
            raise ValueError("summary is empty")
        return {str(name): _iterations(f"[{name!r}]", one) for name, one in summary.items()}
    return {"": _iterations("", summary)}


def convergence(summary: Summary | Mapping[str, Summary], *, against: str = "iteration", excess: bool = False,
                ax: Axes | None = None) -> Axes:
    """Draws cost over iterations or time; crosses mark steps that were rejected.

    summary: of a solve, what its to_dict() gave, or several by name: {"dogleg": a, "LM": b}. against:
    "iteration" or "time" [s]. excess: draw (cost - best) / (initial - best) instead, where best is the
    least cost of all and initial the greatest first one: the last part of the way, which the cost itself
    hides. The points that are at the best have no place on that scale and are left out.
    """
    if against not in _AGAINST:
        raise ValueError(f"against must be 'iteration' or 'time', not {against!r}")
    runs = _by_name(summary)
    key, xlabel = _AGAINST[against]
    costs = {name: np.array([it["cost"] for it in run], float) for name, run in runs.items()}
    best = min(float(cost.min()) for cost in costs.values())
    span = max(float(cost[0]) for cost in costs.values()) - best
    ax = _figure.axes(ax)
    for k, (name, run) in enumerate(runs.items()):
        look = colors.series(k)
        x = np.array([it[key] for it in run], float)
        y = costs[name]
        if excess:
            y = np.where(y > best, (y - best) / (span if span > 0 else 1.0), np.nan)
        taken = np.array([it["accepted"] for it in run], bool)
        ax.plot(x, y, look.line, color=look.color, linewidth=1.4, label=name or None)
        ax.plot(x[taken], y[taken], look.marker, color=look.color, markersize=4)
        if not taken.all():
            ax.plot(x[~taken], y[~taken], "x", color=look.color, markersize=6)
    drawn = np.concatenate([line.get_ydata() for line in ax.lines]) if excess else np.concatenate(list(costs.values()))
    drawn = np.asarray(drawn, float)[np.isfinite(drawn)]
    if drawn.size and drawn.min() > 0:
        ax.set_yscale("log")
        if drawn.max() < 100 * drawn.min():
            _figure.plain_ticks(ax)
    if len(runs) > 1:
        ax.legend(fontsize=9)
    if against == "iteration":
        from matplotlib.ticker import MaxNLocator

        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    return _figure.finish(ax, xlabel, "(cost - best) / (initial - best)" if excess else "cost")
