# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Axes to draw on, and what all pictures have in common."""

from __future__ import annotations

import typing

try:
    import matplotlib.pyplot as plt
except ImportError as error:
    raise ImportError(f'glissade.plot needs matplotlib: pip install "glissade[plot]" ({error})') from error

from . import colors

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def axes(ax: Axes | None, figsize: tuple[float, float] = (6.4, 4.4)) -> Axes:
    """The given axes, or the only ones of a new figure, figsize in inches."""
    return plt.subplots(figsize=figsize, layout="constrained")[1] if ax is None else ax


def figure(rows: int, columns: int, figsize: tuple[float, float],
           **options: typing.Any) -> tuple[Figure, list[Axes]]:
    """A new figure of several axes, row by row."""
    fig, grid = plt.subplots(rows, columns, figsize=figsize, layout="constrained", squeeze=False, **options)
    return fig, list(grid.flat)


def finish(ax: Axes, xlabel: str | None = None, ylabel: str | None = None) -> Axes:
    """Labels, a light grid behind everything, no frame on top and on the right."""
    if xlabel is not None:
        ax.set_xlabel(xlabel)
    if ylabel is not None:
        ax.set_ylabel(ylabel)
    ax.grid(True, which="major", color=colors.GRID, linewidth=0.7)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def plain_ticks(ax: Axes, which: str = "y") -> None:
    """Numbers as such, 1, 2, 5, 10, on a logarithmic axis of few decades."""
    from matplotlib import ticker

    axis = ax.yaxis if which == "y" else ax.xaxis
    axis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0), numticks=12))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(ticker.NullLocator())
