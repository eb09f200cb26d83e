#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""testMonoBA: the course's run, its options, its JSON, and what it refuses."""

import re

from app_test_util import HEADER, ROOT, AppTest, main


def six(x):
    """Six significant digits, as printed."""
    return f"{x:.6g}"


class TestMonoBA(AppTest):
    app = "testMonoBA"
    numeric_options = {"--fix": ("-1", "1.5", "two", "4"),
                       "--prior-weight": ("-1", "heavy"),
                       "--iterations": ("-1", "99999999999999"), "--threads": ("0", "1025")}

    def lines(self, *args):
        """The (chi, lambda) of the `iter:` lines, as printed."""
        out = self.run_ok(*args)
        found = re.findall(r"^iter: (\d+) , chi= (\S+) , Lambda= (\S+)$", out, re.MULTILINE)
        self.assertEqual([int(k) for k, _, _ in found], list(range(len(found))))
        return [(chi, lam) for _, chi, lam in found], out

    def check_schema(self, result, poses=3, points=20):
        self.assertEqual(set(result), HEADER | {"iterations", "final_cost", "status", "points", "poses",
                                       "marginalize"})
        for k, iteration in enumerate(result["iterations"]):
            self.assertEqual(set(iteration), {"iter", "cost", "lambda"})
            self.assertEqual(iteration["iter"], k)
        self.assertEqual(len(result["points"]), points)
        for point in result["points"]:
            self.assertEqual(set(point), {"gt_per_m", "noise_per_m", "opt_per_m"})
        self.assertEqual(len(result["poses"]), poses)
        for pose in result["poses"]:
            self.assertEqual(set(pose), {"t_m", "gt_m"})
            self.assertEqual((len(pose["t_m"]), len(pose["gt_m"])), (3, 3))
        self.assertEqual(set(result["marginalize"]), {"before", "moved", "after"})
        self.assertIsInstance(result["status"], str)

    def test_nothing_fixed(self):
        iterations, out = self.lines()
        self.assertEqual(iterations[:3], [("5.35099", "0.00597396"), ("0.0290846", "0.00199132"),
                                          ("0.000100231", "0.000663774")])
        self.assertEqual(iterations[3][0], "9.85708e-05")
        self.assertEqual(iterations[-1][0], "9.85708e-05")
        for line in ("0 order: 0", "1 order: 6", "2 order: 12",
                     " ordered landmark vertices size : 20"):
            self.assertIn(line + "\n", out)
        self.assertIn("converged (step): sum of Chi2 9.85708e-05\n", out)

    def test_two_poses_fixed(self):
        iterations, out = self.lines("--fix", 2)
        self.assertEqual(iterations[:3], [("5.35099", "0.00597396"), ("0.0282523", "0.00199132"),
                                          ("0.000115056", "0.000663774")])
        self.assertEqual(iterations[3][0], "0.000113378")
        # The order lines number all poses, fixed ones too.
        self.assertIn("2 order: 12\n", out)

    def test_json(self):
        result = self.run_json()
        self.check_schema(result)
        self.assertEqual(six(2 * result["final_cost"]), "9.85708e-05")
        self.assertEqual(six(2 * result["iterations"][1]["cost"]), "0.0290846")
        self.assertEqual(six(result["iterations"][0]["lambda"]), "0.00597396")
        self.assertTrue(result["status"].startswith("converged"))
        points = result["points"]
        self.assertEqual([six(points[0]["gt_per_m"]), six(points[0]["noise_per_m"])], ["0.220938", "0.227057"])
        self.assertEqual([six(points[k]["opt_per_m"]) for k in (0, 1, 19)],
                         ["0.220958", "0.234806", "0.146673"])
        self.assertEqual([six(x) for x in result["poses"][2]["t_m"]],
                         ["-4.00178", "6.92753", "0.866931"])
        self.assertEqual([six(x) for x in result["marginalize"]["before"][0]], ["100", "-100", "0"])
        self.assertEqual([[six(x) for x in row] for row in result["marginalize"]["after"]],
                         [["26.5306", "-8.16327"], ["-8.16327", "10.2041"]])

    def test_course_stop(self):
        free = self.run_json("--course-stop")
        self.assertEqual(len(free["iterations"]), 3)
        self.assertEqual([six(free["points"][k]["opt_per_m"]) for k in (0, 1, 19)],
                         ["0.220965", "0.234874", "0.146759"])
        self.assertEqual([six(x) for x in free["poses"][2]["t_m"]],
                         ["-4.00168", "6.92762", "0.866999"])
        fixed = self.run_json("--course-stop", "--fix", 2)
        self.assertEqual([six(fixed["points"][k]["opt_per_m"]) for k in (0, 1, 19)],
                         ["0.220908", "0.234388", "0.146536"])
        self.assertEqual([six(x) for x in fixed["poses"][2]["t_m"]],
                         ["-3.99859", "6.92912", "0.859659"])
        for k in (0, 1):
            self.assertEqual(fixed["poses"][k]["t_m"], fixed["poses"][k]["gt_m"])

    def test_other_ways_to_the_same_optimum(self):
        for fix, chi in ((0, "9.85708e-05"), (2, "0.000113378")):
            for args in (("--method", "lm"), ("--method", "nielsen"), ("--method", "dogleg"),
                         ("--linear-solver", "pcg"), ("--linear-solver", "dense"),
                         ("--linear-solver", "sparse"), ("--threads", 2),
                         ("--method", "lm", "--linear-solver", "pcg")):
                result = self.run_json("--fix", fix, *args)
                self.assertEqual(six(2 * result["final_cost"]), chi, args)
                self.assertTrue(result["status"].startswith("converged"), result["status"])

    def test_prior(self):
        result = self.run_json("--prior-weight", "1e6", "--method", "lm")
        error = sum(sum((a - b) ** 2 for a, b in zip(p["t_m"], p["gt_m"])) ** 0.5
                    for p in result["poses"])
        self.assertAlmostEqual(error, 0.00674584, delta=1e-8)

    def test_iterations_and_verbose(self):
        result = self.run_json("--iterations", 1)
        self.assertEqual(result["status"], "iteration limit")
        self.assertEqual(len(result["iterations"]), 2)
        self.assertEqual(len(self.run_json("--iterations", 0)["iterations"]), 1)
        plain, verbose = self.run_ok(), self.run_ok("--verbose")
        self.assertNotIn("gradient", plain)
        self.assertRegex(verbose, r"(?m)^iter .*cost.*gradient.*lambda")

    def test_scene_file(self):
        frozen = ROOT / "data" / "course_scene.txt"
        read, built_in = self.run_json("--scene", frozen), self.run_json()
        self.assertEqual((read.pop("file"), built_in.pop("file")), (str(frozen), None))
        self.assertEqual(read, built_in)
        small = self.write("small.txt", """GLISSADE_COURSE_SCENE 1
POSES 2
POSE 0  0 0 0  0 0 0 1
POSE 1  1 0 0  0 0 0 1
POINTS 2
POINT 0  0 0 5  0.25  2  0 0 0  1 -0.2 0
POINT 1  1 1 4  0.2  2  0 0.25 0.25  1 0 0.25
END
""")
        result = self.run_json("--scene", small, "--fix", 2)
        self.check_schema(result, poses=2, points=2)
        self.assertAlmostEqual(result["points"][0]["opt_per_m"], 0.2, places=9)
        self.assertAlmostEqual(result["points"][1]["opt_per_m"], 0.25, places=9)

    def test_refuses_options(self):
        for args, says in (
                (("--fix",), "--fix"), (("--method", "newton"), "--method"),
                (("--linear-solver", "qr"), "--linear-solver"),
                (("--no-such-option",), "--no-such-option"), (("file.txt",), "file.txt"),
                (("--json",), "--json"), (("--json", "no/such/folder/a.json"), "--json"),
                (("--json", "."), "--json")):
            self.check_refused(*args, says=says)

    def test_refuses_scenes(self):
        good = (ROOT / "data" / "course_scene.txt").read_text(encoding="utf-8")
        cut = self.write("cut.txt", good[:len(good) // 2])
        lines = good.count("\n", 0, len(good) // 2) + 1
        self.check_refused("--scene", cut, "--json", "a.json", says=f"{cut}:{lines}: ")
        for name, old, new in (("nan", "POSE 0 0 0 0", "POSE 0 nan 0 0"),
                               ("count", "POSES 3", "POSES 4"), ("points", "POINTS 20", "POINTS 19"),
                               ("index", "3 0 -0.496", "3 7 -0.496"),
                               ("quaternion", "POSE 0 0 0 0 0 0 0 1", "POSE 0 0 0 0 0 0 0 3"),
                               ("empty", good, "")):
            self.assertIn(old, good)
            bad = self.write(name, good.replace(old, new))
            self.check_refused("--scene", bad, "--json", "a.json", says=f"{bad}:")
        self.check_refused("--scene", "missing.txt", says="missing.txt")
        self.check_refused("--scene", ".", says=".")

    def test_numeric_options(self):
        self.check_numeric_options()

    def test_json_to_stdout(self):
        self.check_json_on_stdout("--fix", 2)

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--fix", "--prior-weight", "--method", "--course-stop", "--iterations",
                        "--linear-solver", "--scene", "--verbose", "--json", "gauge")


if __name__ == "__main__":
    main(TestMonoBA)
