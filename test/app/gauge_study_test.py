#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""gauge_study: agreement of the gauges, shape of the sweep, covariances, files, refusals."""

import csv
import subprocess
import sys

from app_test_util import ROOT, AppTest, data_folder, drawing, main, without_sanitizers

WEIGHTS = [0, 3, 7, 10, 50, 100, 300, 500, 1e3, 5e3, 1e5, 5e6, 1e8]
METHODS = ("fixed", "free", "prior")


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k != "time_ms"}
    if isinstance(value, list):
        return [without_times(v) for v in value]
    return value


class GaugeStudy(AppTest):
    app = "gauge_study"
    numeric_options = {"--trials": ("0", "-1", "x"), "--seed": ("-1", "4294967296"),
                       "--jobs": ("0", "-1"), "--vio-start": ("-1", "1e10"),
                       "--vio-keyframes": ("1", "-1")}

    def check_configuration(self, row):
        fixed, free, prior = (row["methods"][m] for m in METHODS)
        for key in ("p_m", "phi_deg", "v_mps"):
            self.assertGreater(fixed[key], 0)
            self.assertLess(abs(free[key] / fixed[key] - 1), 0.012, (row, key))
            self.assertLess(abs(prior[key] / fixed[key] - 1), 0.012, (row, key))
        self.assertLessEqual(free["iterations"], fixed["iterations"])
        for method in ("free", "prior"):
            self.check_agreement(row["converged"][method])

    def check_agreement(self, agreement):
        self.assertLess(agreement["cost_relative"], 1e-10)
        for key in ("position_m", "rotation_rad", "velocity_mps"):
            self.assertLess(agreement[key], 1e-6)

    @without_sanitizers
    def test_study(self):
        study = self.run_json("--trials", 8, timeout=900)
        self.assertEqual([(c["trajectory"], c["points"]) for c in study["configurations"]],
                         [(t, p) for t in ("sine", "arc", "rec") for p in ("plane", "random")])
        for row in study["configurations"]:
            self.check_configuration(row)
        self.assertEqual([w["weight"] for w in study["weights"]], WEIGHTS)
        iterations = {w["weight"]: w["iterations"] for w in study["weights"]}
        for row in study["weights"]:
            self.check_agreement(row["converged"])
        # The peak of the paper's Fig. 5: light priors crawl, none and heavy ones do not.
        peak = max(iterations[w] for w in (3, 7, 10))
        self.assertGreaterEqual(peak, 2 * iterations[0])
        self.assertGreaterEqual(peak, 1.8 * iterations[1e5])
        self.assertLessEqual(max(iterations[w] for w in (1e5, 5e6, 1e8)),
                             min(iterations[w] for w in (1e5, 5e6, 1e8)) + 1)
        # Without the damping that holds the gauge there is none.
        light = [w["light_damping"]["iterations"] for w in study["weights"]]
        self.assertLessEqual(max(light), min(light) + 2)
        self.assertEqual(study["covariance"]["keyframes"], 10)
        self.assertLess(study["covariance"]["relative_error"], 1e-6)
        self.assertEqual(len(study["covariance"]["log10_fixed"]), 90)
        for path in study["paths"]:
            self.assertEqual(path["steps"][0]["prior_position_m"], 0)
            self.assertGreater(path["steps"][0]["reprojection_px"], 10)
            self.assertLess(path["steps"][-1]["reprojection_px"], 4)

    @without_sanitizers
    def test_same_seed_same_numbers(self):
        once = self.run_json("--trials", 2, "--seed", 5, "--jobs", 2, timeout=900)
        self.assertEqual(without_times(once),
                         without_times(self.run_json("--trials", 2, "--seed", 5, "--jobs", 1,
                                                     timeout=900)))
        other = self.run_json("--trials", 1, "--seed", 6, timeout=900)
        self.assertNotEqual(once["configurations"][0]["methods"]["fixed"]["p_m"],
                            other["configurations"][0]["methods"]["fixed"]["p_m"])

    def test_own_recording(self):
        study = self.run_json("--trials", 1, "--vio", ROOT / "data" / "flight", "--vio-start", 1,
                              timeout=900)
        (row,) = study["real"]
        self.assertEqual(row["dataset"], "flight")
        self.check_configuration(row)
        covariance = row["covariance"]
        self.assertEqual(covariance["keyframes"], 30)
        self.assertLess(covariance["relative_error"], 1e-6)
        # The anchor's position is held: no variance, no difference as a part of it.
        self.assertIsNone(covariance["log10_difference"][0][0])
        self.assertLess(covariance["log10_difference"][-1][-1], -6)

    @without_sanitizers
    def test_recordings(self):
        data = data_folder()
        names = ("euroc_v101_semi", "euroc_mh05_semi")
        if data is None or not all((data / "vio" / name).is_dir() for name in names):
            self.skipTest("no recordings")
        args = [a for name in names for a in ("--vio", data / "vio" / name)]
        study = self.run_json("--trials", 1, *args, timeout=900)
        self.assertEqual([r["dataset"] for r in study["real"]], list(names))
        for row in study["real"]:
            self.check_configuration(row)
            self.assertEqual(row["covariance"]["keyframes"], 30)
            self.assertLess(row["covariance"]["relative_error"], 1e-6)

    def test_csv_and_figures(self):
        out = self.run_ok("--trials", 2, "--csv", "a.csv", "--json", "a.json", timeout=900)
        self.assertIn("sine plane", out)
        with open(self.folder / "a.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * (6 * 3 + len(WEIGHTS)))
        self.assertEqual(rows[0]["set"], "sine plane")
        self.assertGreater(float(rows[0]["cost"]), 0)
        environment = drawing()
        if environment is None:
            self.skipTest("needs the Python package with matplotlib")
        subprocess.run([sys.executable, str(ROOT / "scripts" / "plot_gauge_study.py"), "a.json",
                        "images"], cwd=self.folder, env=environment, check=True, timeout=300)
        names = sorted(p.name for p in (self.folder / "images").iterdir())
        self.assertEqual(names, sorted(f"gauge_study_{n}.png" for n in (
            "accuracy", "iterations", "path", "methods", "covariance", "ellipses")))

    def test_refuses(self):
        for args, says in ((("--sweep", "square-plane"), "--sweep"),
                           (("--vio", "no/such/folder"), "no/such/folder"),
                           (("--linear-solver", "qr"), "--linear-solver"),
                           (("--json", "no/such/a.json"), "--json"), (("extra",), "extra"),
                           (("--json", "same", "--csv", "same"), "same")):
            self.check_refused(*args, says=says)

    def test_numeric_options(self):
        self.check_numeric_options()

    def test_segment_behind_the_end_of_the_recording(self):
        for start in ("1e9", "9.3e8", "100000"):
            self.check_refused("--vio", ROOT / "data" / "flight", "--vio-start", start,
                               says="after the first frame, not at")

    def test_interrupted_study(self):
        _, result = self.check_interrupt("--trials", 100000, "--csv", "a.csv", after=None)
        self.assertEqual(result["trials"], 100000)
        self.assertLess(len(result["configurations"]), 6)
        self.assertTrue((self.folder / "a.csv").exists())

    def test_json_to_stdout(self):
        self.check_json_on_stdout("--trials", 1)

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--jobs", "--trials", "--seed", "--vio", "--json", "--csv", "alignment")


if __name__ == "__main__":
    main(GaugeStudy)
