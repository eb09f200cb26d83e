#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""window_solve: a small window of its own, published ones, options, JSON, and what it refuses."""

import csv
import gzip
import random
import statistics

from app_test_util import HEADER, ROOT, AppTest, data_folder, main

KEYS = HEADER | {"windows", "median_ms", "min_ms", "p95_ms", "p99_ms", "max_ms", "build_ms", "linearize_ms",
        "eliminate_ms", "solve_ms", "cost_ms", "allocations_per_solve", "accepted_steps",
        "rejected_steps", "windows_in_file", "imu", "method", "linear_solver", "threads",
        "mean_initial_cost", "mean_final_cost", "costs"}


def make_window(number=0, frames=4, landmarks=30, seed=5):
    """A camera that slides along x and looks along z; 1 px of noise. VIOWIN 1, vision only."""
    rng = random.Random(seed + number)
    lines = [f"WINDOW {number}", "CAMERA 400 400 320 240 640 480 1", "EXTRINSIC 0 0 0 0 0 0 1",
             "GRAVITY 0 0 -9.81", f"KEYFRAMES {frames}"]
    zeros = " ".join("0" * 9)
    for k in range(frames):
        x = 0.3 * k + (rng.gauss(0, 0.02) if k else 0)
        lines.append(f"KF {k} {0.1 * k} {x!r} {rng.gauss(0, 0.02) if k else 0!r} 0 0 0 0 1 {zeros}")
    lines += [f"GT {k} {0.1 * k} {0.3 * k!r} 0 0 0 0 0 1 {zeros}" for k in range(frames)]
    lines.append(f"LANDMARKS {landmarks}")
    for k in range(landmarks):
        point = rng.uniform(-2, 3), rng.uniform(-2, 2), rng.uniform(3, 9)
        pixels = [(400 * (point[0] - 0.3 * j) / point[2] + 320, 400 * point[1] / point[2] + 240)
                  for j in range(frames)]
        rho = 1 / point[2]
        line = f"LM {k} 0 {pixels[0][0]!r} {pixels[0][1]!r} {rho * rng.uniform(0.8, 1.2)!r} {rho!r}"
        line += f" {frames - 1}"
        for j in range(1, frames):
            line += f" {j} {pixels[j][0] + rng.gauss(0, 1)!r} {pixels[j][1] + rng.gauss(0, 1)!r}"
        lines.append(line)
    last = 0.3 * (frames - 1)
    lines += ["POSE_PRIORS 2", "PP 0 3 0 0 0 0 0 0 1 500 500 500 2000 2000 2000",
              f"PP {frames - 1} 1 {last!r} 0 0 0 0 0 1 20 20 20 20 20 20", "SB_PRIORS 0", "IMU 0",
              "END"]
    return "\n".join(lines) + "\n"


