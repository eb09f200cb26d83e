# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Curves with what is known, or seen, about their spread."""

from __future__ import annotations

import typing
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from . import _check, _figure, colors

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes


def band(x: npt.ArrayLike, low: npt.ArrayLike, middle: npt.ArrayLike, high: npt.ArrayLike, *,
         color: str = colors.BLUE, label: str | None = None, marker: str | None = None,
         alpha: float = 0.18, linewidth: float = 1.2, zorder: float = 2.0, ax: Axes | None = None) -> Axes:
    """Draws a curve and the area from low to high about it: quartiles, or an estimate with its sigmas.

    x, low, middle, high: (n,); where one is NaN there is no area. zorder: the greater is on top.
    """
    x = _check.array("x", x, ("n",))
    low, middle, high = (_check.rows(name, _check.array(name, value, ("n",)), len(x))
                         for name, value in (("low", low), ("middle", middle), ("high", high)))
    ax = _figure.axes(ax)
    ax.fill_between(x, low, high, color=color, alpha=alpha, linewidth=0, zorder=zorder)
    ax.plot(x, middle, marker=marker, markersize=4, color=color, linewidth=linewidth, label=label, zorder=zorder)
    return ax


def errors(t: npt.ArrayLike, error: npt.ArrayLike, sigma: npt.ArrayLike, *, sigmas: float = 3.0,
           names: Sequence[str] = ("x", "y", "z"), xlabel: str = "time [s]", ylabel: str = "error",
           what: str | None = None, ax: Axes | None = None) -> Axes:
    """Draws errors over time and the band that they should stay in; says how many do.

    t: (n,), seconds. error, sigma: (n, k), k up to 3, or (n,); sigma > 0 is the standard deviation that was claimed
    for each of them, in the same unit. The area is sigmas times the largest of a row. Rows with NaN are
    left out. The title says which share of the errors is less than sigmas times its own sigma; of
    Gaussian errors it is 99.7 % for 3.
    """
    t = _check.array("t", t, ("n",))
    e = _check.array("error", error, ("n", "k"), ("n",))
    s = _check.array("sigma", sigma, ("n", "k"), ("n",))
    _check.positive("sigmas", sigmas)
    _check.rows("error", e, len(t))
    if s.shape != e.shape:
        raise ValueError(f"sigma must have the shape of error, {e.shape}, not {s.shape}")
    e, s = e.reshape(len(t), -1), s.reshape(len(t), -1)
    if not 1 <= e.shape[1] <= len(colors.AXES) or e.shape[1] > len(names):
        raise ValueError(f"error has {e.shape[1]} columns, names {len(names)}; at most {len(colors.AXES)} can be drawn")
    ax = _figure.axes(ax)
    known = np.isfinite(e) & np.isfinite(s)
    width = sigmas * np.where(np.isfinite(s).all(axis=1), s.max(axis=1), np.nan)
    ax.fill_between(t, -width, width, color=colors.GREY, alpha=0.22, linewidth=0,
                    label=f"{sigmas:g} sigma" + (", worst axis" if e.shape[1] > 1 else ""))
    for k, (name, (_, color)) in enumerate(zip(names, colors.AXES[:e.shape[1]])):
        ax.plot(t, e[:, k], color=color, linewidth=0.9, label=name)
    if known.any():
        inside = np.abs(e[known]) <= sigmas * s[known]
        title = f"{100 * inside.mean():.1f} % within {sigmas:g} sigma"
        ax.set_title(f"{what}: {title}" if what else title, fontsize=9)
        limit = 1.3 * max(np.nanquantile(np.abs(e), 0.995), np.nanquantile(width, 0.9))
        if limit > 0:
            ax.set_ylim(-limit, limit)
    return _figure.finish(ax, xlabel, ylabel)
