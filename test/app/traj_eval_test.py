#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""traj_eval: known errors, what it refuses, and the same figures as evo's."""

import gzip
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import unittest

import app_test_util
import browser_util
from app_test_util import ROOT, AppTest, data_folder, main, strict_json

FLIGHT = ROOT / "data" / "flight"


def product(a, b):
    """Of quaternions x y z w."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def rotation(v):
    angle = math.hypot(*v)
    s = math.sin(angle / 2) / angle if angle > 0 else 0.5
    return (s * v[0], s * v[1], s * v[2], math.cos(angle / 2))


def rotated(q, v):
    conjugate = (-q[0], -q[1], -q[2], q[3])
    return product(product(q, (*v, 0.0)), conjugate)[:3]


def read_truth(path):
    """(ns, position, quaternion x y z w) of a groundtruth.csv.gz."""
    poses = []
    with gzip.open(path, "rt", encoding="utf-8") as file:
        for line in file:
            if line.startswith("#") or not line.strip():
                continue
            fields = line.split(",")
            px, py, pz, qw, qx, qy, qz = map(float, fields[1:8])
            norm = math.sqrt(qw * qw + qx * qx + qy * qy + qz * qz)
            poses.append((int(fields[0]), (px, py, pz), (qx / norm, qy / norm, qz / norm, qw / norm)))
    return poses


def noisy(poses, seed, sigma_p, sigma_q, turn, shift, scale):
    """Moved to another world, with noise pose by pose."""
    draw = random.Random(seed)
    g = rotation(turn)
    result = []
    for stamp, p, q in poses:
        p = rotated(g, [scale * x + draw.gauss(0, sigma_p) for x in p])
        q = product(product(g, q), rotation([draw.gauss(0, sigma_q) for _ in range(3)]))
        result.append((stamp, tuple(x + s for x, s in zip(p, shift)), q))
    return result


def tum(poses):
    return "".join(f"{t // 10**9}.{t % 10**9:09d} " + " ".join(map(repr, (*p, *q))) + "\n"
                   for t, p, q in poses)


def python_with_evo():
    """A Python that has evo (scripts/test.sh makes one in build/), None where there is none."""
    for candidate in (os.environ.get("GLISSADE_EVO_PYTHON"), ROOT / "build/evo-venv/bin/python", sys.executable):
        if candidate and pathlib.Path(candidate).exists():
            done = subprocess.run([candidate, "-c", "import evo.core.metrics"], capture_output=True, check=False)
            if done.returncode == 0:
                return candidate
    return None


class TrajEvalTest(AppTest):
    app = "traj_eval"
    numeric_options = {"--vertical": ("1,2", "0,0,0", "1,,2"), "--max-difference": ("-1",), "--max-gap": ("-1",),
                       "--time-offset": (), "--interval": ("0", "-1"), "--lengths": ("0", "5,5", "5,4", "5,"),
                       "--every": ("0", "1.5"), "--rate": ("0", "-10")}

    def test_help_and_version(self):
        text = self.run_ok("--help")
        for word in ("Examples:", "Exit code:", "yaw", "se3", "sim3", "none", "--json", "TUM", "EuRoC", "KITTI", "VIOTRACKS"):
            self.assertIn(word, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 100, line)
        self.check_version()

    def test_the_truth_has_no_error(self):
        for align in ("yaw", "se3", "sim3", "none"):
            r = self.run_json(FLIGHT / "groundtruth.csv.gz", FLIGHT, "--align", align)
            self.assertEqual(r["poses_judged"], r["poses"])
            self.assertLess(r["ate"]["translation_m"]["max"], 1e-12)
            self.assertLess(r["ate"]["rotation_deg"]["max"], 1e-5)
            self.assertLess(r["rpe_time"]["translation_m"]["max"], 1e-12)
            self.assertLess(r["rpe_distance"]["translation_percent"]["max"], 1e-10)
            self.assertAlmostEqual(r["aligned_by"]["scale"], 1, delta=1e-12)

    def test_a_known_motion_is_taken_away_by_the_alignment_that_allows_it(self):
        truth = read_truth(FLIGHT / "groundtruth.csv.gz")
        reference = self.write("ref.txt", tum(truth))
        cases = {"yaw": ((0, 0, 1.1), (3, -4, 5), 1.0), "se3": ((0.3, -0.2, 1.1), (3, -4, 5), 1.0),
                 "sim3": ((0.3, -0.2, 1.1), (3, -4, 5), 0.4)}
        rank = {"none": 0, "yaw": 1, "se3": 2, "sim3": 3}
        for kind, (turn, shift, scale) in cases.items():
            estimate = self.write("est.txt", tum(noisy(truth, 1, 0, 0, turn, shift, scale)))
            for align in rank:
                r = self.run_json(estimate, reference, "--align", align, "--lengths", "3")
                if rank[align] < rank[kind]:
                    self.assertGreater(r["ate"]["translation_m"]["rmse"], 0.05, (kind, align))
                else:
                    self.assertLess(r["ate"]["translation_m"]["max"], 1e-10, (kind, align))
                    self.assertLess(r["ate"]["rotation_deg"]["max"], 1e-5)
                    self.assertAlmostEqual(r["aligned_by"]["scale"] * scale, 1, delta=1e-10)
        # About another vertical.
        estimate = self.write("est.txt", tum(noisy(truth, 1, 0, 0, (0, -1.1, 0), (3, -4, 5), 1)))
        r = self.run_json(estimate, reference, "--vertical", "0,-1,0")
        self.assertLess(r["ate"]["translation_m"]["max"], 1e-10)

    def test_tables_matching_and_files(self):
        truth = read_truth(FLIGHT / "groundtruth.csv.gz")
        late = [(t + 30_000_000, p, q) for t, p, q in noisy(truth, 2, 0.01, 0.01, (0, 0, 1), (1, 2, 3), 1)]
        estimate = self.write("est.txt", tum(late))
        text = self.run_ok(estimate, FLIGHT, "--time-offset", "-0.03", "--aligned", "moved.txt")
        for word in ("matched", "position [m]", "yaw [deg]", "over 1 s", "over 5 m", "all lengths"):
            self.assertIn(word, text)
        again = self.run_json("moved.txt", FLIGHT, "--align", "none", "--time-offset", "-0.03")
        self.assertAlmostEqual(again["ate"]["translation_m"]["rmse"], 0.01 * math.sqrt(3), delta=0.002)
        # The last pose is after the truth's last: it is not extrapolated to.
        r = self.run_json(estimate, FLIGHT)
        self.assertEqual(r["poses_judged"], r["poses"] - 1)
        self.check_refused(estimate, FLIGHT, "--match", "nearest", says="no pose of the estimate")
        r = self.run_json(estimate, FLIGHT, "--match", "nearest", "--max-difference", "0.031")
        self.assertEqual(r["poses_judged"], r["poses"])
        r = self.run_json(estimate, FLIGHT, "--lengths", "1000", "--interval", "1000")
        self.assertIsNone(r["rpe_time"])
        self.assertIsNone(r["rpe_distance"])
        self.check_json_on_stdout(estimate, FLIGHT)

    def test_formats(self):
        """The truth in each format is the truth, however it was converted."""
        truth = FLIGHT / "groundtruth.csv.gz"
        self.run_ok(truth, "--output", "a.tum")
        self.run_ok("a.tum", "--output", "b.csv.gz")
        out = self.run_ok("b.csv.gz", "--output", "c.kitti", "--output-times", "times.txt")
        poses = len(read_truth(truth))
        self.assertEqual(out, f"c.kitti: {poses} poses\n")
        self.run_ok("c.kitti", "--times", "times.txt", "--output", "d.txt", "--format", "euroc")
        for args in (("a.tum",), ("b.csv.gz",), ("c.kitti", "--times", "times.txt"), ("d.txt",)):
            r = self.run_json(args[0], truth, "--align", "none", *args[1:])
            self.assertEqual(r["poses"], poses)
            self.assertLess(r["ate"]["translation_m"]["max"], 1e-12, args)
            self.assertLess(r["ate"]["rotation_deg"]["max"], 1e-5, args)
        kitti = (self.folder / "c.kitti").read_text(encoding="utf-8").splitlines()
        self.assertEqual({len(line.split()) for line in kitti}, {12})
        # By a rate: the same poses, at other times.
        self.run_ok("c.kitti", "--rate", "10", "--output", "e.tum")
        lines = [line.split() for line in (self.folder / "e.tum").read_text(encoding="utf-8").splitlines()
                 if not line.startswith("#")]
        self.assertEqual([lines[k][0] for k in (0, 1, 15)], ["0.000000000", "0.100000000", "1.500000000"])
        # Beside being judged.
        self.run_ok("c.kitti", truth, "--times", "times.txt", "--output", "f.tum", "--aligned", "g.tum")
        self.assertEqual(len((self.folder / "f.tum").read_text(encoding="utf-8").splitlines()), poses + 1)

    def test_evo_reads_what_is_written(self):
        python = python_with_evo()
        if python is None:
            self.skipTest("no Python with evo here (scripts/test.sh installs one in build/evo-venv)")
        truth = FLIGHT / "groundtruth.csv.gz"
        names = ("a.tum", "a.csv", "a.kitti")
        for name in names:
            self.run_ok(truth, "--output", name)
        done = subprocess.run([python, pathlib.Path(__file__).parent / "evo_reads.py", *names], cwd=self.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        known = read_truth(truth)
        found = json.loads(done.stdout)
        self.assertEqual(set(found), {"tum", "euroc", "kitti"})
        for name, trajectory in found.items():
            self.assertTrue(trajectory["valid"], (name, trajectory["details"]))
            self.assertEqual(len(trajectory["poses"]), len(known))
            for T, (_, p, q) in zip(trajectory["poses"], known):
                columns = [rotated(q, axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))] + [p]
                worst = max(abs(T[r][c] - columns[c][r]) for r in range(3) for c in range(4))
                self.assertLess(worst, 1e-12, name)
            if name != "kitti":
                worst = max(abs(t - ns * 1e-9) for t, (ns, _, _) in zip(trajectory["stamps"], known))
                self.assertLess(worst, 1e-6, name)

    def test_refuses_formats(self):
        truth = FLIGHT / "groundtruth.csv.gz"
        self.run_ok(truth, "--output", "a.kitti", "--output-times", "times.txt")
        self.write("short.txt", "0\n1\n")
        for args, says in ((("a.kitti", truth), "a.kitti: poses of KITTI (12 numbers a line) have no stamps"),
                           (("a.kitti", truth, "--times", "short.txt"), "a.kitti:3: more poses than times"),
                           (("a.kitti", truth, "--times", "absent"), "absent"),
                           (("a.kitti", truth, "--times", "times.txt", "--rate", "1"), "--rate"),
                           ((truth, FLIGHT, "--times", "times.txt"), "--times"),
                           ((truth, "--rate", "10", "--output", "b.tum"), "--rate"),
                           ((truth, "--json", "a.json", "--output", "b.tum"), "--json: needs REFERENCE"),
                           ((truth, "--aligned", "a.tum", "--output", "b.tum"), "--aligned: needs REFERENCE"),
                           ((truth, "--format", "tum"), "--format"),
                           ((truth, "--output", "b.tum", "--output-times", "c"), "--output-times"),
                           ((truth, "--output", "b", "--format", "ply"), "--format")):
            with self.subTest(args=args):
                before = self.files()
                result = self.run_app(*args)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(says, result.stderr)
                self.assertEqual(self.files(), before)
    def test_page(self):
        if not (self.folder_of_executables / "../share/glissade/plotly.min.js").is_file():
            self.skipTest("no plotly.js where this was configured (scripts/test.sh fetches one)")
        truth = read_truth(FLIGHT / "groundtruth.csv.gz")[::40]  # further apart than the page looks around
        estimate = self.write("est.txt", tum(noisy(truth, 2, 0.01, 0.01, (0, 0, 1), (1, 2, 3), 1)))
        r = self.run_json(estimate, FLIGHT, "--report", "page.html", "--max-gap", "10")
        page = (self.folder / "page.html").read_text(encoding="utf-8")
        data = re.search(r'(?s)<script[^>]*type="application/json"[^>]*>(.*?)</script>', page)
        data = strict_json(data[1])
        self.assertEqual(data["title"], "est.txt against flight")
        self.assertAlmostEqual(data["figures"]["ate_m"], r["ate"]["translation_m"]["rmse"], delta=1e-6)
        self.assertEqual(data["figures"]["frames"], r["poses_judged"])
        states, true = data["states"], data["truth"]
        self.assertEqual(len(states["t"]), r["poses_judged"])
        self.assertEqual(states["t"], true["t"])
        squares = 0
        for p, q, error in zip(states["p"], true["p"], states["error_p"]):
            for a, b, e in zip(p, q, error):
                self.assertAlmostEqual(a - b, e, delta=1e-5)
            squares += sum(e * e for e in error)
        self.assertAlmostEqual(math.sqrt(squares / len(states["t"])), r["ate"]["translation_m"]["rmse"], delta=1e-5)
        self.check_in_browser(self.folder / "page.html", r)
        result = subprocess.run([self.folder_of_executables / "traj_eval", estimate, FLIGHT, "--report", "other.html"],
                                env={**os.environ, "GLISSADE_PLOTLY_JS": "none.js"}, capture_output=True, text=True,
                                cwd=self.folder, check=False)
        self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
        self.assertFalse((self.folder / "other.html").exists())

    def check_in_browser(self, path, r):
        """Drawn without an error, with errors along three axes and the figure at the top."""
        if browser_util.CHROMIUM is None:
            return
        browser = browser_util.Browser(1200, 900)
        try:
            browser.open(path, "document.documentElement?.dataset.state === 'done'")
            self.assertEqual(browser.evaluate("document.documentElement.dataset.errors"), "0")
            self.assertEqual(browser.complaints(), [])
            text = browser.evaluate("document.body.innerText")
        finally:
            browser.close()
        self.assertIn("est.txt against flight", text)
        self.assertIn("Error of the position", text)
        self.assertNotIn("unknown", text)
        self.assertNotIn("bias", text)
        self.assertIn(f"{r['ate']['translation_m']['rmse']:.3g}", text)

    def test_refusals(self):
        truth = FLIGHT / "groundtruth.csv.gz"
        self.check_refused(truth, says="REFERENCE")
        self.check_refused("absent.txt", FLIGHT, says="absent.txt")
        self.check_refused(truth, "absent", says="absent")
        self.check_refused(truth, self.write("bad.txt", "1 0 0 0 0 0 0 1\n2 0 0 x 0 0 0 1\n"), says="bad.txt:2")
        self.check_refused(truth, self.write("empty.txt", ""), says="has no pose")
        self.check_refused(truth, FLIGHT, "--align", "sim4", says="--align")
        line = "".join(f"{k} {k} 0 0 0 0 0 1\n" for k in range(9))
        path = self.write("line.txt", line)
        self.check_refused(path, path, "--align", "se3", says="one line")
        self.run_ok(path, path, "--align", "yaw")
        self.check_refused(path, path, "--vertical", "1,0,0", says="one vertical")

    def test_numeric_options(self):
        # "1,5" is two lengths.
        all_values = app_test_util.NO_NUMBERS
        app_test_util.NO_NUMBERS = tuple(v for v in all_values if v != "1,5")
        self.addCleanup(setattr, app_test_util, "NO_NUMBERS", all_values)
        self.check_numeric_options(FLIGHT / "groundtruth.csv.gz", FLIGHT)

    def compare_with_evo(self, python, truth, lengths, seed, turn=(0.2, -0.4, 2.0), scale=0.7):
        reference = self.write("ref.txt", tum(truth))
        estimate = self.write("est.txt", tum(noisy(truth, seed, 0.05, 0.02, turn, (10, -20, 3), scale)))
        done = subprocess.run([python, pathlib.Path(__file__).parent / "evo_figures.py", estimate, reference,
                               *map(str, lengths)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        worst = 0.0
        for align, evo in json.loads(done.stdout).items():
            ours = self.run_json(estimate, reference, "--align", align, "--interval", "1", "--lengths",
                                 ",".join(map(str, lengths)))
            pairs = [(ours["ate"], evo["ate"]), (ours["rpe_time"], evo["rpe_time"]),
                     *zip(ours["rpe_distance"]["by_length"], evo["by_length"])]
            for mine, theirs in pairs:
                for name, statistics in theirs.items():
                    self.assertEqual(mine[name]["count"], statistics["count"], (align, name))
                    for key, value in statistics.items():
                        worst = max(worst, abs(mine[name][key] - value) / max(1, abs(value)))
        self.assertLess(worst, 1e-10)
        return worst

    def test_the_same_figures_as_evo(self):
        python = python_with_evo()
        if python is None:
            self.skipTest("no Python with evo here (scripts/test.sh installs one in build/evo-venv)")
        truth = read_truth(FLIGHT / "groundtruth.csv.gz")
        for seed in (1, 2, 3):
            self.compare_with_evo(python, truth, (1, 4.5), seed)
        self.compare_with_evo(python, truth, (2,), 4, turn=(0, 0, 0), scale=1)

    def test_the_same_figures_as_evo_on_recorded_truth(self):
        python = python_with_evo()
        if python is None:
            self.skipTest("no Python with evo here (scripts/test.sh installs one in build/evo-venv)")
        if data_folder() is None:
            self.skipTest("no folder of recorded data (GLISSADE_DATA)")
        for name in ("euroc_v101_map", "kitti_0930_0020"):
            path = data_folder() / "vio" / name / "groundtruth.csv.gz"
            if not path.is_file():
                self.skipTest(f"{path} is not there")
            # Ten a second, so that a second is ten frames.
            poses = read_truth(path)
            step = max(1, round(1e8 * (len(poses) - 1) / (poses[-1][0] - poses[0][0])))
            truth = [(k * 100_000_000, p, q) for k, (_, p, q) in enumerate(poses[::step])]
            self.compare_with_evo(python, truth, (5, 20), 5)


if __name__ == "__main__":
    main(TrajEvalTest)
