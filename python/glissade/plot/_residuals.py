# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whitened errors against what Gaussian noise would make of them."""

from __future__ import annotations

import math
import typing

import numpy as np
import numpy.typing as npt

from . import _check, _figure, colors
from .. import _core

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROWS = {"EdgeBal": 2, "EdgePosePriorVec": 6, "EdgeSE3Prior": 6, "EdgeRelativePose": 6, "EdgeSpeedBiasPrior": 9,
         "EdgeBodyVelocity": 3, "EdgeImu": 15}


def chi_density(x: npt.ArrayLike, dim: int) -> _check.Array:
    """Density of the length of a vector of dim independent standard normal numbers, at x >= 0."""
    if dim < 1:
        raise ValueError(f"dim must be at least 1, not {dim}")
    at = np.asarray(x, dtype=np.float64)
    with np.errstate(divide="ignore"):
        powers = (dim - 1) * np.log(at) if dim > 1 else np.zeros_like(at)
        log_density = (1 - dim / 2) * math.log(2.0) - math.lgamma(dim / 2) + powers - at**2 / 2
    return typing.cast(_check.Array, np.exp(log_density))


def residual_norms(norms: npt.ArrayLike, dim: int, *, bins: int = 60, upper: float | None = None,
                   what: str = "residuals", ax: Axes | None = None) -> Axes:
    """Draws a histogram of the lengths of whitened residuals and the chi density of dim rows.

    norms: (n,), sqrt(r' Omega r), without unit. dim: rows of a residual. upper: where the histogram ends
    (default: the larger of the 99th percentile and where chi has all but 1e-4); the last bin holds
    what lies beyond. Residuals after a solve are a little shorter than chi says, since the solution was
    chosen to make them short: by sqrt(1 - variables / rows) on average.
    """
    x = _check.array("norms", norms, ("n",))
    if len(x) == 0 or not np.isfinite(x).all() or (x < 0).any():
        raise ValueError("norms must be finite and not negative, at least one")
    if bins < 1:
        raise ValueError(f"bins must be at least 1, not {bins}")
    grid = np.linspace(0.0, dim + 12.0, 4000)
    density = chi_density(grid, dim)
    held = np.cumsum(density) * (grid[1] - grid[0])
    end = float(grid[min(int(np.searchsorted(held, 1.0 - 1e-4)), len(grid) - 1)])
    top = max(end, float(np.quantile(x, 0.99))) if upper is None else _check.positive("upper", upper)
    edges = np.linspace(0.0, top, bins + 1)
    counts, _ = np.histogram(np.minimum(x, top), edges)
    ax = _figure.axes(ax)
    ax.bar(edges[:-1], counts / (len(x) * np.diff(edges)), width=np.diff(edges), align="edge", color=colors.BLUE,
           alpha=0.55, linewidth=0, label=f"{len(x)} {what}")
    within = grid[grid <= top]
    ax.plot(within, chi_density(within, dim), color=colors.RED, linewidth=1.6, label=f"chi, {dim} degrees of freedom")
    ax.set_xlim(0.0, top)
    ax.set_title(f"rms {np.sqrt((x**2).mean() / dim):.3g} sigma a row; {100 * (x > end).mean():.2g} % beyond {end:.2g}",
                 fontsize=9)
    ax.legend(fontsize=9)
    return _figure.finish(ax, "length of the whitened residual [sigma]", "density")


def residuals(problem: _core.Problem, edges: _core.EdgeArray | None = None, *, dim: int | None = None,
              bins: int = 60, upper: float | None = None, ax: Axes | None = None) -> Axes:
    """Draws how long the whitened residuals of edges of one type are, against the chi distribution.

    If the weights say how large the noise is, the two agree; a histogram that is too wide says that sigmas
    are too small, a tail to the right that there are outliers. edges: all of the problem by default. dim:
    rows of a residual, needed for edges written in Python and marginal priors. More: residual_norms().
    """
    if not isinstance(problem, _core.Problem):
        raise ValueError(f"problem must be a glissade.Problem, not {type(problem).__name__}")
    chosen = problem.edges() if edges is None else edges
    if len(chosen) == 0:
        raise ValueError("edges is empty")
    if dim is None:
        dim = 2 if chosen.type.startswith("EdgeReprojection") else _ROWS.get(chosen.type)
        if dim is None:
            raise ValueError(f"dim must be given: edges are {chosen.type}, whose number of rows is not known here")
    return residual_norms(np.sqrt(problem.chi2(chosen)), dim, bins=bins, upper=upper, what=chosen.type, ax=ax)
