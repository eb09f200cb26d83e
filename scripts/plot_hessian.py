#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Puts axes around the picture of H that examples/mono_ba_steps writes.

    mono_ba_steps hessian.pgm
    scripts/plot_hessian.py hessian.pgm docs/images/mono_ba_hessian.png

Needs matplotlib (Debian, Ubuntu: python3-matplotlib).
"""

import pathlib
import sys

SCALE = 6  # pixels an entry
POSES, DEPTHS = 3, 20


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        import numpy as np
    except ImportError as error:
        print(f"plot_hessian.py: {error} (Debian, Ubuntu: python3-matplotlib)", file=sys.stderr)
        return 2
    data = pathlib.Path(sys.argv[1]).read_bytes()
    magic, size, _, pixels = data.split(b"\n", 3)
    width, height = map(int, size.split())
    if magic != b"P5" or len(pixels) != width * height:
        print(f"plot_hessian.py: {sys.argv[1]} is no picture of mono_ba_steps", file=sys.stderr)
        return 2
    entries = np.frombuffer(pixels, np.uint8).reshape(height, width)[::SCALE, ::SCALE]
    ticks = [6 * k + 2.5 for k in range(POSES)] + [6 * POSES + DEPTHS / 2 - 0.5]
    names = [f"pose {k}" for k in range(POSES)] + ["20 inverse depths"]
    figure, axis = plt.subplots(figsize=(5.6, 5.4), layout="constrained")
    axis.imshow(entries, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    axis.set_xticks(ticks, names, fontsize=9)
    axis.set_yticks(ticks, names, fontsize=9, rotation=90, va="center")
    for edge in [6 * k - 0.5 for k in range(1, POSES + 1)]:
        axis.axhline(edge, color="#1f5fa8", lw=0.8)
        axis.axvline(edge, color="#1f5fa8", lw=0.8)
    axis.set_title("|H|, five decades from black to grey; white is zero", fontsize=10)
    figure.savefig(sys.argv[2], dpi=100)
    return 0


if __name__ == "__main__":
    sys.exit(main())
