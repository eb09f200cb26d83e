#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what prior_weight_sweep found, in the manner of Figs 4 to 6 of Zhang, Gallego, Scaramuzza,
"On the Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial State Estimation"
(RA-L 2018):

  prior_weight_accuracy.png     errors against the weight of the prior
  prior_weight_time.png         iterations and time against the weight
  prior_weight_path.png         prior error against reprojection error, iteration by iteration

    prior_weight_sweep --pose-noise 0.1 --trials 50 --json sweep.json
    scripts/plot_prior_weight.py sweep.json [more.json ...] docs/images

Further files are drawn into the first picture for comparison. From a .csv file only the first two
pictures can be made: it has no iterations. Needs the Python package with matplotlib (pip install ".[plot]").
"""

import argparse
import csv
import pathlib
import sys

from plot_util import fail, plot, read_json, save


def read_csv(path):
    """The rows of a CSV file in the shape of the JSON's, as far as it goes."""
    rows = {}
    with open(path, newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            fixed = line["weight"] == "fixed"
            weight = None if fixed else float(line["weight"])
            row = rows.setdefault(weight, {"fixed": fixed, "weight": weight, "trials": []})
            numbers = {key: float(line[key]) for key in ("pose_error_m", "point_error_per_m", "time_ms")}
            row["trials"].append({**numbers, "iterations": int(line["iterations"]), "steps": []})
    return {"rows": list(rows.values())}


def read(path):
    return read_csv(path) if path.suffix == ".csv" else read_json(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sweep", type=pathlib.Path, nargs="+", help=".json (or .csv) files of prior_weight_sweep")
    parser.add_argument("folder", type=pathlib.Path, help="where the pictures go")
    parser.add_argument("--path-weights", type=float, nargs="+", default=[], metavar="W",
                        help="weights in prior_weight_path.png (default: five of them, evenly)")
    args = parser.parse_args()
    try:
        sweeps = [read(path) for path in args.sweep]
        save(plot.prior_weights(*sweeps), args.folder / "prior_weight_accuracy.png")
        save(plot.prior_weight_time(sweeps[0]), args.folder / "prior_weight_time.png")
        if args.sweep[0].suffix == ".csv":
            print("plot_prior_weight.py: no iterations in a .csv: prior_weight_path.png is left out", file=sys.stderr)
        else:
            save(plot.prior_weight_path(sweeps[0], args.path_weights), args.folder / "prior_weight_path.png")
    except (OSError, ValueError, KeyError) as error:
        fail(f"{args.sweep[0]}: {error}")


if __name__ == "__main__":
    main()
