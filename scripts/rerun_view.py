#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows a run while it goes on, or records it, with the viewer of rerun (rerun.io).

    vio_run data --rerun - | scripts/rerun_view.py                    live, in a viewer that it opens
    vio_run data --rerun - | scripts/rerun_view.py --save run.rrd     recorded: `rerun run.rrd` opens it

Reads a line of JSON for each frame from standard input (what may be null may also be left out):

    {"t": 12.05,                      time, s, increasing (required)
     "p": [x, y, z],                  position of the body in the world, m; null before it is known
     "q": [x, y, z, w],               its attitude (body to world)
     "landmarks": [[x, y, z], ...],   those of the window, m; on the lines that have them
     "features": [[u, v, age], ...],  in the image, pixels; age in frames
     "image": "cam0/0012.png",        file of the image, or null
     "truth": [x, y, z]}              true position, aligned

A line that cannot be understood is told on standard error and left out.
Exit code: 0; 1 if lines were left out; 2 if the SDK (pip install rerun-sdk) or the file cannot be had.
"""

import argparse
import json
import math
import pathlib
import sys

# Okabe and Ito's, told apart by colour-blind eyes, too.
ESTIMATE, TRUTH, LANDMARK = (213, 94, 0), (40, 44, 52), (0, 114, 178)
# Young to old features: yellow to violet, seen on grey images.
AGES = ((255, 227, 77), (255, 171, 61), (242, 102, 94), (209, 79, 176), (160, 108, 245))
OLD = 30  # frames, from which on a feature is drawn in the last colour


def numbers(value, count, name):
    """`count` finite numbers, None where there are none."""
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != count or \
       not all(isinstance(x, (int, float)) and not isinstance(x, bool) and math.isfinite(x) for x in value):
        raise ValueError(f"'{name}' is not " + ("a number" if count == 1 else f"{count} numbers"))
    return value


def rows(value, count, name):
    if value is None:
        return None
    if not isinstance(value, list):
        raise ValueError(f"'{name}' is no list")
    return [numbers(row, count, name) for row in value]


def read_frame(line):
    """What the line (bytes) says, checked; ValueError if it makes no sense."""
    frame = json.loads(line)
    if not isinstance(frame, dict):
        raise ValueError("no object")
    if "t" not in frame:
        raise ValueError("'t' is missing")
    image = frame.get("image")
    if image is not None and not isinstance(image, str):
        raise ValueError("'image' is no file name")
    return {"t": numbers([frame["t"]], 1, "t")[0], "p": numbers(frame.get("p"), 3, "p"), "q": numbers(frame.get("q"), 4, "q"),
            "landmarks": rows(frame.get("landmarks"), 3, "landmarks"), "features": rows(frame.get("features"), 3, "features"),
            "image": image, "truth": numbers(frame.get("truth"), 3, "truth")}


def age_colour(age):
    return AGES[min(len(AGES) - 1, max(0, int(age * len(AGES) / OLD)))]


class View:
    """Logs frames. Entities: world/{body,estimate,truth,landmarks}, camera/{image,features}, features/number."""

    def __init__(self, rr):
        self.rr = rr
        self.ways = {"estimate": [], "truth": []}
        rr.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        rr.log("world/body/axes", rr.Arrows3D(origins=[[0, 0, 0]] * 3, vectors=[[0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]],
                                              colors=[[213, 94, 0], [0, 158, 115], [0, 114, 178]]), static=True)

    def extend(self, name, place, colour):
        """The way so far, in pieces of 500 steps: of a long one only the last is logged anew."""
        way = self.ways[name]
        way.append(place)
        if len(way) > 1:
            piece = (len(way) - 2) // 500
            self.rr.log(f"world/{name}/{piece}", self.rr.LineStrips3D([way[500 * piece:]], colors=[colour]))

    def show(self, frame):
        rr = self.rr
        if hasattr(rr, "set_time"):
            rr.set_time("time", duration=frame["t"])
        else:  # before 0.23
            rr.set_time_seconds("time", frame["t"])
        if frame["p"]:
            if frame["q"]:
                rr.log("world/body", rr.Transform3D(translation=frame["p"], rotation=rr.Quaternion(xyzw=frame["q"])))
            self.extend("estimate", frame["p"], ESTIMATE)
        if frame["truth"]:
            self.extend("truth", frame["truth"], TRUTH)
        if frame["landmarks"] is not None:
            rr.log("world/landmarks", rr.Points3D(frame["landmarks"], colors=[LANDMARK], radii=[0.02]))
        if frame["image"]:
            if not pathlib.Path(frame["image"]).is_file():
                raise ValueError(f"{frame['image']}: no such image")
            rr.log("camera/image", rr.EncodedImage(path=frame["image"]))
        features = frame["features"]
        if features is not None:
            rr.log("camera/features", rr.Points2D([row[:2] for row in features], colors=[age_colour(row[2]) for row in features],
                                                  radii=[2.0]))
            scalar = rr.Scalars if hasattr(rr, "Scalars") else rr.Scalar  # before 0.23
            rr.log("features/number", scalar(len(features)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--save", metavar="FILE.rrd", help="record into this file; no viewer is opened")
    parser.add_argument("--name", default="glissade", help="what the viewer calls the run (default: glissade)")
    options = parser.parse_args()
    try:
        import rerun as rr
    except ImportError:
        print("rerun_view.py: the rerun SDK is not installed: pip install rerun-sdk", file=sys.stderr)
        return 2
    try:
        rr.init(options.name)
        if options.save:
            pathlib.Path(options.save).open("ab").close()  # its place can be written
            rr.save(options.save)
        else:
            rr.spawn()
    except Exception as error:  # whatever the SDK throws: no viewer, no rights, no display
        print(f"rerun_view.py: {options.save or 'the viewer'}: {str(error).splitlines()[0]}", file=sys.stderr)
        return 2

    view, shown, left_out = View(rr), 0, 0
    try:
        for number, line in enumerate(sys.stdin.buffer, 1):
            if not line.strip():
                continue
            try:
                view.show(read_frame(line))
                shown += 1
            except ValueError as error:
                left_out += 1
                if left_out <= 5:
                    print(f"rerun_view.py: line {number}: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        pass  # what there is until then is kept
    rr.disconnect()
    print(f"rerun_view.py: {shown} frames shown" + (f", {left_out} lines left out" if left_out else ""), file=sys.stderr)
    return 1 if left_out else 0


if __name__ == "__main__":
    sys.exit(main())
