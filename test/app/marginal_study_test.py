#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""marginal_study: what its numbers must show, and what it refuses."""

from app_test_util import AppTest, main, without_sanitizers


class MarginalStudyTest(AppTest):
    app = "marginal_study"
    numeric_options = {"--flight": ("3", "-1", "2001"), "--keyframes": ("2", "-1", "51"),
                       "--points": ("9", "-1", "20001"), "--trials": ("0", "1001"),
                       "--pixel-noise": ("0", "21"), "--seed": ("-1", "4294967296"),
                       "--iterations": ("-1",), "--threads": ("0",)}

    def test_yaw_is_gained_without_first_estimates_and_position_never(self):
        walks = self.run_json("--flight", "20", "--keyframes", "5", "--points", "80")["walk"]
        self.assertEqual(list(walks), ["free", "fixed"])
        for gauge, modes in walks.items():
            self.assertEqual(list(modes), ["off", "prior_only", "full"])
            for mode, rows in modes.items():
                yaw = max(row["kappa_yaw"] for row in rows)
                if mode == "full":
                    self.assertLess(yaw, 1e-12, (gauge, mode))
                else:
                    self.assertGreater(yaw, 1e-10, (gauge, mode))
                self.assertLess(max(row["kappa_position"] for row in rows), 1e-12, (gauge, mode))

    @without_sanitizers
    def test_no_window_falls_into_what_its_front_end_would_not_give_it(self):
        # Starts in a world frame that the window had left, biases without a prior, hardly a point
        # left after the first marginalization: costs of 7084 where the noise makes 300.
        walks = self.run_json()["walk"]
        for gauge, modes in walks.items():
            for mode, rows in modes.items():
                self.assertEqual(len(rows), 53)
                self.assertLess(max(row["cost"] for row in rows), 1000.0, (gauge, mode))
                if gauge == "free" and mode != "full":
                    continue  # turns away from its prior: docs/marginalization.md
                turned = max(abs(row["yaw_since_linearized_deg"]) for row in rows)
                self.assertLess(turned, 2.0, (gauge, mode))
                honest = sum(row["nees_position"] for row in rows) / len(rows)
                self.assertLess(honest, 5.0, (gauge, mode))

    def test_matrices_fit_each_other(self):
        matrices = self.run_json("--flight", "12", "--keyframes", "5", "--points", "60")["matrices"]
        before, after = len(matrices["before"]), len(matrices["after"])
        self.assertEqual(len(matrices["moved"]), before)
        self.assertEqual(before - after, matrices["going"])
        self.assertGreater(matrices["going"], 15)
        groups = {name: sum(group["size"] for group in groups)
                  for name, groups in matrices["groups"].items()}
        self.assertEqual(groups, {"before": before, "going": matrices["going"], "staying": after})

    def test_refusals(self):
        self.check_refused("--flight", "5", "--keyframes", "7", says="--flight")
        self.check_refused("--json", "no/such/a.json", says="--json")
        self.check_refused("extra", says="extra")

    def test_numeric_options(self):
        self.check_numeric_options()

    def test_reports_what_it_did_and_writes_only_where_asked(self):
        out = self.run_ok("--flight", "12", "--keyframes", "5", "--points", "60")
        self.assertEqual(self.files(), [])
        self.assertRegex(out, r"information of a window of 75 states: \d+ variables")
        for gauge in ("free", "fixed"):
            for mode in ("off", "prior_only", "full"):
                self.assertRegex(out, rf"(?m)^{gauge} +{mode} +\d")

    def test_json_to_stdout(self):
        self.check_json_on_stdout("--flight", "8", "--keyframes", "4", "--points", "60")

    def test_interrupted_walk(self):
        _, result = self.check_interrupt("--flight", "2000", "--points", "3000", after="variables")
        self.assertIn("before", result["matrices"])
        self.assertLess(len(result["walk"]["fixed"].get("full", [])), 1993)

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--flight", "--keyframes", "--points", "--seed", "kappa")


if __name__ == "__main__":
    main(MarginalStudyTest)
