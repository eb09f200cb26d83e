#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""vio_run: real recordings of images, faults, what it writes and what it refuses."""

import shutil
import subprocess
import unittest

from app_test_util import FEW_NO_NUMBERS, AppTest, data_folder, main, strict_json, without_sanitizers

KEYS = ("frames", "ate_m", "ate_yaw_deg", "rpe_1s_m", "rpe_percent", "scale_error_percent", "median_ms",
        "p99_ms", "marginalize_median_ms", "keyframes", "rejected", "events", "initialized_at_s", "vision")
# Kind of fault, and what the events must say of it.
FAULTS = {"dropped@5..7": "frame missing", "repeated@5..7": "image repeated",
          "out-of-order@5..6": "frame refused", "black@5..5.3": "image dark",
          "bright@5..5.3": "image bright", "blurred@5..5.3": "image blurred",
          "covered@5..7": "image dark"}


def images(name):
    folder = data_folder()
    return folder / "images" / name if folder and (folder / "images" / name).is_dir() else None


class VioRun(AppTest):
    app = "vio_run"
    numeric_options = {"--start": ("-1",), "--seconds": ("-1",), "--rpe-length": ("0", "-1")}

    def setUp(self):
        super().setUp()
        self.mh05, self.kitti = images("euroc_mh05_cut"), images("kitti_cut1")

    def need(self, folder):
        if folder is None:
            self.skipTest("the recordings of images are not here")
        return folder

    @without_sanitizers
    def test_one_camera_with_an_imu(self):
        result = self.run_json(self.need(self.mh05), "--output", "out.tum", "--save-tracks", "tracks")
        for key in KEYS:
            self.assertIn(key, result)
        self.assertLess(result["initialized_at_s"], 6.0)
        self.assertLess(result["ate_m"], 0.20)
        self.assertLess(abs(result["scale_error_percent"]), 5.0)
        self.assertGreater(result["vision"]["features_mean"], 120.0)
        # A replay of what was tracked is the same flight, to the last digit.
        replay = str(self.folder_of_executables / "vio_replay")
        subprocess.run([replay, "tracks", "--output", "again.tum"], cwd=self.folder, check=True,
                       capture_output=True, timeout=120)
        self.assertEqual((self.folder / "out.tum").read_text(encoding="utf-8"),
                         (self.folder / "again.tum").read_text(encoding="utf-8"))

    @without_sanitizers
    def test_a_stereo_pair_alone(self):
        result = self.run_json(self.need(self.kitti), "--rpe-length", "50")
        self.assertEqual(result["cameras"], 2)
        self.assertFalse(result["imu"])
        self.assertLess(result["rpe_percent"], 1.5)
        self.assertGreater(result["vision"]["stereo_mean"], 80.0)

    @without_sanitizers
    def test_faults_are_named_and_survived(self):
        folder = self.need(self.mh05)
        for fault, event in FAULTS.items():
            with self.subTest(fault):
                result = self.run_json(folder, "--fault", fault, "--start", "1", "--seconds", "9")
                self.assertIn(event, [e["what"] for e in result["vision"]["events"]])
                self.assertLess(result["ate_m"], 0.3)
                self.assertGreater(result["estimates"], 100)

    @without_sanitizers
    def test_lens_cap_at_the_start(self):
        result = self.run_json(self.need(self.mh05), "--fault", "black@0..2", "--seconds", "6")
        self.assertGreater(result["initialized_at_s"], 2.0)
        self.assertEqual(result["vision"]["events"][0]["what"], "image dark")

    def test_nothing_to_be_found_is_said(self):
        result = self.run_app(self.need(self.mh05), "--fault", "black@0..9", "--seconds", "2")
        self.assertEqual(result.returncode, 1)
        self.assertIn("the window found no first state", result.stderr)

    def test_realtime_loses_frames_as_a_camera_does(self):
        # On a busy machine it may lose so many that there is no first state.
        result = self.run_app(self.need(self.mh05), "--realtime", "--seconds", "1.5", "--json", "r.json")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        out = strict_json((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(out["frames"] + out["frames_dropped"], 31)

    def test_config(self):
        text = self.run_ok("--print-config")
        (self.folder / "c.yaml").write_text(text, encoding="utf-8")
        self.assertEqual(self.run_ok("--config", "c.yaml", "--print-config"), text)
        (self.folder / "c.yaml").write_text("tracker:\n  max_features: 60\n", encoding="utf-8")
        self.assertIn("max_features: 60", self.run_ok("--config", "c.yaml", "--print-config"))
        if self.mh05:
            result = self.run_json(self.mh05, "--config", "c.yaml", "--seconds", "1.5")
            self.assertLessEqual(result["vision"]["features_mean"], 60.0)
        for content, words in (("tracker:\n  max_feature: 60\n", "c.yaml:2: there is no key max_feature"),
                               ("trackers:\n  cell_px: 60\n", "c.yaml:1: there is no section"),
                               ("tracker:\n  cell_px: big\n", "c.yaml:2: tracker: cell_px must be"),
                               ("tracker:\n  cell_px: 1e9\n", "c.yaml:2: tracker: cell_px must be"),
                               ("window:\n  policy: best\n", "c.yaml:2: window: policy must be one of"),
                               ("imu: 3\n", "c.yaml:1: imu must hold keys"),
                               ("- a\n", "c.yaml:1: expected sections"),
                               ("a: [\n", "c.yaml:")):
            with self.subTest(content):
                (self.folder / "c.yaml").write_text(content, encoding="utf-8")
                self.assert_refused("--config", "c.yaml", "--print-config", words=words)

    def assert_refused(self, *args, words):
        result = self.run_app(*args)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(words, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)

    def test_numbers(self):
        self.check_numeric_options("nowhere", no_numbers=FEW_NO_NUMBERS)

    def test_what_makes_no_sense_is_refused(self):
        self.assert_refused(words="DIR is required")
        self.assert_refused("nowhere", words="nowhere: is no folder")
        (self.folder / "empty").mkdir()
        self.assert_refused("empty", words="no recording of images")
        self.assert_refused("empty", "--config", "none.yaml", words="none.yaml: cannot be opened")
        for fault in ("black", "black@1", "black@2..1", "colours@1..2"):
            self.assert_refused("empty", "--fault", fault, words="--fault")
        if self.mh05:
            self.assert_refused(self.mh05, "--start", "1000", words="no frames after --start")
        if self.kitti:
            self.assert_refused(self.kitti, "--mono", words="nothing tells the scale")

    def test_an_image_that_is_cut_off_ends_the_run(self):
        folder = self.folder / "flight"
        shutil.copytree(self.need(self.mh05), folder)
        image = sorted((folder / "mav0/cam0/data").iterdir())[5]
        image.chmod(0o644)
        image.write_bytes(image.read_bytes()[:5000])
        result = self.run_app(folder, "--seconds", "1", "--output", "out.tum")
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"{image.name}: the image is cut off", result.stderr)
        image.unlink()
        self.assert_refused(folder, words="data.csv:7: there is no image")


if __name__ == "__main__":
    main(VioRun)
