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
                self.assertAlmostEqual(trial["pose_error"], pose, delta=1e-7)
                self.assertAlmostEqual(trial["point_error"], point, delta=1e-7)
            self.assertEqual(weights[weight]["converged"], trials)
        for trial in fixed["trials"]:
            self.assertAlmostEqual(trial["pose_error"], FIXED[0], delta=1e-7)
            self.assertAlmostEqual(trial["point_error"], FIXED[1], delta=1e-7)
        # The rest falls as 1 / weight.
        for weight in (1e3, 1e4, 1e5):
            rest = [abs(weights[w]["pose_error"] - fixed["pose_error"]) for w in (weight, 10 * weight)]
            self.assertAlmostEqual(rest[0] / rest[1], 10, delta=0.6)

    def test_from_the_truth(self):
        weights, fixed = self.rows()
        self.check_converged(weights, fixed, 1)
        self.assertTrue(weights[0]["aligned"])

    def test_from_perturbed_poses(self):
        weights, fixed = self.rows("--pose-noise", 0.1, "--trials", 8)
        self.check_converged(weights, fixed, 8)
        # Aligned, a free solution has one error, wherever on its orbit it ended.
        self.assertLess(weights[0]["pose_error_spread"], 1e-7)
        start, = self.rows("--weights", "0")[0].values()
        self.assertAlmostEqual(weights[0]["pose_error"], start["pose_error"], delta=1e-7)

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
            self.assertEqual(f"{weights[weight]['pose_error']:.2g}", f"{pose:.2g}")
        # From poses that are off it is the other way round: nothing was solved.
        weights, _ = self.rows("--course-stop", "--pose-noise", 0.1, "--trials", 4)
        self.assertGreater(weights[1e8]["pose_error"], 0.05)

    def test_path(self):
        weights, _ = self.rows("--pose-noise", 0.1, "--weights", "0,1e8")
        for row in weights.values():
            steps = row["trials"][0]["steps"]
            self.assertEqual(steps[0]["iteration"], 0)
            self.assertEqual(set(steps[0]), {"iteration", "cost", "reprojection_error",
                                             "prior_position_error", "prior_rotation_error"})
            self.assertLess(steps[-1]["reprojection_error"], 2e-3)
            self.assertGreater(steps[0]["reprojection_error"], 0.1)
        self.assertEqual(weights[0]["trials"][0]["steps"][0]["prior_position_error"],
                         weights[1e8]["trials"][0]["steps"][0]["prior_position_error"])
        self.assertLess(weights[1e8]["trials"][0]["steps"][-1]["prior_position_error"], 1e-6)
        self.assertGreater(weights[0]["trials"][0]["steps"][-1]["prior_position_error"], 1e-2)

    def test_csv(self):
        self.run_ok("--trials", 2, "--pose-noise", 0.01, "--csv", "a.csv")
        self.assertEqual(self.files(), ["a.csv"])
        with open(self.folder / "a.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * 8)
        self.assertEqual(rows[2]["weight"], "1000")
        self.assertEqual(rows[-1]["weight"], "fixed")
        self.assertAlmostEqual(float(rows[2]["pose_error"]), CONVERGED[1e3][0], delta=1e-7)

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
                (("--weights", "1e3,-1"), "--weights"), (("--weights", "1e3,nan"), "--weights"),
                (("--weights", "1e3,heavy"), "--weights"), (("--weights",), "--weights"),
                (("--pose-noise", "-0.1"), "--pose-noise"), (("--pose-noise", "inf"), "--pose-noise"),
                (("--trials", "0"), "--trials"), (("--trials", "many"), "--trials"),
                (("--seed", "-1"), "--seed"), (("--iterations", "-5"), "--iterations"),
                (("--lm", "newton"), "--lm"), (("--scene", "missing.txt"), "missing.txt"),
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

    def test_help(self):
        self.check_help("--weights", "--pose-noise", "--trials", "--seed", "--course-stop", "--csv",
                        "--json", "similarity", "1 / weight")


if __name__ == "__main__":
    main(PriorWeightSweep)
