# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Arguments as arrays of the right shape, or a ValueError that names them."""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

Array: typing.TypeAlias = npt.NDArray[np.float64]


def array(name: str, value: npt.ArrayLike, *shapes: tuple[int | str, ...]) -> Array:
    """value as float64 of one of the shapes; a letter in them stands for any length."""
    try:
        result = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be an array of numbers: {error}") from None
    for shape in shapes:
        if result.ndim == len(shape) and all(
                isinstance(want, str) or want == have for want, have in zip(shape, result.shape)):
            return result
    wanted = " or ".join("(" + ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "") + ")"
                         for shape in shapes)
    raise ValueError(f"{name} must have the shape {wanted}, not {result.shape}")


def rows(name: str, value: Array, count: int) -> Array:
    """value, which must have that many rows."""
    if len(value) != count:
        raise ValueError(f"{name} has {len(value)} rows where {count} are needed")
    return value


def plane(value: str) -> tuple[int, int]:
    """The two coordinates of 'xy', 'xz', ..."""
    if not isinstance(value, str) or len(value) != 2 or value[0] == value[1] or not set(value) <= set("xyz"):
        raise ValueError(f"plane must be two of x, y and z, as 'xy', not {value!r}")
    return "xyz".index(value[0]), "xyz".index(value[1])


def positive(name: str, value: float) -> float:
    """value, which must be finite and greater than zero."""
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be a finite number above 0, not {value}")
    return float(value)
