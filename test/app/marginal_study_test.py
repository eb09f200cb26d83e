#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""marginal_study: what its numbers must show, and what it refuses."""

from app_test_util import AppTest, main


class MarginalStudyTest(AppTest):
    app = "marginal_study"
    numeric_options = {"--frames": ("3", "-1", "2001"), "--window": ("2", "-1", "51"),
                       "--points": ("9", "-1", "20001"), "--seed": ("-1", "4294967296"),
                       "--iterations": ("-1",), "--threads": ("0",)}

    def test_yaw_is_gained_without_first_estimates_and_position_never(self):
        walk = self.run_json("--frames", "20", "--window", "5", "--points", "80")["walk"]
        for mode, rows in walk.items():
            names = [name for name in rows[-1] if name not in ("frame", "cost")]
            self.assertEqual(len(names), 4)
            for name in names:
                worst = max(row[name]["kappa"] for row in rows)
                if "yaw" in name and mode != "full":
                    self.assertGreater(worst, 1e-10, mode)
                else:
                    self.assertLess(worst, 1e-12, (mode, name))

    def test_matrices_fit_each_other(self):
        matrices = self.run_json("--frames", "12", "--window", "5", "--points", "60")["matrices"]
        before, after = len(matrices["before"]), len(matrices["after"])
        self.assertEqual(len(matrices["moved"]), before)
        self.assertEqual(before - after, matrices["going"])
        self.assertGreater(matrices["going"], 15)

    def test_refusals(self):
        self.check_refused("--frames", "5", "--window", "7", says="--frames")
        self.check_refused("--json", "no/such/a.json", says="--json")
        self.check_refused("extra", says="extra")

    def test_numeric_options(self):
        self.check_numeric_options()

    def test_reports_what_it_did_and_writes_only_where_asked(self):
        out = self.run_ok("--frames", "12", "--window", "5", "--points", "60")
        self.assertEqual(self.files(), [])
        self.assertRegex(out, r"information of a window of 75 states: \d+ variables")
        for mode in ("off", "prior_only", "full"):
            self.assertRegex(out, rf"(?m)^{mode} +10 .* yaw \d")

    def test_json_to_stdout(self):
        self.check_json_on_stdout("--frames", "8", "--window", "4", "--points", "60")

    def test_interrupted_walk(self):
        _, result = self.check_interrupt("--frames", "2000", "--points", "3000", after="variables")
        self.assertIn("before", result["matrices"])
        self.assertLess(sum(map(len, result["walk"].values())), 3 * 1998)

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--frames", "--window", "--points", "--seed", "kappa")


if __name__ == "__main__":
    main(MarginalStudyTest)
