#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what marginal_study found:

  marginalization_matrix.png      information matrix of a window: as it is, with what goes moved
                                  first, and what marginalization leaves
  marginalization_eigenvalues.png eigenvalues of these matrices, scaled to a unit diagonal
  marginalization_yaw.png         what a sliding window claims to know of its yaw, and how far it has
                                  turned from where it was linearized, keyframe by keyframe

    marginal_study --json study.json
    scripts/plot_marginalization.py study.json docs/images

Needs numpy and matplotlib (Debian, Ubuntu: python3-matplotlib).
"""

import argparse
import json
import pathlib
import sys

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c03028", "#2a8a4a", "#707070"
# Gauge, mode, label, color, line.
WALKS = (("free", "off", "kOff, free", RED, "-"),
         ("free", "prior_only", "kPriorOnly, free", "#d08020", "-"),
         ("fixed", "prior_only", "kPriorOnly, oldest keyframe held", "#d08020", "--"),
         ("free", "full", "kFull, free", BLUE, "-"))


def scaled(matrix, np):
    """Unit diagonal: rows and columns in units of their own information."""
    diagonal = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    return matrix / np.outer(diagonal, diagonal)


def label_axes(axis, groups):
    """Names of groups of variables at their rows and columns, and lines between them."""
    position, middles = 0, []
    for group in groups:
        middles.append(position + 0.5 * group["size"] - 0.5)
        if position > 0:
            for line in (axis.axhline, axis.axvline):
                line(position - 0.5, color=GREY, lw=0.5)
        position += group["size"]
    names = [group["name"] for group in groups]
    axis.set_yticks(middles, names)
    axis.set_xticks(middles, names, rotation=40, ha="right", rotation_mode="anchor")
    axis.tick_params(labelsize=8, length=2)


def merged(groups):
    """Poses next to each other as one group, speeds and biases next to each other as one."""
    result = []
    for group in groups:
        kind = group["name"].rsplit(" ", 1)[0] if group["name"] != "points" else "points"
        if result and result[-1]["kind"] == kind:
            result[-1]["size"] += group["size"]
            result[-1]["count"] += 1
        else:
            result.append({"kind": kind, "size": group["size"], "count": 1})
    words = {"pose": ("pose", "poses"), "speed, biases": ("speed, biases", "speeds, biases"),
             "points": ("points", "points")}
    return [{"name": words[g["kind"]][g["count"] > 1], "size": g["size"]} for g in result]


def draw_matrices(data, path, np, plt):
    matrices = {name: np.array(data["matrices"][name]) for name in ("before", "moved", "after")}
    going, groups = data["matrices"]["going"], data["matrices"]["groups"]
    points = sum(g["size"] for g in groups["going"] if g["name"] == "points")
    goes = [{"name": "oldest keyframe", "size": going - points},
            {"name": "its points", "size": points}]
    labels = {"before": merged(groups["before"]), "moved": goes + merged(groups["staying"]),
              "after": merged(groups["staying"])}
    figure, axes = plt.subplots(1, 3, figsize=(14.5, 5.2), layout="constrained")
    titles = {
        "before": "the window as it is",
        "moved": "what goes moved first",
        "after": "what stays, after the marginalization",
    }
    for axis, (name, matrix) in zip(axes, matrices.items()):
        magnitude = np.log10(np.maximum(np.abs(scaled(matrix, np)), 1e-6))
        magnitude[np.abs(matrix) == 0.0] = np.nan
        image = axis.imshow(magnitude, cmap="viridis", vmin=-6, vmax=0, interpolation="nearest")
        axis.set_title(f"{titles[name]}: {matrix.shape[0]} variables", fontsize=10)
        axis.set_facecolor("white")
        label_axes(axis, labels[name])
        if name == "moved":
            for line in (axis.axhline, axis.axvline):
                line(going - 0.5, color=RED, lw=1.2)
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
    figure, axes = plt.subplots(1, 2, figsize=(12.0, 4.4), layout="constrained")
    rounding = 1e-12  # H is known to rounding only: below this a value has no meaning but "none"
    for number, (gauge, mode, label, color, style) in enumerate(WALKS):
        rows = data["walk"][gauge][mode]
        frames = np.array([row["frame"] for row in rows])
        kappa = np.array([row["kappa_yaw"] for row in rows])
        seen = kappa > rounding
        if np.any(seen):
            axes[0].semilogy(frames, np.where(seen, kappa, np.nan), style, color=color,
                             label=label, lw=1.5)
        # No line through zeros: a mark for each, one row of marks a mode.
        height = rounding * 10 ** (-0.8 - 0.7 * number)
        axes[0].plot(frames[~seen], np.full(np.sum(~seen), height), ".", color=color, ms=4,
                     label=None if np.any(seen) else label)
        turned = np.array([row["yaw_since_linearized_deg"] for row in rows])
        axes[1].plot(frames, turned, style, color=color, label=label, lw=1.5)
    axes[0].axhspan(rounding * 1e-4, rounding, color="#e8f0e8", zorder=0)
    axes[0].text(0.02, 0.02, "rounding: no yaw is claimed", transform=axes[0].transAxes, fontsize=9,
                 color=GREEN)
    axes[0].set_ylim(rounding * 1e-4, 1e-1)
    axes[0].set_ylabel("kappa = u'Hu / sum of u_k'H_kk u_k")
    axes[0].set_title("information about yaw, after each marginalization", fontsize=10)
    axes[1].set_ylabel("degrees about the vertical")
    axes[1].set_title("turn of the oldest keyframe since its linearization", fontsize=10)
    for axis in axes:
        axis.set_xlabel("keyframe")
        axis.grid(True, which="major", lw=0.3)
    axes[0].legend(loc="upper right", fontsize=8, ncols=2)
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
