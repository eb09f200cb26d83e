# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Unit quaternions x y z w (Hamilton), as in poses: many at once, in numpy.

An array of them is (n, 4), vectors are (n, 3), angles radians. For edges and pictures of your own.
"""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

Array: typing.TypeAlias = npt.NDArray[np.float64]


def inverse(q: npt.ArrayLike) -> Array:
    """The rotations back, (n, 4)."""
    back: Array = np.asarray(q, dtype=np.float64) * np.array([-1.0, -1.0, -1.0, 1.0])
    return back


def multiply(a: npt.ArrayLike, b: npt.ArrayLike) -> Array:
    """R(a) R(b) of each row, (n, 4)."""
    p, q = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    u, v, s, t = p[..., :3], q[..., :3], p[..., 3:], q[..., 3:]
    vector = s * v + t * u + np.cross(u, v)
    return np.concatenate([vector, s * t - np.sum(u * v, axis=-1, keepdims=True)], axis=-1)


def rotate(q: npt.ArrayLike, v: npt.ArrayLike) -> Array:
    """R(q) v of each row, (n, 3)."""
    p, x = np.asarray(q, dtype=np.float64), np.asarray(v, dtype=np.float64)
    t = 2.0 * np.cross(p[..., :3], x)
    return x + p[..., 3:] * t + np.cross(p[..., :3], t)


def exp(rotation_vectors: npt.ArrayLike) -> Array:
    """Rotations by |w| about w, (n, 3) [rad] -> (n, 4)."""
    w = np.asarray(rotation_vectors, dtype=np.float64)
    half = 0.5 * np.linalg.norm(w, axis=-1, keepdims=True)
    return np.concatenate([0.5 * np.sinc(half / np.pi) * w, np.cos(half)], axis=-1)


def log(q: npt.ArrayLike) -> Array:
    """Rotation vectors, at most pi long: (n, 4) -> (n, 3) [rad]."""
    p = np.asarray(q, dtype=np.float64)
    p = np.where(p[..., 3:] < 0, -p, p)
    length = np.linalg.norm(p[..., :3], axis=-1, keepdims=True)
    tiny = length < 1e-9
    scale = np.where(tiny, 2.0, 2.0 * np.arctan2(length, p[..., 3:]) / np.where(tiny, 1.0, length))
    return scale * p[..., :3]


def yaw(q: npt.ArrayLike) -> Array:
    """The rotation about z that each makes (its twist), (n, 4) -> (n,) [rad], from -pi to pi."""
    p = np.asarray(q, dtype=np.float64)
    p = np.where(p[..., 3:] < 0, -p, p)
    angle: Array = 2.0 * np.arctan2(p[..., 2], p[..., 3])
    return angle


def interpolate(t: npt.ArrayLike, times: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Rotations at times t, (n,), of q, (m, 4), at increasing times, (m,): along the chord between neighbours,
    normalized; beyond the ends the first and the last."""
    at, known, p = np.asarray(t), np.asarray(times), np.asarray(q, dtype=np.float64)
    k = np.clip(np.searchsorted(known, at, side="right"), 1, len(known) - 1)
    share = np.clip((at - known[k - 1]) / (known[k] - known[k - 1]), 0.0, 1.0)[:, None]
    a, b = p[k - 1], p[k]
    b = np.where(np.sum(a * b, axis=1, keepdims=True) < 0, -b, b)
    mixed = (1.0 - share) * a + share * b
    unit: Array = mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
    return unit