class WindowSolve(AppTest):
    app = "window_solve"
    numeric_options = {"--iterations": ("-1", "1.5"), "--threads": ("0", "-1", "1025"),
                       "--repeat": ("0", "-1", "1000001"), "--tolerance": ("-1", "1")}

    def check(self, result, windows):
        self.assertEqual(set(result), KEYS)
        self.assertEqual(result["windows"], windows)
        self.assertEqual(len(result["costs"]), windows)
        self.assertAlmostEqual(result["mean_final_cost"] / statistics.fmean(result["costs"]), 1)
        self.assertLess(result["mean_final_cost"], result["mean_initial_cost"])
        times = [result[k] for k in ("min_ms", "median_ms", "p95_ms", "p99_ms", "max_ms")]
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[0], 0)
        parts = sum(result[k] for k in ("linearize_ms", "eliminate_ms", "solve_ms", "cost_ms"))
        self.assertGreater(parts, 0)
        self.assertLess(parts, 1.5 * result["max_ms"])
        self.assertGreater(result["build_ms"], 0)
        self.assertEqual(result["windows_in_file"], windows)

    def small(self):
        return self.write("small.txt", "VIOWIN 1\n" + "".join(map(make_window, range(3))))

    def test_small_windows(self):
        path = self.small()
        result = self.run_json(path)
        self.check(result, 3)
        out = self.run_ok(path)
        self.assertIn("3 windows, 3 solves each", out)
        # All roads lead to the same optimum.
        for args in (("--method", "nielsen"), ("--method", "dogleg"), ("--threads", 2)):
            other = self.run_json(path, "--iterations", 50, "--tolerance", "1e-10", *args)
            self.check(other, 3)
            for a, b in zip(result["costs"], other["costs"]):
                self.assertAlmostEqual(a / b, 1, delta=1e-5, msg=str(args))
        self.assertEqual(self.run_json(path, "--threads", 2)["costs"], result["costs"])

    def test_exactly_so_many_steps(self):
        result = self.run_json(self.small(), "--iterations", 3, "--repeat", 1)
        self.assertLessEqual(result["accepted_steps"], 9)
        self.assertIsNone(result["allocations_per_solve"])
        at_start = self.run_json(self.small(), "--iterations", 0)
        self.assertEqual(at_start["mean_initial_cost"], at_start["mean_final_cost"])

    def test_loss(self):
        plain = self.run_json(self.small())["mean_final_cost"]
        for loss in ("huber:1", "cauchy:1", "tukey:3"):
            self.assertLess(self.run_json(self.small(), "--loss", loss)["mean_final_cost"], plain)
        self.assertAlmostEqual(self.run_json(self.small(), "--loss", "huber:1e9")["mean_final_cost"],
                               plain, delta=1e-9 * plain)

    def test_refusals(self):
        path = self.small()
        for args, why in (((), "FILE"), ((path, "--method", "gn"), "--method"),
                          ((path, "--linear-solver", "x"), "--linear-solver"),
                          ((path, "--loss", "l1"), "--loss"), ((path, "--loss", "huber:"), "--loss"),
                          ((path, "--loss", "huber:-1"), "--loss"),
                          ((path, "--loss", "huber:nan"), "--loss"),
                          *(((path, "--gauge", g), "--gauge")
                            for g in ("", "held", "prior", "prior:", "prior:0", "prior:-1", "prior:nan",
                                      "prior:1e300", "free:1", "fixed:")),
                          ((path, "--output", "no/such/folder/a.txt"), "--output"),
                          ((path, "--output", "-"), "--output"),
                          ((path, "--output", "same", "--json", "same"), "same"),
                          ((path, "--json", "no/such/folder/a.json"), "--json"),
                          (("absent.txt",), "absent.txt")):
            self.check_refused(*args, says=why)

    def test_numeric_options(self):
        self.check_numeric_options(self.small())

    def test_linear_solvers(self):
        self.check_linear_solvers(self.small(), "--iterations", 50, "--tolerance", "1e-12",
                                  cost=lambda r: r["mean_final_cost"])

    def test_gauges(self):
        # The file's priors hold the gauge already; where they agree with the start, nothing moves.
        free = self.run_json(self.small(), "--iterations", 50, "--tolerance", "1e-12")
        held = self.run_json(self.small(), "--iterations", 50, "--tolerance", "1e-12", "--gauge",
                             "fixed")
        pulled = self.run_json(self.small(), "--iterations", 50, "--tolerance", "1e-12", "--gauge",
                               "prior:1e12")
        for a, b, c in zip(free["costs"], held["costs"], pulled["costs"]):
            self.assertGreaterEqual(b, a * (1 - 1e-9))
            self.assertAlmostEqual(b / c, 1, delta=1e-3)

    def test_output_is_where_the_solve_ended(self):
        for name in ("out.txt", "out.txt.gz"):
            result = self.run_json(self.small(), "--output", name)
            again = self.run_json(name, "--iterations", 0)
            self.assertEqual(again["windows"], 3)
            # What is summed first depends on where a solve begins: rounding.
            for a, b in zip(again["costs"], result["costs"], strict=True):
                self.assertAlmostEqual(a / b, 1, delta=1e-13)
        # Whatever was solved how often: the result is that of one solve.
        self.run_ok(self.small(), "--repeat", 1, "--output", "once.txt")
        self.assertEqual((self.folder / "once.txt").read_bytes(),
                         (self.folder / "out.txt").read_bytes())

    def test_json_to_stdout(self):
        self.check_json_on_stdout(self.small())

    def test_interrupted_windows_and_output(self):
        text = "VIOWIN 1\n" + "".join(make_window(k) for k in range(3))
        path = self.write("long.txt", text)
        _, result = self.check_interrupt(path, "--repeat", 1000000, "--output", "out.txt", after=None)
        self.assertEqual(result["windows_in_file"], 3)
        self.assertLess(result["windows"], 3)
        self.assertGreater(result["windows"], 0)
        costs = self.run_json("out.txt", "--iterations", 0)["costs"]
        start = self.run_json(path, "--iterations", 0)["costs"]
        for a, b in zip(costs, result["costs"] + start[result["windows"]:], strict=True):
            self.assertAlmostEqual(a / b, 1, delta=1e-13)

    def test_version(self):
        self.check_version()

    def test_bad_files(self):
        good = "VIOWIN 1\n" + make_window()
        line = good.splitlines().index("LANDMARKS 30") + 2
        for bad, where, why in ((good[:len(good) // 2], "", "expected"),
                                (good.replace("LM 0 0 ", "LM 0 7 "), line, "unknown keyframe 7"),
                                (good.replace("LANDMARKS 30", "LANDMARKS -1"), line - 1, "landmarks"),
                                (good.replace("480 1\n", "480 0\n"), 3, "sigma_px"),
                                (good.replace("GRAVITY 0", "GRAVITY nan"), 5, "gravity"),
                                ("\x00\x01\x02 garbage", 1, "VIOWIN")):
            path = self.write("bad.txt", bad)
            self.check_refused(path, says=f"bad.txt:{where}")
            self.check_refused(path, says=why)

    def test_help(self):
        self.check_help("FILE", "--imu", "--iterations", "--method", "--gauge", "--loss", "--output",
                        "--threads", "--repeat", "--tolerance", "--json")

    def test_own_windows(self):
        for name, windows in (("win10.txt.gz", 3), ("win11m.txt.gz", 1)):
            for kind in ((), ("--imu",)):
                result = self.run_json(ROOT / "data" / name, *kind, "--iterations", 50,
                                       "--tolerance", "1e-10")
                self.check(result, windows)
                self.assertLess(result["mean_final_cost"], 0.1 * result["mean_initial_cost"])

    def test_published_windows(self):
        data = data_folder()
        if data is None or not (data / "windows" / "win10.txt.gz").exists():
            self.skipTest("no folder of windows")
        with open(data / "windows" / "reference_costs.csv", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["file"] == "win10.txt"]
        vision = self.run_json(data / "windows" / "win10.txt.gz")
        self.check(vision, len(rows))
        for cost, row in zip(vision["costs"], rows):
            self.assertAlmostEqual(cost / float(row["vision_optimum"]), 1, delta=1e-6)
        imu = self.run_json(data / "windows" / "win10.txt.gz", "--imu", "--iterations", 100,
                            "--tolerance", "1e-12")
        for cost, row in zip(imu["costs"], rows):
            self.assertAlmostEqual(cost / float(row["vi_optimum"]), 1, delta=1e-6)
        if vision["allocations_per_solve"] is not None:
            self.assertEqual(vision["allocations_per_solve"], 0)
            self.assertEqual(imu["allocations_per_solve"], 0)

    def test_compressed(self):
        text = "VIOWIN 1\n" + make_window()
        path = self.folder / "w.txt.gz"
        path.write_bytes(gzip.compress(text.encode()))
        self.assertEqual(self.run_json(path)["costs"], self.run_json(self.write("w.txt", text))["costs"])


if __name__ == "__main__":
    main(WindowSolve)
