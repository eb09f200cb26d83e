#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""prior_weight_sweep: the converged errors, what the course's rule makes of them, files, refusals."""

import csv

from app_test_util import AppTest, main

# weight -> pose error (m), point error (1/m) of a solve that has converged.
CONVERGED = {1e3: (0.00662678, 0.0019507), 1e4: (0.00673339, 0.0019389),
             1e5: (0.0067447, 0.0019376), 1e6: (0.00674584, 0.0019375),
             1e7: (0.00674595, 0.0019375), 1e8: (0.00674596, 0.0019375)}
FIXED = (0.00674596, 0.0019375)


class PriorWeightSweep(AppTest):
    app = "prior_weight_sweep"
    numeric_options = {"--weights": ("-1", "1e3,-1", "1e3,nan", "1e3,heavy", "1e3,", ",1", ",",
                                     "1e3 1e4"),
                       "--pose-noise": ("-0.1", "-1"), "--trials": ("0", "-1", "many"),
                       "--seed": ("-1", "4294967296", "1.5"), "--iterations": ("-5", "-1"),
                       "--threads": ("0", "-1", "1025")}

    def rows(self, *args):
        result = self.run_json(*args)
        weights = {row["weight"]: row for row in result["rows"] if not row["fixed"]}
        fixed = [row for row in result["rows"] if row["fixed"]]
        self.assertEqual(len(fixed), 1)
        return weights, fixed[0]

    def check_converged(self, weights, fixed, trials):
        self.assertEqual(set(weights), {0, *CONVERGED})
        for weight, (pose, point) in CONVERGED.items():
            for trial in weights[weight]["trials"]:
                self.assertAlmostEqual(trial["pose_error_m"], pose, delta=1e-7)
                self.assertAlmostEqual(trial["point_error_per_m"], point, delta=1e-7)
            self.assertEqual(weights[weight]["converged_trials"], trials)
        for trial in fixed["trials"]:
            self.assertAlmostEqual(trial["pose_error_m"], FIXED[0], delta=1e-7)
            self.assertAlmostEqual(trial["point_error_per_m"], FIXED[1], delta=1e-7)
        # The rest falls as 1 / weight.
        for weight in (1e3, 1e4, 1e5):
            rest = [abs(weights[w]["pose_error_m"] - fixed["pose_error_m"]) for w in (weight, 10 * weight)]
            self.assertAlmostEqual(rest[0] / rest[1], 10, delta=0.6)

    def test_from_the_truth(self):
        weights, fixed = self.rows()
        self.check_converged(weights, fixed, 1)
        self.assertTrue(weights[0]["aligned"])

    def test_from_perturbed_poses(self):
        weights, fixed = self.rows("--pose-noise", 0.1, "--trials", 8)
        self.check_converged(weights, fixed, 8)
        # Aligned, a free solution has one error, wherever on its orbit it ended.
        self.assertLess(weights[0]["pose_error_spread_m"], 1e-7)
        start, = self.rows("--weights", "0")[0].values()
        self.assertAlmostEqual(weights[0]["pose_error_m"], start["pose_error_m"], delta=1e-7)

    def test_seed(self):
        args = ("--pose-noise", 0.1, "--trials", 2, "--weights", "1e3")

        def first_costs(seed):
            row = self.rows(*args, "--seed", seed)[0][1e3]
            return [trial["steps"][0]["cost"] for trial in row["trials"]]

        once = first_costs(7)
        self.assertEqual(once, first_costs(7))
        self.assertNotEqual(once, first_costs(8))
        self.assertNotEqual(once[0], once[1])

    def test_course_stop_stops_early(self):
        weights, _ = self.rows("--course-stop")
        for weight, pose in ((1e4, 0.0060), (1e6, 0.00011), (1e8, 0.0000036)):
            self.assertEqual(f"{weights[weight]['pose_error_m']:.2g}", f"{pose:.2g}")
        # From poses that are off it is the other way round: nothing was solved.
        weights, _ = self.rows("--course-stop", "--pose-noise", 0.1, "--trials", 4)
        self.assertGreater(weights[1e8]["pose_error_m"], 0.05)

    def test_path(self):
        weights, _ = self.rows("--pose-noise", 0.1, "--weights", "0,1e8")
        for row in weights.values():
            steps = row["trials"][0]["steps"]
            self.assertEqual(steps[0]["iteration"], 0)
            self.assertEqual(set(steps[0]), {"iteration", "cost", "reprojection_error",
                                             "prior_position_error_m", "prior_rotation_error_rad"})
            self.assertLess(steps[-1]["reprojection_error"], 2e-3)
            self.assertGreater(steps[0]["reprojection_error"], 0.1)
        self.assertEqual(weights[0]["trials"][0]["steps"][0]["prior_position_error_m"],
                         weights[1e8]["trials"][0]["steps"][0]["prior_position_error_m"])
        self.assertLess(weights[1e8]["trials"][0]["steps"][-1]["prior_position_error_m"], 1e-6)
        self.assertGreater(weights[0]["trials"][0]["steps"][-1]["prior_position_error_m"], 1e-2)

    def test_csv(self):
        self.run_ok("--trials", 2, "--pose-noise", 0.01, "--csv", "a.csv")
        self.assertEqual(self.files(), ["a.csv"])
        with open(self.folder / "a.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * 8)
        self.assertEqual(rows[2]["weight"], "1000")
        self.assertEqual(rows[-1]["weight"], "fixed")
        self.assertAlmostEqual(float(rows[2]["pose_error_m"]), CONVERGED[1e3][0], delta=1e-7)

    def test_table(self):
        out = self.run_ok("--weights", "10,1e3")
        lines = out.splitlines()
        self.assertEqual([line.split()[0] for line in lines], ["weight", "10", "1000", "fixed"])
        self.assertIn("0.00662678", lines[2])
        verbose = self.run_ok("--weights", "1e3", "--verbose").splitlines()
        self.assertIn("reprojection", verbose[4])
        self.assertEqual(verbose[5].split()[:3], ["1000", "0", "2.675495e+00"])

    def test_refuses(self):
        for args, says in (
                (("--weights",), "--weights"), (("--method", "newton"), "--method"), (("--scene", "missing.txt"), "missing.txt"),
                (("--csv", "no/such/a.csv"), "--csv"), (("--json", "."), "--json"),
                (("--csv", "same", "--json", "same"), "same"), (("extra",), "extra"),
                (("--json", "a.json", "--scene", "missing.txt"), "missing.txt")):
            self.check_refused(*args, says=says)
        scene = self.write("one_pose_too_few.txt", """GLISSADE_COURSE_SCENE 1
POSES 2
POSE 0  0 0 0  0 0 0 1
POSE 1  1 0 0  0 0 0 1
POINTS 1
POINT 0  0 0 5  0.25  2  0 0 0  1 -0.2 0
END
""")
        self.check_refused("--scene", scene, "--json", "a.json", says="three poses")

    def test_numeric_options(self):
        # "1,5" is two weights.
        import app_test_util
        all_values = app_test_util.NO_NUMBERS
        app_test_util.NO_NUMBERS = tuple(v for v in all_values if v != "1,5")
        try:
            self.check_numeric_options()
        finally:
            app_test_util.NO_NUMBERS = all_values

    def test_linear_solvers(self):
        self.check_linear_solvers("--weights", "1e3",
                                  cost=lambda r: r["rows"][0]["trials"][0]["steps"][-1]["cost"])

    def test_json_to_stdout(self):
        self.check_json_on_stdout("--weights", "1e3", "--trials", 2)
        result = self.run_app("--weights", "1e3", "--csv", "-")
        self.assertEqual(result.stdout.splitlines()[0].split(",")[:2], ["weight", "trial"])
        self.assertIn("point err", result.stderr)

    def test_interrupted_trials(self):
        out, result = self.check_interrupt("--trials", 100000, "--pose-noise", 0.1, "--csv", "a.csv",
                                           after=None)
        trials = [len(row["trials"]) for row in result["rows"]]
        self.assertGreater(trials[0], 0)
        self.assertLess(sum(trials), 8 * 100000)
        self.assertIn("converged", out)
        with open(self.folder / "a.csv", newline="", encoding="utf-8") as file:
            self.assertEqual(len(list(csv.DictReader(file))), sum(trials))

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--weights", "--pose-noise", "--trials", "--seed", "--course-stop", "--csv", "--method",
                        "--json", "similarity", "1 / weight")


if __name__ == "__main__":
    main(PriorWeightSweep)
