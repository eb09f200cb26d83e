#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""vio_check: the sample recording, copies of it broken on purpose, real ones, and what it refuses."""

import gzip
import math
import shutil

from app_test_util import HEADER, ROOT, AppTest, data_folder, main, strict_json, without_sanitizers

FINDING = {"kind", "severity", "sensor", "stamp_ns", "count", "sigmas", "estimate", "sigma", "unit",
           "message", "advice"}


class VioCheck(AppTest):
    app = "vio_check"
    numeric_options = {"--max-time-offset": ("-1", "10.1")}

    def broken(self, name, change):
        """A copy of data/flight with a table's rows changed, uncompressed; rows are lists of words."""
        folder = self.folder / "flight"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(ROOT / "data" / "flight", folder)
        path = folder / (name + ".csv.gz")
        text = gzip.decompress(path.read_bytes()).decode()
        rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
        path.unlink()
        (folder / (name + ".csv")).write_text(
            "".join(",".join(row) + "\n" for row in change(rows)), encoding="utf-8")
        return folder

    def check(self, folder, code=0):
        path = self.folder / "result.json"
        result = self.run_app(folder, "--json", path)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        report = strict_json(path.read_text(encoding="utf-8"))
        self.check_header(report)
        self.assertEqual(set(report), HEADER | {"worst", "findings", "facts"})
        lines = result.stdout.splitlines()
        for finding, line in zip(report["findings"], lines):
            self.assertEqual(set(finding), FINDING)
            self.assertIn(finding["kind"], line)
            self.assertIn(finding["advice"], line)
        order = [("error", "warning", "info").index(f["severity"]) for f in report["findings"]]
        self.assertEqual(order, sorted(order))
        self.assertEqual(code == 1, report["worst"] == "error")
        return report

    def serious(self, folder, code=0):
        return {f["kind"]: f for f in self.check(folder, code)["findings"] if f["severity"] != "info"}

    def test_healthy(self):
        report = self.check(ROOT / "data" / "flight")
        self.assertEqual([f for f in report["findings"] if f["severity"] != "info"], [])
        self.assertAlmostEqual(report["facts"]["imu_rate_hz"], 200, delta=1)
        self.check_json_on_stdout(ROOT / "data" / "flight")

    def test_units(self):
        def in_g(rows):
            return [row[:4] + [repr(float(x) / 9.80665) for x in row[4:]] for row in rows]
        found = self.serious(self.broken("imu", in_g), 1)
        self.assertEqual(set(found), {"accel_units"})
        self.assertAlmostEqual(found["accel_units"]["estimate"], 9.81, delta=0.5)

        def in_degrees(rows):
            return [row[:1] + [repr(math.degrees(float(x))) for x in row[1:4]] + row[4:] for row in rows]
        self.assertEqual(set(self.serious(self.broken("imu", in_degrees), 1)), {"gyro_units"})

    def test_what_the_reader_refuses_elsewhere(self):
        """Stamps in disorder and NaN are findings, not files that cannot be read."""
        def swap(rows):
            rows[20][1], rows[21][1] = rows[21][1], rows[20][1]
            return rows
        found = self.serious(self.broken("frames", swap), 1)
        self.assertIn("frame_swapped_stamps", found)

        def nan(rows):
            rows[100][5] = "nan"
            rows[101][2] = "1e999"
            return rows
        found = self.serious(self.broken("imu", nan), 1)
        self.assertEqual(found["imu_not_finite"]["count"], 1)
        self.assertEqual({f["sensor"] for f in self.check(self.folder / "flight", 1)["findings"]
                          if f["kind"] == "imu_not_finite"}, {"gyro", "accel"})

        def camera(rows):
            rows[7][2] = "5"
            return rows
        self.assertEqual(set(self.serious(self.broken("tracks", camera), 1)), {"unknown_camera"})
        folder = self.broken("imu", lambda rows: rows)
        (folder / "imu.csv").unlink()
        self.assertEqual(set(self.serious(folder, 1)), {"no_imu"})

    def test_euroc_folder(self):
        folder = self.folder / "mav0"
        (folder / "imu0").mkdir(parents=True)
        (folder / "cam0").mkdir()
        text = gzip.decompress((ROOT / "data" / "flight" / "imu.csv.gz").read_bytes()).decode()
        rows = text.splitlines()
        gap = rows[:500] + rows[540:]
        (folder / "imu0" / "data.csv").write_text("\n".join(gap) + "\n", encoding="utf-8")
        (folder / "imu0" / "sensor.yaml").write_text(
            "rate_hz: 200\ngyroscope_noise_density: 1.7e-04     # [ rad / s / sqrt(Hz) ]\n"
            "gyroscope_random_walk: 2e-5\naccelerometer_noise_density: 2.0000e-3\n"
            "accelerometer_random_walk: 3e-3\n", encoding="utf-8")
        stamps = [row.split(",")[0] for row in rows if not row.startswith("#")][20:-20:10]
        (folder / "cam0" / "data.csv").write_text(
            "#timestamp [ns],filename\n" + "".join(f"{s},{s}.png\n" for s in stamps), encoding="utf-8")
        for name in (self.folder, folder):
            found = self.serious(name, 1)
            self.assertEqual(set(found), {"imu_gap"})
            self.assertEqual(found["imu_gap"]["stamp_ns"], int(rows[499].split(",")[0]))

    def test_refused(self):
        self.check_refused(self.folder / "nowhere", says="nowhere")
        folder = self.broken("frames", lambda rows: [["x", "y"]])
        self.check_refused(folder, says="frames.csv:1")
        folder = self.broken("tracks", lambda rows: [["77777", "1", "0", "1", "2"]])
        self.check_refused(folder, says="there is no frame 77777")
        self.check_refused(says="DIR")
        self.check_numeric_options(ROOT / "data" / "flight")

    def test_help(self):
        text = self.run_ok("--help")
        for word in ("DIR", "--max-time-offset", "--json", "Examples:", "Exit code:", "sigma", "ERROR",
                     "has to be added to camera stamps"):
            self.assertIn(word, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 100, line)
        self.check_version()

    @without_sanitizers
    def test_recorded(self):
        data = data_folder()
        if data is None or not (data / "vio" / "malaga_parking6L").exists():
            self.skipTest("no folder of recordings")
        found = self.serious(data / "vio" / "malaga_parking6L", 1)
        self.assertAlmostEqual(found["time_offset"]["estimate"], -0.11, delta=0.02)
        self.assertNotIn("no_imu", self.serious(data / "vio" / "kitti_0930_0020"))
        cut = data / "images" / "euroc_mh05_cut"
        if cut.exists():
            self.assertEqual(self.serious(cut), {})


if __name__ == "__main__":
    main(VioCheck)
