# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Matrices by the magnitude of their entries."""

from __future__ import annotations

import typing
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from . import _check, _figure, colors

if typing.TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

MAX_PIXELS = 1500


def _dark_is_large() -> Colormap:
    """viridis upside down, without its lightest tenth: no entry looks like the white of a zero."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["viridis"](np.linspace(0.9, 0.0, 256)))


def scaled_to_unit_diagonal(values: npt.ArrayLike) -> _check.Array:
    """H_ij / sqrt(H_ii H_jj): entries without units, between -1 and 1 where H has no negative eigenvalue.

    values: (n, n). Rows of a zero on the diagonal become zero.
    """
    H = _check.array("values", values, ("n", "n"))
    if H.shape[0] != H.shape[1]:
        raise ValueError(f"values must be square, not {H.shape}")
    diagonal = np.sqrt(np.maximum(np.diag(H), 0.0))
    inverse = np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=diagonal > 0)
    scaled: _check.Array = H * np.outer(inverse, inverse)
    return scaled


def fewer(values: _check.Array, most: int = MAX_PIXELS) -> _check.Array:
    """The largest of each k x k entries, k such that at most `most` rows and columns are left."""
    k = -(-max(values.shape) // most)
    if k <= 1:
        return values
    padded = np.full([-(-n // k) * k for n in values.shape], -np.inf)
    padded[:values.shape[0], :values.shape[1]] = np.where(np.isnan(values), -np.inf, values)
    blocks = padded.reshape(padded.shape[0] // k, k, padded.shape[1] // k, k).max(axis=(1, 3))
    return np.where(np.isinf(blocks), np.nan, blocks)


def label_groups(ax: Axes, groups: Sequence[tuple[str, int]], *, color: str = colors.GREY) -> None:
    """Names groups of rows and columns, first to last, with lines between them.

    groups: (name, number of rows) of each.
    """
    ends = np.cumsum([size for _, size in groups])
    middles = ends - 0.5 * np.array([size for _, size in groups]) - 0.5
    names = [name for name, _ in groups]
    for end in ends[:-1]:
        ax.axhline(end - 0.5, color=color, linewidth=0.6)
        ax.axvline(end - 0.5, color=color, linewidth=0.6)
    ax.set_xticks(middles, names, rotation=40, ha="right", rotation_mode="anchor")
    ax.set_yticks(middles, names)
    ax.tick_params(labelsize=8, length=2)


def matrix(values: npt.ArrayLike, groups: Sequence[tuple[str, int]] | None = None, *, decades: float = 6.0,
           top: float | None = None, label: str = "log$_{10}$ |entry|", title: str | None = None,
           colorbar: bool = True, ax: Axes | None = None) -> Axes:
    """Draws |values| on a logarithmic scale: dark is large, light is small, white is zero (or NaN).

    values: (n, m). groups: name and number of rows of each group of variables, for a square matrix: their
    sizes sum to n. decades: how far down from the largest magnitude (from 10^top, where top is given) the
    scale reaches; smaller ones that are not zero have its lightest colour. Of a matrix of more than 1500
    rows or columns each pixel is the largest entry that it stands for.
    """
    entries = np.abs(_check.array("values", values, ("n", "m")))
    n, m = entries.shape
    if n == 0 or m == 0:
        raise ValueError("values has no entries")
    _check.positive("decades", decades)
    if groups is not None and (n != m or sum(size for _, size in groups) != n):
        raise ValueError(f"groups has {sum(size for _, size in groups)} rows, values the shape ({n}, {m})")
    if groups is not None and any(size < 1 for _, size in groups):
        raise ValueError("groups must have a size of at least 1 each")
    with np.errstate(divide="ignore", invalid="ignore"):
        magnitude = np.where(entries > 0, np.log10(entries), np.nan)
    magnitude = np.where(np.isfinite(magnitude), magnitude, np.nan)
    if top is None:
        top = float(np.nanmax(magnitude)) if np.isfinite(magnitude).any() else 0.0
    ax = _figure.axes(ax, (6.2, 5.4))
    image = ax.imshow(np.ma.masked_invalid(fewer(magnitude)), cmap=_dark_is_large(), vmin=top - decades, vmax=top,
                      interpolation="nearest", extent=(-0.5, m - 0.5, n - 0.5, -0.5))
    ax.set_facecolor("white")
    if groups is not None:
        label_groups(ax, groups)
    if title is not None:
        ax.set_title(title, fontsize=10)
    if colorbar:
        ax.figure.colorbar(image, ax=ax, shrink=0.8, label=f"{label}; white: zero")
    return ax
