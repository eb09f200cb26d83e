#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""make_data: what it writes is read by the programs that it is for; what makes no sense is refused."""

import gzip
import json
import subprocess

from app_test_util import ROOT, AppTest, main


class MakeDataTest(AppTest):
    app = "make_data"
    numeric_options = {"--seed": ("-1", "1.5"), "--windows": ("0", "1.5"), "--keyframes": ("1", "1001"),
                       "--landmarks": ("0",), "--hosted-by-first": ("-1",), "--length": ("0",),
                       "--cameras": ("2",), "--points": ("0",), "--outliers": ("-0.1", "0.6")}

    def test_help_and_version(self):
        text = self.run_ok("--help")
        for word in ("Examples:", "Exit code:", "windows", "recording", "bal", "--seed"):
            self.assertIn(word, text)
        self.check_version()

    def test_the_files_of_data_are_what_it_makes(self):
        """The text may differ by a rounding of another machine's log: what is compared is its shape."""
        script = ROOT / "scripts" / "make_data.sh"
        subprocess.run([script, self.folder_of_executables, self.folder / "made"], check=True,
                       capture_output=True)
        for name in ("win10.txt.gz", "win11m.txt.gz", "ring.txt.gz", "flight_odometry.txt.gz", "flight/tracks.csv.gz",
                     "flight/imu.csv.gz", "flight/frames.csv.gz", "flight/groundtruth.csv.gz"):
            with gzip.open(self.folder / "made" / name) as made, gzip.open(ROOT / "data" / name) as kept:
                new, old = made.read().split(b"\n"), kept.read().split(b"\n")
            self.assertEqual(len(new), len(old), name)
            self.assertEqual([len(line.split()) for line in new], [len(line.split()) for line in old])

    def test_other_programs_read_what_it_writes(self):
        self.run_ok("windows", "w.txt.gz", "--windows", "1", "--keyframes", "6", "--landmarks", "8")
        self.run_ok("bal", "b.txt", "--cameras", "5", "--points", "30")
        self.run_ok("recording", "r", "--length", "4")
        for command in (("window_solve", "w.txt.gz", "--imu"), ("ba_solve", "b.txt"),
                        ("gauge_study", "--trials", "2", "--vio", "r", "--vio-start", "0.1",
                         "--vio-keyframes", "8")):
            done = subprocess.run([self.folder_of_executables / command[0], *command[1:]],
                                  cwd=self.folder, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_city(self):
        out = self.run_ok("city", "c.txt.gz", "--cameras", "50", "--seed", "4")
        self.assertRegex(out, r"^c.txt.gz: 50 cameras, \d+ points, \d+ observations\n$")
        self.run_ok("city", "c.bbal", "--cameras", "50", "--seed", "4")
        self.run_ok("city", "o.txt", "--cameras", "50", "--seed", "4", "--outliers", "0.05")
        costs = []
        for name in ("c.txt.gz", "c.bbal", "o.txt"):
            done = subprocess.run([self.folder_of_executables / "ba_solve", name, "--iterations", "0",
                                   "--json", "-"], cwd=self.folder, capture_output=True, text=True, check=True)
            costs.append(json.loads(done.stdout)["initial_cost"])
        self.assertEqual(costs[0], costs[1])
        self.assertGreater(costs[2], 10 * costs[0])

    def test_the_same_seed_gives_the_same_file(self):
        for name, seed in (("a", "7"), ("b", "7"), ("c", "8")):
            self.run_ok("windows", name, "--windows", "1", "--keyframes", "5", "--landmarks", "5",
                        "--seed", seed)
        a, b, c = ((self.folder / name).read_bytes() for name in "abc")
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)

    def test_refusals(self):
        self.check_refused("waves", "f", says="KIND")
        self.check_refused("windows", says="OUTPUT")
        self.check_refused("city", "f", "--cameras", "19", says="num_cameras")
        self.check_refused("windows", "f", "--hosted-by-first", "10000", says="hosted_by_first")
        self.check_numeric_options("windows", "f")

    def test_a_folder_that_does_not_exist(self):
        result = self.run_app("windows", "no/such/file", "--windows", "1", "--keyframes", "5",
                              "--landmarks", "5")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no/such/file", result.stderr)


if __name__ == "__main__":
    main(MakeDataTest)
