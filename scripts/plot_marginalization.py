#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what marginal_study found:

  marginalization_matrix.png      information matrix of a window: as it is, with what goes moved
                                  first, and what marginalization leaves
  marginalization_eigenvalues.png eigenvalues of these matrices, scaled to a unit diagonal
  marginalization_yaw.png         what a sliding window claims to know of yaw and position, frame by
                                  frame, with and without first estimates

    marginal_study --json study.json
    scripts/plot_marginalization.py study.json docs/images

Needs numpy and matplotlib (Debian, Ubuntu: python3-matplotlib).
"""

import argparse
import json
import pathlib
import sys

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c03028", "#2a8a4a", "#707070"
MODES = (("off", "kOff: everything at the present values", RED),
         ("prior_only", "kPriorOnly: the prior keeps its point", "#d08020"),
         ("full", "kFull: all that the prior touches keeps it", BLUE))


def scaled(matrix, np):
    """Unit diagonal: rows and columns in units of their own information."""
    diagonal = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    return matrix / np.outer(diagonal, diagonal)


def draw_matrices(data, path, np, plt):
    matrices = {name: np.array(data["matrices"][name]) for name in ("before", "moved", "after")}
    going, states = data["matrices"]["going"], data["matrices"]["states"]
    figure, axes = plt.subplots(1, 3, figsize=(12.5, 4.6))
    titles = {
        "before": "before: states, then points",
        "moved": "what goes moved first",
        "after": "after: what stays",
    }
    for axis, (name, matrix) in zip(axes, matrices.items()):
        magnitude = np.log10(np.maximum(np.abs(scaled(matrix, np)), 1e-6))
        magnitude[np.abs(matrix) == 0.0] = np.nan
        image = axis.imshow(magnitude, cmap="viridis", vmin=-6, vmax=0, interpolation="nearest")
        axis.set_title(f"{titles[name]} ({matrix.shape[0]})", fontsize=10)
        axis.set_facecolor("white")
        if name == "before":
            for edge in ("axhline", "axvline"):
                getattr(axis, edge)(states - 0.5, color=GREY, lw=0.7)
        if name == "moved":
            for edge in ("axhline", "axvline"):
                getattr(axis, edge)(going - 0.5, color=RED, lw=1.0)
        axis.tick_params(labelsize=8)
    bar = figure.colorbar(image, ax=axes, fraction=0.018, pad=0.02)
    bar.set_label("log10 of |H_ij| / sqrt(H_ii H_jj); white: zero", fontsize=9)
    figure.savefig(path, dpi=130, bbox_inches="tight")
    plt.close(figure)


def draw_eigenvalues(data, path, np, plt):
    figure, axis = plt.subplots(figsize=(7.0, 4.2))
    for name, label, color, marker in (("before", "before", GREY, "o"),
                                       ("after", "after", BLUE, "x")):
        values = np.linalg.eigvalsh(scaled(np.array(data["matrices"][name]), np))
        values = np.maximum(np.abs(values), 1e-20)
        axis.semilogy(np.arange(1, len(values) + 1), np.sort(values), marker, ms=3, color=color,
                      label=f"{label}: {len(values)} variables")
    axis.axhspan(1e-20, 1e-13, color="#f0d0d0", zorder=0)
    axis.text(0.98, 0.04, "rounding: the four directions that nothing observes",
              transform=axis.transAxes, ha="right", fontsize=9, color=RED)
    axis.set_xlabel("eigenvalue number")
    axis.set_ylabel("eigenvalue of H scaled to a unit diagonal")
    axis.set_ylim(1e-19, 20)
    axis.grid(True, which="major", lw=0.3)
    axis.legend(loc="center right", fontsize=9)
    figure.savefig(path, dpi=130, bbox_inches="tight")
    plt.close(figure)


def draw_yaw(data, path, np, plt):
    names = [key for key in data["walk"]["full"][0] if key not in ("frame", "cost")]
    yaw = next(name for name in names if "yaw" in name)
    positions = [name for name in names if name != yaw]
    figure, axes = plt.subplots(1, 2, figsize=(11.5, 4.2), sharey=True)
    floor = 1e-18  # H is known to rounding only: what comes out below or negative is drawn here
    for mode, label, color in MODES:
        rows = data["walk"][mode]
        frames = [row["frame"] for row in rows]
        axes[0].semilogy(frames, [max(row[yaw]["kappa"], floor) for row in rows], color=color,
                         label=label, lw=1.4)
        axes[1].semilogy(frames, [max(max(row[name]["kappa"] for name in positions), floor)
                                  for row in rows], color=color, label=label, lw=1.4)
        last = max(rows[-1][yaw]["information"], 0.0)
        if mode != "full" and last > 0.0:
            degrees = 180 / np.pi / np.sqrt(last)
            axes[0].annotate(f"claims {degrees:.2g} deg", (frames[-1], rows[-1][yaw]["kappa"]),
                             xytext=(-4, 14), textcoords="offset points", ha="right", fontsize=8,
                             color=color)
    for axis, what in zip(axes, ("yaw", "position, the worst axis")):
        axis.axhspan(floor / 3, 1e-12, color="#e8f0e8", zorder=0)
        axis.text(0.98, 0.32, "rounding", transform=axis.transAxes, ha="right", fontsize=9,
                  color=GREEN)
        axis.set_title(what, fontsize=10)
        axis.set_xlabel("keyframe")
        axis.grid(True, which="major", lw=0.3)
        axis.set_ylim(floor / 3, 1e-2)
    axes[0].set_ylabel("information, kappa = u'Hu / sum of u_k'H_kk u_k")
    axes[1].legend(loc="upper right", fontsize=8)
    figure.savefig(path, dpi=130, bbox_inches="tight")
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("json", type=pathlib.Path, help="of marginal_study")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    arguments = parser.parse_args()
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        import numpy as np
    except ImportError as error:
        print(f"plot_marginalization.py: {error} (Debian, Ubuntu: python3-matplotlib)",
              file=sys.stderr)
        return 2
    try:
        data = json.loads(arguments.json.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        print(f"plot_marginalization.py: {arguments.json}: {error}", file=sys.stderr)
        return 2
    arguments.folder.mkdir(parents=True, exist_ok=True)
    draw_matrices(data, arguments.folder / "marginalization_matrix.png", np, plt)
    draw_eigenvalues(data, arguments.folder / "marginalization_eigenvalues.png", np, plt)
    draw_yaw(data, arguments.folder / "marginalization_yaw.png", np, plt)
    return 0


if __name__ == "__main__":
    sys.exit(main())
