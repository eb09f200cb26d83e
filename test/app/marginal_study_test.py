#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""marginal_study: what its numbers must show, and what it refuses."""

from app_test_util import AppTest, main


class MarginalStudyTest(AppTest):
    app = "marginal_study"

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
        self.check_refused("--window", "2", says="window")
        self.check_refused("--frames", "5", "--window", "7", says="frames")


if __name__ == "__main__":
    main(MarginalStudyTest)
