#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""bench_ba: what it says of a small city is so, and a solver that dies is a line of the table."""

import json
import subprocess
import unittest

from app_test_util import AppTest, main, strict_json

SOLVER = {"name", "about", "end", "chosen", "step_s", "ratio", "to_1e-1_s", "to_1e-2_s", "to_1e-3_s", "setup_s",
          "solve_s", "peak_mb", "cg_per_step", "cost", "audited_cost", "runs"}


class BenchBaTest(AppTest):
    app = "bench_ba"

    def setUp(self):
        super().setUp()
        if not (self.folder_of_executables / self.app).exists():
            self.skipTest("bench_ba has not been built (GLISSADE_BUILD_BENCHMARKS)")

    def bench(self, *args):
        result = self.run_app(*args, "--json", "b.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout, strict_json((self.folder / "b.json").read_text())

    def test_small_city(self):
        table, json_ = self.bench("--city", "20", "--rounds", "1", "--steps", "12")
        problem, = json_["problems"]
        solvers = {solver["name"]: solver for solver in problem["solvers"]}
        self.assertIn("glissade-auto", solvers)
        if json_["ceres"]:
            self.assertIn("ceres-sparse", solvers)
        # The audit knows nothing of the library: both say the same of the start and of the end.
        self.run_by("ba_solve", "--city", "20", "--iterations", "0", "--json", "start.json")
        start = json.loads((self.folder / "start.json").read_text())
        for what in ("cameras", "points", "observations"):
            self.assertEqual(problem[what], start[what])
        self.assertAlmostEqual(problem["initial_cost"] / start["initial_cost"], 1, delta=1e-12)
        for name, solver in solvers.items():
            with self.subTest(solver=name):
                self.assertEqual(set(solver), SOLVER)
                self.assertEqual(solver["end"], "done")
                self.assertIn(name, table)
                self.assertAlmostEqual(solver["audited_cost"] / solver["cost"], 1, delta=1e-11)
                # All come to the same optimum.
                self.assertAlmostEqual(solver["audited_cost"] / problem["best_cost"], 1, delta=1e-4)
                self.assertGreater(solver["step_s"], 0)
                self.assertLessEqual(solver["to_1e-1_s"], solver["to_1e-3_s"])
                self.assertLessEqual(solver["to_1e-3_s"], solver["solve_s"])
                self.assertGreater(solver["peak_mb"], 1)
                trace = solver["runs"][0]["trace"]
                self.assertAlmostEqual(trace[0][1] / problem["initial_cost"], 1, delta=1e-12)
                iterative = any(word in name for word in ("pcg", "implicit", "iterative"))
                self.assertEqual(solver["cg_per_step"] > 0 or name == "glissade-auto", iterative or
                                 name == "glissade-auto")

    def test_a_solver_that_dies_is_not_the_end(self):
        table, json_ = self.bench("--city", "60", "--rounds", "1", "--steps", "2", "--only", "glissade-sparse",
                                  "--memory-limit", "12")
        solver, = json_["problems"][0]["solvers"]
        self.assertNotEqual(solver["end"], "done")
        self.assertIsNone(solver["audited_cost"])
        self.assertIn(f"[{solver['end']}]", table)

        table, json_ = self.bench("--city", "100", "--rounds", "1", "--steps", "1000", "--only", "glissade-sparse",
                                  "--time-limit", "0.01")
        self.assertIn("[time limit]", table)

    def test_what_makes_no_sense_is_refused(self):
        for args in ((), ("--city", "19"), ("--city", "20", "--only", "glissade-fast"), ("--city", "20", "--steps", "0"),
                     ("--city", "20", "--quick", "1"), ("--once", "--city", "20"), ("none.txt",)):
            result = self.run_app(*args)
            self.assertEqual(result.returncode, 2, args)
            self.assertIn("bench_ba: ", result.stderr)

    def run_by(self, app, *args):
        subprocess.run([str(self.folder_of_executables / app), *args], cwd=self.folder, check=True,
                       capture_output=True, timeout=300)


if __name__ == "__main__":
    main(BenchBaTest)
