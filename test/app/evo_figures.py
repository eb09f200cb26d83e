# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What evo (pypi.org/project/evo, another program for the same purpose) makes of two TUM files with
the same stamps, as JSON on standard output. Run by a Python that has it: evo_figures.py EST REF LENGTH...
"""

import copy
import json
import sys

import numpy as np
from evo.core import metrics
from evo.core.trajectory import PoseTrajectory3D
from evo.core.units import Unit


def read(path):
    rows = np.loadtxt(path)
    return PoseTrajectory3D(positions_xyz=rows[:, 1:4], timestamps=rows[:, 0],
                            orientations_quat_wxyz=rows[:, [7, 4, 5, 6]])


def statistics(errors):
    errors = np.asarray(errors)
    return {"rmse": float(np.sqrt(np.mean(errors ** 2))), "mean": float(np.mean(errors)),
            "median": float(np.median(errors)), "max": float(np.max(errors)), "count": len(errors)}


def metric(kind, pair):
    kind.process_data(pair)
    given = kind.get_all_statistics()
    return {**{name: float(given[name]) for name in ("rmse", "mean", "median", "max")},
            "count": len(kind.error)}


def segments(reference, estimate, length):
    """Evo's error of the pairs that KITTI's benchmark takes, which evo itself does not."""
    steps = np.linalg.norm(np.diff(reference.positions_xyz, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    translations, rotations = [], []
    for i in range(len(way)):
        j = next((k for k in range(i + 1, len(way)) if way[k] - way[i] >= length), None)
        if j is None:
            break
        Q, P = reference.poses_se3, estimate.poses_se3
        E = metrics.RPE.rpe_base(Q[i], Q[j], P[i], P[j])
        translations.append(100 * np.linalg.norm(E[:3, 3]) / length)
        rotations.append(np.degrees(metrics.lie.so3_log_angle(E[:3, :3])) / length)
    return {"translation_percent": statistics(translations), "rotation_deg_per_m": statistics(rotations)}


def main():
    estimate, reference = read(sys.argv[1]), read(sys.argv[2])
    relation = metrics.PoseRelation
    figures = {}
    for align in ("none", "se3", "sim3"):
        moved = copy.deepcopy(estimate)
        if align != "none":
            moved.align(reference, correct_scale=align == "sim3")
        pair = (reference, moved)
        rpe = {"delta": 10, "delta_unit": Unit.frames, "all_pairs": True}
        figures[align] = {
            "ate": {"translation_m": metric(metrics.APE(relation.translation_part), pair),
                    "rotation_deg": metric(metrics.APE(relation.rotation_angle_deg), pair)},
            "rpe_time": {
                "translation_m": metric(metrics.RPE(relation.translation_part, **rpe), pair),
                "rotation_deg": metric(metrics.RPE(relation.rotation_angle_deg, **rpe), pair)},
            "by_length": [segments(*pair, float(length)) for length in sys.argv[3:]]}
    json.dump(figures, sys.stdout)


if __name__ == "__main__":
    main()
