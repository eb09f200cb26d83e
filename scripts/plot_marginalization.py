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

Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import itertools
import pathlib

from plot_util import fail, np, plot, plt, read_json, save

C = plot.colors
# Gauge, mode, label, color, line.
WALKS = (("free", "off", "kOff, free", C.RED, "-"),
         ("free", "prior_only", "kPriorOnly, free", C.YELLOW, "-"),
         ("fixed", "prior_only", "kPriorOnly, oldest keyframe held", C.YELLOW, "--"),
         ("free", "full", "kFull, free", C.BLUE, "-"))
PLURALS = {"pose": "poses", "speed, biases": "speeds, biases"}
ROUNDING = 1e-12  # H is known to rounding only: below this a value has no meaning but "none"


def merged(groups):
    """Poses next to each other as one group, speeds and biases next to each other as one: names and sizes."""
    result = []
    for kind, run in itertools.groupby(groups, key=lambda group: group["name"].rstrip("0123456789 ")):
        members = list(run)
        name = PLURALS.get(kind, kind) if len(members) > 1 else kind
        result.append((name, sum(group["size"] for group in members)))
    return result


def draw_matrices(data):
    groups, going = data["groups"], data["going"]
    points = sum(g["size"] for g in groups["going"] if g["name"] == "points")
    panels = (("before", "the window as it is", merged(groups["before"])),
              ("moved", "what goes moved first",
               [("oldest keyframe", going - points), ("its points", points)] + merged(groups["staying"])),
              ("after", "what stays, after the marginalization", merged(groups["staying"])))
    figure, axes = plt.subplots(1, 3, figsize=(14.5, 5.2), layout="constrained")
    for ax, (name, title, labels) in zip(axes, panels):
        matrix = plot.scaled_to_unit_diagonal(data[name])
        plot.matrix(matrix, labels, top=0.0, title=f"{title}: {len(matrix)} variables", colorbar=False, ax=ax)
        if name == "moved":
            ax.axhline(going - 0.5, color=C.RED, lw=1.4)
            ax.axvline(going - 0.5, color=C.RED, lw=1.4)
    figure.colorbar(axes[0].images[0], ax=axes, fraction=0.018, pad=0.02,
                    label="log$_{10}$ |H$_{ij}$| / (H$_{ii}$ H$_{jj}$)$^{1/2}$; white: zero")
    return figure


def draw_eigenvalues(data):
    figure, ax = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    for name, color, marker in (("before", C.GREY, "o"), ("after", C.BLUE, "x")):
        values = np.abs(np.linalg.eigvalsh(plot.scaled_to_unit_diagonal(data[name])))
        ax.semilogy(np.arange(1, len(values) + 1), np.sort(np.maximum(values, 1e-20)), marker, ms=3, color=color,
                    label=f"{name}: {len(values)} variables")
    ax.axhspan(1e-20, 1e-13, color="#f0d8dc", zorder=0)
    ax.text(0.98, 0.04, "rounding: the four directions that nothing observes", transform=ax.transAxes, ha="right",
            fontsize=9, color=C.RED)
    ax.set_ylim(1e-19, 20)
    ax.legend(loc="center right", fontsize=9)
    plot.finish(ax, "eigenvalue number", "eigenvalue of H scaled to a unit diagonal")
    return figure


def draw_yaw(walk):
    figure, axes = plt.subplots(1, 2, figsize=(12.0, 4.4), layout="constrained")
    for number, (gauge, mode, label, color, line) in enumerate(WALKS):
        rows = walk[gauge][mode]
        frames = np.array([row["frame"] for row in rows])
        kappa = np.array([row["kappa_yaw"] for row in rows])
        seen = kappa > ROUNDING
        if np.any(seen):
            axes[0].semilogy(frames, np.where(seen, kappa, np.nan), line, color=color, label=label, lw=1.5)
        # No line through zeros: a mark for each, one row of marks a mode.
        height = ROUNDING * 10 ** (-0.8 - 0.7 * number)
        axes[0].plot(frames[~seen], np.full(np.sum(~seen), height), ".", color=color, ms=4,
                     label=None if np.any(seen) else label)
        axes[1].plot(frames, [row["yaw_since_linearized_deg"] for row in rows], line, color=color, label=label, lw=1.5)
    axes[0].axhspan(ROUNDING * 1e-4, ROUNDING, color="#eeeeee", zorder=0)
    axes[0].text(0.02, 0.02, "rounding: no yaw is claimed", transform=axes[0].transAxes, fontsize=9)
    axes[0].set_ylim(ROUNDING * 1e-4, 1e-1)
    axes[0].set_title("information about yaw, after each marginalization", fontsize=10)
    axes[1].set_title("turn of the oldest keyframe since its linearization", fontsize=10)
    plot.finish(axes[0], "keyframe", "kappa = u'Hu / sum of u_k'H_kk u_k")
    plot.finish(axes[1], "keyframe", "degrees about the vertical")
    axes[0].legend(loc="upper right", fontsize=8, ncols=2)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json", type=pathlib.Path, help="of marginal_study")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    args = parser.parse_args()
    data = read_json(args.json)
    try:
        pictures = {"matrix": draw_matrices(data["matrices"]), "eigenvalues": draw_eigenvalues(data["matrices"]),
                    "yaw": draw_yaw(data["walk"])}
    except (KeyError, TypeError, ValueError) as error:
        fail(f"{args.json} is no result of marginal_study: {error!r}")
    for name, figure in pictures.items():
        save(figure, args.folder / f"marginalization_{name}.png", dpi=130)


if __name__ == "__main__":
    main()
