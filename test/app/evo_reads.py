# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What evo's own readers make of files, as JSON on standard output: evo_reads.py TUM EUROC KITTI. Run by a
Python that has evo; the ROS bags that its module of files reads as well are not asked for.
"""

import json
import sys
from unittest import mock

for name in ("", ".rosbag1", ".rosbag1.reader", ".rosbag2", ".rosbag2.reader", ".typesys"):
    sys.modules.setdefault("rosbags" + name, mock.MagicMock())

from evo.tools import file_interface  # noqa: E402, pylint: disable=wrong-import-position


def figures(trajectory):
    stamps = getattr(trajectory, "timestamps", None)
    valid, details = trajectory.check()
    return {"poses": [pose[:3].tolist() for pose in trajectory.poses_se3], "valid": bool(valid), "details": details,
            "stamps": None if stamps is None else stamps.tolist()}


def main():
    readers = {"tum": file_interface.read_tum_trajectory_file, "euroc": file_interface.read_euroc_csv_trajectory,
               "kitti": file_interface.read_kitti_poses_file}
    json.dump({name: figures(read(path)) for (name, read), path in zip(readers.items(), sys.argv[1:])}, sys.stdout)


if __name__ == "__main__":
    main()
