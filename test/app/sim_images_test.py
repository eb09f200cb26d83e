#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""sim_images: what it renders is where the truth says it is, looks as its options say, and is read by
the programs that it is for."""

import csv
import gzip
import hashlib
import json
import math
import shutil
import subprocess

from app_test_util import FEW_NO_NUMBERS, ROOT, AppTest, main
from grey_image import GreyImage, correlation, spread

FLIGHT = ROOT / "data" / "flight"
SMALL = ("--size", "320x240", "--start", "2")


def pure(**effects):
    """Nothing between the light and the file but what is named: pure(noise=2)."""
    options = {"noise": 0, "exposure": 0, "gain-drift": 0, "vignette": 0}
    options.update((name.replace("_", "-"), value) for name, value in effects.items())
    return [word for name, value in options.items() for word in (f"--{name}", str(value))]


def table(path):
    with (gzip.open(path, "rt") if path.suffix == ".gz" else open(path, encoding="utf-8")) as file:
        return [row for row in csv.reader(file) if not row[0].startswith("#")]


def yaml_list(text, key):
    """The numbers in brackets behind a key."""
    return [float(x) for x in text.split(key, 1)[1].split("[", 1)[1].split("]", 1)[0].split(",")]


def matrix_of(w, x, y, z):
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def times(R, v):
    return [sum(a * b for a, b in zip(row, v)) for row in R]


def inverse_times(R, v):
    return [sum(R[i][k] * v[i] for i in range(3)) for k in range(3)]


class Camera:
    """Of a sensor.yaml: pinhole with radial-tangential distortion, T_BS."""

    def __init__(self, path):
        text = path.read_text(encoding="utf-8")
        self.fx, self.fy, self.cx, self.cy = yaml_list(text, "intrinsics:")
        self.k1, self.k2, self.p1, self.p2, *more = yaml_list(text, "distortion_coefficients:")
        assert "radial-tangential" in text and not any(more)
        T = yaml_list(text, "data:")
        self.R, self.p = [T[0:3], T[4:7], T[8:11]], [T[3], T[7], T[11]]

    def distort(self, x, y):
        r2 = x * x + y * y
        f = 1 + self.k1 * r2 + self.k2 * r2 * r2
        return (x * f + 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x),
                y * f + self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y)

    def pixel(self, x, y):
        x, y = self.distort(x, y)
        return self.fx * x + self.cx, self.fy * y + self.cy

    def ray(self, u, v):
        xd, yd = (u - self.cx) / self.fx, (v - self.cy) / self.fy
        x, y = xd, yd
        for _ in range(100):
            a, b = self.distort(x, y)
            x, y = x + xd - a, y + yd - b
        return [x, y, 1.0]


class Recording:
    def __init__(self, folder):
        self.mav = folder / "mav0"
        self.cameras = [Camera(p) for p in sorted(self.mav.glob("cam*/sensor.yaml"))]
        self.frames = [table(p) for p in sorted(self.mav.glob("cam*/data.csv"))]
        self.truth = {int(row[0]): [float(x) for x in row[1:]]
                      for row in table(self.mav / "state_groundtruth_estimate0" / "data.csv")}

    def stamps(self):
        return [int(row[0]) for row in self.frames[0]]

    def path(self, camera, k):
        return self.mav / f"cam{camera}" / "data" / self.frames[camera][k][1]

    def image(self, camera, k):
        return GreyImage.read(self.path(camera, k))

    def pose(self, camera, k):
        """R_W_C, p_W_C"""
        state = self.truth[self.stamps()[k]]
        R, c = matrix_of(*state[3:7]), self.cameras[camera]
        columns = [times(R, [c.R[i][j] for i in range(3)]) for j in range(3)]
        return ([[columns[j][i] for j in range(3)] for i in range(3)],
                [a + b for a, b in zip(state[0:3], times(R, c.p))])

    def digest(self):
        return [hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(self.mav.rglob("*.*"))]


class SimImagesTest(AppTest):
    app = "sim_images"
    numeric_options = {
        "--length": ("0",), "--speed": ("0", "-1"), "--start": ("-1",), "--seconds": ("0", "-1"),
        "--rate": ("0", "1e9"), "--focal": ("0",), "--noise": ("-1",), "--exposure": ("-1", "2000"),
        "--blur-samples": ("0", "1.5"), "--gain-drift": ("-1",), "--vignette": ("-0.1", "1.1"),
        "--jpeg-quality": ("0", "101"), "--walls": ("0",), "--floor": ("0",), "--boxes": ("-1", "1.5"),
        "--texture-width": ("0",), "--seed": ("-1", "1.5"), "--track-noise": ("-1",),
        "--track-age": ("0",)}

    def render(self, name, *args, seconds=1):
        """A stretch of data/flight."""
        self.run_ok(name, "--along", FLIGHT, *SMALL, "--seconds", seconds, *args)
        return Recording(self.folder / name)

    def test_help_and_version(self):
        text = self.run_ok("--help")
        for word in ("Examples:", "Exit code:", "130", "--along", "--spline", "--json", "equidistant"):
            self.assertIn(word, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 104, line)
        self.check_version()

    def test_layout(self):
        result = self.run_json("r", "--along", FLIGHT, *SMALL, "--seconds", "1")
        r = Recording(self.folder / "r")
        self.assertEqual([result["frames"], result["cameras"], result["images"]], [20, 2, 40])
        stamps = r.stamps()
        self.assertEqual([b - a for a, b in zip(stamps, stamps[1:])], [50_000_000] * 19)
        for camera in (0, 1):
            self.assertEqual([int(row[0]) for row in r.frames[camera]], stamps)
            self.assertEqual(sorted(p.name for p in (r.mav / f"cam{camera}" / "data").iterdir()),
                             sorted(f"{t}.png" for t in stamps))
            self.assertEqual((r.image(camera, 0).width, r.image(camera, 0).height), (320, 240))
        # Truth: at the frames; where the recording has a state of the same stamp, that one.
        self.assertEqual(sorted(r.truth), stamps)
        given = {int(row[0]): [float(x) for x in row[1:]]
                 for row in table(FLIGHT / "groundtruth.csv.gz")}
        same = sorted(set(given) & set(stamps))
        self.assertGreaterEqual(len(same), 10)
        for t in same:
            sign = math.copysign(1, sum(a * b for a, b in zip(given[t][3:7], r.truth[t][3:7])))
            expected = given[t][:3] + [sign * x for x in given[t][3:7]] + given[t][7:]
            for a, b in zip(r.truth[t], expected):
                self.assertAlmostEqual(a, b, delta=1e-7)
        # The IMU: the recording's own readings, from before the first frame to after the last.
        imu = {int(row[0]): row[1:] for row in table(r.mav / "imu0" / "data.csv")}
        self.assertTrue(min(imu) <= stamps[0] and max(imu) >= stamps[-1] and len(imu) < 230)
        for row in table(FLIGHT / "imu.csv.gz"):
            if int(row[0]) in imu:
                self.assertEqual([float(x) for x in row[1:]], [float(x) for x in imu.pop(int(row[0]))])
        self.assertEqual(imu, {})

    def test_its_own_recording_can_be_flown_along(self):
        """So the files are what the reader takes; and the same flight gives the same images."""
        a = self.render("a", "--mono", *pure(), "--boxes", "0")
        self.run_ok("b", "--along", "a", *pure(), "--boxes", "0")
        b = Recording(self.folder / "b")
        self.assertEqual(a.stamps(), b.stamps())
        self.assertEqual(a.path(0, 7).read_bytes(), b.path(0, 7).read_bytes())

    def test_a_place_is_seen_where_the_truth_says(self):
        """By a second implementation of camera and room: patches look alike at the predicted pixel,
        and less so 3 px away."""
        result = self.run_json("g", "--along", FLIGHT, *SMALL, "--seconds", "1", *pure(), "--boxes", "0")
        low, high = result["room"]["low_m"], result["room"]["high_m"]
        r = Recording(self.folder / "g")
        for (c0, k0), (c1, k1) in (((0, 2), (1, 2)), ((0, 2), (0, 5)), ((0, 10), (1, 13))):
            a, b = r.image(c0, k0), r.image(c1, k1)
            (Ra, pa), (Rb, pb) = r.pose(c0, k0), r.pose(c1, k1)
            here, away = [], []
            for v in range(20, 220, 20):
                for u in range(20, 300, 20):
                    patch = a.patch(u, v, 5)
                    if patch is None or spread(patch) < 8:
                        continue
                    d = times(Ra, r.cameras[c0].ray(u, v))
                    t = min(((high if x > 0 else low)[i] - pa[i]) / x for i, x in enumerate(d))
                    q = inverse_times(Rb, [pa[i] + t * d[i] - pb[i] for i in range(3)])
                    x, y = r.cameras[c1].pixel(q[0] / q[2], q[1] / q[2])
                    patches = [b.patch(x + i, y + j, 5)
                               for i, j in ((0, 0), (3, 0), (-3, 0), (0, 3), (0, -3))]
                    if q[2] < 0.1 or None in patches:
                        continue
                    here.append(correlation(patch, patches[0]))
                    away.append(max(correlation(patch, p) for p in patches[1:]))
            self.assertGreater(len(here), 40)
            alike = sum(x > 0.9 for x in here) / len(here)
            self.assertGreater(alike, 0.9, (c1, k1))
            self.assertGreater(sum(x > y for x, y in zip(here, away)) / len(here), 0.97, (c1, k1))
            self.assertGreater(sum(here) / len(here), sum(away) / len(away) + 0.2, (c1, k1))

    def test_between_sparse_poses_the_imu_says_how(self):
        """Every fifth true pose left: at those left out, half a second apart, the flight is the same."""
        shutil.copytree(FLIGHT, self.folder / "sparse")
        rows = table(FLIGHT / "groundtruth.csv.gz")
        path = self.folder / "sparse" / "groundtruth.csv.gz"
        path.chmod(0o644)
        with gzip.open(path, "wt") as file:
            file.write("\n".join(",".join(row) for row in rows[::5]) + "\n")
        self.run_ok("r", "--along", "sparse", *SMALL, "--seconds", "3", "--rate", "10", "--mono")
        truth = Recording(self.folder / "r").truth
        left_out = [row for k, row in enumerate(rows) if k % 5 and int(row[0]) in truth]
        self.assertGreater(len(left_out), 20)
        for row in left_out:
            expected, got = [float(x) for x in row[1:]], truth[int(row[0])]
            self.assertLess(math.dist(got[0:3], expected[0:3]), 0.002)
            self.assertGreater(abs(sum(a * b for a, b in zip(got[3:7], expected[3:7]))),
                               math.cos(0.5 * 0.001))
            self.assertLess(math.dist(got[7:10], expected[7:10]), 0.02)

    def test_the_same_options_give_the_same_bytes(self):
        digests = [self.render(name, "--seed", seed, "--auto-exposure", seconds=0.2).digest()
                   for name, seed in (("a", 7), ("b", 7), ("c", 8))]
        self.assertEqual(digests[0], digests[1])
        self.assertNotEqual(digests[0], digests[2])

    def test_noise(self):
        clean = self.render("p", "--mono", *pure(), seconds=0.1).image(0, 0)
        for sigma in (2, 6):
            noisy = self.render(f"n{sigma}", "--mono", *pure(noise=sigma), seconds=0.1)
            difference = [b - a for ra, rb in zip(clean.rows, noisy.image(0, 0).rows)
                          for a, b in zip(ra, rb) if 30 < a < 225]
            self.assertGreater(len(difference), 50000)
            # Rounding is uniform noise.
            self.assertAlmostEqual(spread(difference), math.hypot(sigma, 0.41), delta=0.03 * sigma)
            self.assertAlmostEqual(sum(difference) / len(difference), 0.0, delta=0.1)
            one, other = noisy.image(0, 0), noisy.image(0, 1)
            self.assertNotEqual(one.rows, other.rows)

    def test_blur_gain_and_vignette(self):
        sharp = self.render("s", "--mono", *pure())
        blurred = self.render("b", "--mono", *pure(exposure=80))
        self.assertLess(blurred.image(0, 5).gradient(), 0.75 * sharp.image(0, 5).gradient())
        self.assertAlmostEqual(blurred.image(0, 5).mean(), sharp.image(0, 5).mean(), delta=1.5)

        drift = self.render("d", "--mono", *pure(gain_drift=0.6), seconds=4)
        steady = self.render("t", "--mono", *pure(), seconds=4)
        gains = [drift.image(0, k).mean() / steady.image(0, k).mean() for k in range(0, 80, 8)]
        self.assertGreater(max(gains) / min(gains), 1.3)
        self.assertTrue(math.exp(-0.61) < min(gains) and max(gains) < math.exp(0.61), gains)
        self.assertLess(max(abs(math.log(b / a)) for a, b in zip(gains, gains[1:])), 0.25)

        dark = self.render("v", "--mono", *pure(vignette=0.5)).image(0, 0)
        bright = sharp.image(0, 0)
        for x, y, part in ((160, 120, 1.0), (4, 4, 0.53), (160, 4, 0.83)):
            patches = [sum(image.patch(x, y, 3)) for image in (dark, bright)]
            self.assertAlmostEqual(patches[0] / patches[1], part, delta=0.03)

    def test_auto_exposure(self):
        """A dark wall: steps towards a mean of 100."""
        GreyImage([[40] * 16] * 16).write(self.folder / "dark.png")
        r = self.render("a", "--mono", *pure(), "--texture", "dark.png", "--auto-exposure", seconds=2)
        means = [r.image(0, k).mean() for k in (0, 20, 39)]
        self.assertLess(means[0], 45)
        self.assertTrue(50 < means[1] < means[2] and 80 < means[2] < 110, means)

    def test_textures_and_formats(self):
        GreyImage([[200 if (x // 8 + y // 8) % 2 else 60 for x in range(64)] for y in range(48)]).write(
            self.folder / "checker.png")
        r = self.render("c", "--mono", *pure(), "--texture", "checker.png", "--texture-width", "1",
                        "--format", "jpg", "--jpeg-quality", "90", seconds=0.1)
        self.assertEqual(r.path(0, 0).suffix, ".jpg")
        self.assertEqual(r.path(0, 0).read_bytes()[:2], b"\xff\xd8")
        plain = self.render("d", "--mono", *pure(), "--texture", "checker.png", seconds=0.1)
        values = [v for row in plain.image(0, 0).rows for v in row]
        self.assertTrue(min(values) > 30 and max(values) < 255 and spread(values) > 30)

    def test_simulated_flight_and_perfect_tracks(self):
        """What vio_replay makes of the tracks says that truth, IMU and cameras belong together."""
        self.run_ok("r", "--spline", "rec", "--seconds", "12", "--rate", "10", "--size", "320x240",
                    "--save-tracks", "t")
        done = subprocess.run([self.folder_of_executables / "vio_replay", "t", "--json", "-"],
                              cwd=self.folder, capture_output=True, text=True, check=True)
        result = json.loads(done.stdout)
        self.assertEqual(result["frames"], 120)
        self.assertLess(result["ate_m"], 0.05)
        self.assertEqual(len(Recording(self.folder / "r").stamps()), 120)

    def test_perfect_tracks_lie_on_the_images(self):
        """With boxes: a track looks the same in the next frame and in the other camera."""
        r = self.render("r", *pure(), "--save-tracks", "t", "--track-noise", "0", seconds=0.5)
        calibration = json.loads((self.folder / "t" / "calibration.json").read_text(encoding="utf-8"))
        seen = {}
        for frame, track, camera, u, v in table(self.folder / "t" / "tracks.csv.gz"):
            c = calibration["cameras"][int(camera)]
            seen[int(track), int(frame), int(camera)] = r.cameras[int(camera)].pixel(
                (float(u) - c["cx"]) / c["fx"], (float(v) - c["cy"]) / c["fy"])
        images = {key: r.image(*key) for key in ((0, 1), (0, 2), (1, 1))}
        for frame, camera in ((2, 0), (1, 1)):
            alike = []
            for (track, k, c), place in seen.items():
                other = seen.get((track, frame, camera))
                patch = images[0, 1].patch(*place, 4) if (k, c) == (1, 0) else None
                there = images[camera, frame].patch(*other, 4) if patch and other else None
                if there and spread(patch) > 8:
                    alike.append(correlation(patch, there))
            self.assertGreater(len(alike), 15)
            # Some lie on the edge of a box, with different things behind.
            self.assertGreater(sum(x > 0.9 for x in alike) / len(alike), 0.8)

    def test_equidistant_lens(self):
        self.run_ok("r", "--spline", "sine", "--seconds", "0.2", "--lens", "equidistant", "--focal", "120",
                    "--size", "320x320", *pure())
        text = (self.folder / "r" / "mav0" / "cam1" / "sensor.yaml").read_text(encoding="utf-8")
        self.assertIn("equidistant", text)
        self.assertEqual(yaml_list(text, "intrinsics:")[0:2], [120.0, 120.0])
        image = GreyImage.read(next((self.folder / "r" / "mav0" / "cam0" / "data").iterdir()))
        # 160 px of 120 a radian: there is no ray of less than 90 degrees in the corners.
        self.assertEqual((image.rows[2][2], image.rows[2][317]), (0, 0))
        self.assertLess(sum(grey == 0 for grey in image.rows[160]), 10)

    def test_the_room_is_level(self):
        """Gravity along x: x becomes the room's vertical."""
        shutil.copytree(FLIGHT, self.folder / "tilted")
        path = self.folder / "tilted" / "calibration.json"
        path.chmod(0o644)
        calibration = json.loads(path.read_text(encoding="utf-8"))
        calibration["gravity"] = [-9.81, 0, 0]
        path.write_text(json.dumps(calibration), encoding="utf-8")
        result = self.run_json("r", "--along", "tilted", *SMALL, "--seconds", "0.1", "--mono",
                               "--walls", "5", "--floor", "1")
        R = result["R_room_world"]
        self.assertAlmostEqual(R[2][0], 1.0)
        size = [b - a for a, b in zip(result["room"]["low_m"], result["room"]["high_m"])]
        self.assertTrue(10 <= min(size[:2]) and 2 <= size[2] < 2.5, size)

    def test_interrupt(self):
        _, result = self.check_interrupt("r", "--along", FLIGHT, "--size", "1500x1000", after=None)
        self.assertTrue(0 < result["frames"] < 200)
        r = Recording(self.folder / "r")
        self.assertEqual(len(r.stamps()), result["frames"])
        self.assertEqual(sorted(r.truth), r.stamps())
        self.assertEqual(len(list((r.mav / "cam0" / "data").iterdir())), result["frames"])

    def test_refusals(self):
        self.check_refused("--along", FLIGHT, says="FOLDER")
        self.check_refused("r", says="--along")
        self.check_refused("r", "--along", FLIGHT, "--spline", "arc", says="--along")
        self.check_refused("r", "--along", "nowhere", says="nowhere")
        self.check_refused("r", "--spline", "loop", says="--spline")
        self.check_refused("no/r", "--along", FLIGHT, says="no/r")
        self.check_refused("r", "--along", FLIGHT, "--start", "100", says="--start")
        self.check_refused("r", "--along", FLIGHT, "--texture", "none.png", says="none.png")
        self.check_refused("r", "--along", FLIGHT, "--lens", "fisheye", says="--lens")
        self.check_refused("r", "--along", FLIGHT, "--format", "tiff", says="--format")
        for size in ("640", "640x", "x480", "640x480x3", "1.5x480", "8x8", "99999x480", ""):
            self.check_refused("r", "--along", FLIGHT, f"--size={size}", says="--size")
        (self.folder / "old" / "mav0").mkdir(parents=True)
        self.check_refused("old", "--along", FLIGHT, says="already")
        self.check_numeric_options("r", "--along", FLIGHT, no_numbers=FEW_NO_NUMBERS)

    def test_a_folder_without_truth(self):
        shutil.copytree(FLIGHT, self.folder / "blind")
        (self.folder / "blind").chmod(0o755)
        (self.folder / "blind" / "groundtruth.csv.gz").unlink()
        self.check_refused("r", "--along", "blind", says="ground truth")

    def test_what_cannot_be_written(self):
        self.write("file", "")
        result = self.run_app("file", "--along", FLIGHT, *SMALL, "--seconds", "0.1")
        self.assertEqual(result.returncode, 1)
        self.assertIn("file", result.stderr)


if __name__ == "__main__":
    main(SimImagesTest)
