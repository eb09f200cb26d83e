# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours of all pictures.

Paul Tol's "high-contrast" scheme (Colour Schemes, SRON technical note, 2021): told apart by readers of
any colour vision, and in greyscale by lightness alone. The grey lies between red and yellow.
"""

from __future__ import annotations

import typing

BLACK = "#000000"
BLUE = "#004488"
RED = "#bb5566"
GREY = "#949494"
YELLOW = "#ddaa33"
GRID = "#dddddd"

AXES = (("x", RED), ("y", YELLOW), ("z", BLUE))
"""Names and colours of coordinates."""

_SERIES = ((BLUE, "-", "o"), (RED, "--", "s"), (YELLOW, "-", "^"), (BLACK, ":", "D"), (GREY, "-.", "v"))


class Look(typing.NamedTuple):
    """Colour, line and marker of one of several curves."""

    color: str
    line: str
    marker: str


def series(k: int) -> Look:
    """The look of curve k, k = 0, 1, ...; from the sixth on they come again."""
    return Look(*_SERIES[k % len(_SERIES)])


def sequence(n: int) -> list[tuple[float, float, float, float]]:
    """n colours for something ordered, from dark to light (viridis, without its light end)."""
    from matplotlib import colormaps

    viridis = colormaps["viridis"]
    return [viridis(0.9 * k / max(1, n - 1)) for k in range(n)]
