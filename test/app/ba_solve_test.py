#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""ba_solve: small and published BAL files, its options, its JSON, and what it refuses."""

import bz2
import gzip
import math
import random
import resource
import struct
import subprocess

from app_test_util import HEADER, ROOT, AppTest, data_folder, main, strict_json, without_sanitizers

KEYS = HEADER | {"cameras", "points", "observations", "initial_cost", "final_cost", "iterations", "status",
        "time_ms", "peak_rss_mb", "method", "linear_solver", "reduced_solver", "threads"}


def rotate(w, x):
    """Rodrigues' formula."""
    angle = math.sqrt(sum(a * a for a in w))
    if angle == 0.0:
        return list(x)
    k = [a / angle for a in w]
    c, s = math.cos(angle), math.sin(angle)
    cross = [k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0]]
    dot = sum(a * b for a, b in zip(k, x))
    return [x[i] * c + cross[i] * s + k[i] * dot * (1 - c) for i in range(3)]


def project(camera, x):
    p = [a + t for a, t in zip(rotate(camera[:3], x), camera[3:6])]
    u, v = -p[0] / p[2], -p[1] / p[2]
    n = u * u + v * v
    scale = camera[6] * (1 + camera[7] * n + camera[8] * n * n)
    return scale * u, scale * v


def make_bal(num_cameras=5, num_points=60, noise=0.5, seed=3):
    """The text of a BAL problem, started off its optimum, and its residual sum of squares."""
    rng = random.Random(seed)
    cameras = [[rng.gauss(0, 0.05), rng.gauss(0, 0.05), rng.gauss(0, 0.05), 2.0 * k - num_cameras,
                rng.gauss(0, 0.3), -12.0, 500.0, -0.02, 0.001] for k in range(num_cameras)]
    points = [[rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-3, 3)]
              for _ in range(num_points)]
    lines = []
    for i, point in enumerate(points):
        for k, camera in enumerate(cameras):
            u, v = project(camera, point)
            lines.append((k, i, u + rng.gauss(0, noise), v + rng.gauss(0, noise)))
    for camera in cameras:
        for i in range(6):
            camera[i] += rng.gauss(0, 0.02)
    for point in points:
        for i in range(3):
            point[i] += rng.gauss(0, 0.1)
    cost = 0.0
    for k, i, u, v in lines:
        p = project(cameras[k], points[i])
        cost += 0.5 * ((p[0] - u) ** 2 + (p[1] - v) ** 2)
    text = f"{num_cameras} {num_points} {len(lines)}\n"
    text += "".join(f"{k} {i} {u:.17g} {v:+.17e}\n" for k, i, u, v in lines)
    text += "".join(f"{x:.17g}\n" for block in cameras + points for x in block)
    return text, cost


def multiply(p, q):
    """Hamilton product, x y z w."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return [pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz]


def turn(q, x):
    conjugate = [-q[0], -q[1], -q[2], q[3]]
    return multiply(multiply(q, [*x, 0.0]), conjugate)[:3]


def compose(a, b):
    """T_a_b T_b_c, each position and quaternion."""
    p = turn(a[3:], b[:3])
    q = multiply(a[3:], b[3:])
    n = math.sqrt(sum(x * x for x in q))
    return [a[i] + p[i] for i in range(3)] + [x / n for x in q]


def inverse(a):
    q = [-a[3], -a[4], -a[5], a[6]]
    return [-x for x in turn(q, a[:3])] + q


def make_g2o(poses=30, turns=3, seed=4, sigma_t=0.02, sigma_r=0.01):
    """A pose graph, turns around a circle with closures between them and a few landmarks, started from its
    odometry; and g2o's chi2 of the text of such a graph. sigma_r is that of half the angle."""
    rng = random.Random(seed)
    truth = []
    for k in range(poses):
        a = 2 * math.pi * turns * k / poses
        truth.append([4 * math.cos(a), 4 * math.sin(a), 0.02 * k, 0.0, 0.0, math.sin(a / 2), math.cos(a / 2)])
    wt, wr = sigma_t ** -2, sigma_r ** -2
    information = [x for r in range(6) for x in [wt if r < 3 else wr] + [0.0] * (5 - r)]

    def measure(i, j):
        v = [rng.gauss(0, sigma_r) for _ in range(3)]
        noise = [rng.gauss(0, sigma_t) for _ in range(3)] + v + [math.sqrt(1 - sum(x * x for x in v))]
        return compose(compose(inverse(truth[i]), truth[j]), noise)

    edges = [(k - 1, k, measure(k - 1, k)) for k in range(1, poses)]
    vertices = [truth[0]]
    for _, _, z in edges:
        vertices.append(compose(vertices[-1], z))
    around = poses // turns
    edges += [(k - around, k, measure(k - around, k)) for k in range(around, poses)]
    number = "{:.9g}".format
    lines = ["# made by the test", "PARAMS_SE3OFFSET 0 0 0 0.1 0 0 0 1"]
    lines += [f"VERTEX_SE3:QUAT {k} " + " ".join(map(number, x)) for k, x in enumerate(vertices)]
    lines += [f"EDGE_SE3:QUAT {i} {j} " + " ".join(map(number, z + information)) for i, j, z in edges]
    for n in range(4):
        x = [rng.uniform(-5, 5) for _ in range(3)]
        lines.append(f"VERTEX_TRACKXYZ {1000 + n} " + " ".join(map(number, x)))
        for k in range(n, poses, 5):
            sensor = compose(truth[k], [0, 0, 0.1, 0, 0, 0, 1])
            seen = [a + rng.gauss(0, 0.05) for a in compose(inverse(sensor), [*x, 0, 0, 0, 1])[:3]]
            lines.append(f"EDGE_SE3_TRACKXYZ {k} {1000 + n} 0 " + " ".join(map(number, seen + [400, 0, 0, 400, 0, 400])))
    return "\n".join(lines) + "\n"


def g2o_chi2(text):
    """By g2o's formulas: [translation, vector part of the quaternion] of Z^-1 Xi^-1 Xj, and in the sensor."""
    vertices, offsets, chi2 = {}, {}, 0.0
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    for tag, *words in rows:
        if tag == "VERTEX_SE3:QUAT" or tag == "PARAMS_SE3OFFSET":
            x = [float(w) for w in words[1:]]
            n = math.sqrt(sum(a * a for a in x[3:]))
            (vertices if tag.startswith("V") else offsets)[words[0]] = x[:3] + [a / n for a in x[3:]]
        elif tag == "VERTEX_TRACKXYZ":
            vertices[words[0]] = [float(w) for w in words[1:]]
    for tag, *words in rows:
        x = [float(w) for w in words]
        if tag == "EDGE_SE3:QUAT":
            delta = compose(inverse(x[2:9]), compose(inverse(vertices[words[0]]), vertices[words[1]]))
            e, information = [*delta[:3], *(math.copysign(1, delta[6]) * a for a in delta[3:6])], x[9:]
        elif tag == "EDGE_SE3_TRACKXYZ":
            sensor = compose(vertices[words[0]], offsets[words[2]])
            p = compose(inverse(sensor), vertices[words[1]] + [0, 0, 0, 1])
            e, information = [p[i] - x[3 + i] for i in range(3)], x[6:]
        else:
            continue
        upper = iter(information)
        chi2 += sum(next(upper) * e[r] * e[c] * (1 if r == c else 2)
                    for r in range(len(e)) for c in range(r, len(e)))
    return chi2


class BaSolve(AppTest):
    app = "ba_solve"
    numeric_options = {"--iterations": ("-1", "1.5", "1000001", "1e3"),
                       "--threads": ("0", "-1", "1025", "1e9", "2.0"),
                       "--tolerance": ("-1e-9", "-1", "1"), "--forcing": ("-1e-9", "-1", "1"),
                       "--city": ("0", "19", "20001", "-200", "200.0"), "--seed": ("-1", "4294967296")}

    def check_schema(self, result, *more):
        self.assertEqual(set(result), KEYS | set(more))
        for key in ("initial_cost", "final_cost", "time_ms", "peak_rss_mb"):
            self.assertIsInstance(result[key], float)
        for key in ("cameras", "points", "observations", "iterations", "threads"):
            self.assertIsInstance(result[key], int)
        self.assertGreater(result["peak_rss_mb"], 1.0)
        self.assertGreater(result["time_ms"], 0.0)

    def test_small_problem_in_every_compression(self):
        text, cost = make_bal()
        plain = self.write("a.txt", text)
        (self.folder / "a.txt.gz").write_bytes(gzip.compress(text.encode()))
        (self.folder / "a.txt.bz2").write_bytes(bz2.compress(text.encode()))
        finals = set()
        for path in (plain, "a.txt.gz", "a.txt.bz2"):
            result = self.run_json(path)
            self.check_schema(result)
            self.assertEqual([result[k] for k in ("cameras", "points", "observations")], [5, 60, 300])
            self.assertAlmostEqual(result["initial_cost"] / cost, 1.0, places=9)
            # 600 residuals, less the degrees of freedom, of sigma 0.5.
            self.assertLess(result["final_cost"], 0.5 * 600 * 0.25)
            self.assertTrue(result["status"].startswith("converged"), result["status"])
            finals.add(result["final_cost"])
        self.assertEqual(len(finals), 1)

    def test_options_lead_to_the_same_optimum(self):
        path = self.write("a.txt", make_bal()[0])
        best = self.run_json(path, "--tolerance", "1e-12")["final_cost"]
        for args in (("--method", "nielsen"), ("--method", "dogleg"), ("--threads", 4)):
            result = self.run_json(path, "--tolerance", "1e-12", *args)
            self.assertAlmostEqual(result["final_cost"] / best, 1.0, places=8, msg=args)
        self.check_linear_solvers(path, "--tolerance", "1e-12", cost=lambda r: r["final_cost"])
        self.assertEqual(self.run_json(path, "--threads", 2)["threads"], 2)

    def test_threads_do_not_change_a_bit(self):
        path = self.write("a.txt", make_bal()[0])
        for threads in (1, 2, 4):
            self.run_ok(path, "--iterations", 4, "--threads", threads, "--output", f"{threads}.txt")
        solutions = {(self.folder / f"{n}.txt").read_bytes() for n in (1, 2, 4)}
        self.assertEqual(len(solutions), 1)

    def test_losses(self):
        path = self.write("a.txt", make_bal()[0])
        costs = {loss: self.run_json(path, "--loss", loss)["final_cost"]
                 for loss in ("none", "huber:0.5", "cauchy:0.5", "tukey:0.5", "huber", "huber:1")}
        self.assertEqual(costs.pop("huber"), costs["huber:1"])
        self.assertEqual(len(set(costs.values())), 5)
        for loss, cost in costs.items():
            if loss != "none":
                self.assertLess(cost, costs["none"])

    def test_tolerance_and_iterations(self):
        path = self.write("a.txt", make_bal()[0])
        off = self.run_json(path, "--tolerance", 0, "--iterations", 7)
        self.assertEqual((off["iterations"], off["status"]), (7, "iteration limit"))
        loose = self.run_json(path, "--tolerance", 0.5)
        self.assertLess(loose["iterations"], off["iterations"])
        self.assertEqual(self.run_json(path, "--iterations", 0)["iterations"], 0)

    def test_output_goes_on_where_the_solve_ended(self):
        path = self.write("a.txt", make_bal()[0])
        for name in ("out.txt", "out.txt.gz", "out.txt.bz2"):
            result = self.run_json(path, "--output", name)
            again = self.run_json(name, "--iterations", 0)
            self.assertEqual(again["initial_cost"], result["final_cost"])
        head = (self.folder / "out.txt").read_text(encoding="utf-8").split("\n", 1)[0]
        self.assertEqual(head, "5 60 300")
        self.assertEqual((self.folder / "out.txt.gz").read_bytes()[:2], b"\x1f\x8b")
        self.assertEqual((self.folder / "out.txt.bz2").read_bytes()[:3], b"BZh")

    def test_city(self):
        result = self.run_json("--city", 60, "--seed", 3)
        self.check_schema(result)
        self.assertEqual(result["file"], "city of 60 cameras, seed 3")
        self.assertEqual(result["cameras"], 60)
        # Down to the noise: 0.5 px.
        dof = 2 * result["observations"] - 9 * 60 - 3 * result["points"] + 7
        self.assertAlmostEqual(result["final_cost"] / (0.125 * dof), 1, delta=5 * math.sqrt(2 / dof))
        self.assertGreater(result["initial_cost"], 20 * result["final_cost"])
        self.assertEqual(self.run_json("--city", 60, "--seed", 3)["final_cost"], result["final_cost"])
        self.assertNotEqual(self.run_json("--city", 60)["final_cost"], result["final_cost"])
        out = self.run_ok("--city", 60, "--iterations", 0)
        self.assertRegex(out, r"^city of 60 cameras, seed 1: 60 cameras, .* made in ")

    def test_output_as_the_end_of_the_name_says(self):
        result = self.run_json("--city", 40, "--output", "out.bbal")
        again = self.run_json("out.bbal", "--iterations", 0)
        self.assertEqual(again["initial_cost"], result["final_cost"])
        self.assertEqual((self.folder / "out.bbal").read_bytes()[1:5], b"BBAL")
        self.run_ok("out.bbal", "--iterations", 0, "--output", "out.ply")
        ply = (self.folder / "out.ply").read_bytes()
        head, body = ply.split(b"end_header\n", 1)
        vertices, edges = result["points"] + 5 * 40, 8 * 40
        self.assertIn(b"format binary_little_endian 1.0\nelement vertex %d\n" % vertices, head)
        self.assertIn(b"element edge %d\n" % edges, head)
        self.assertEqual(len(body), 15 * vertices + 11 * edges)

    def test_the_binary_form_is_as_documented(self):
        """docs/formats.md, read by hand."""
        self.write("a.txt", make_bal(num_points=10)[0])
        self.run_ok("a.txt", "--iterations", 0, "--output", "a.bbal")
        data = (self.folder / "a.bbal").read_bytes()
        self.assertEqual(data[:8].hex(), "894242414c0d0a1a")
        version, order = struct.unpack("=II", data[8:16])
        self.assertEqual((version, order), (1, 0x01020304))
        counts = struct.unpack("=3q", data[16:40])
        self.assertEqual(counts, (5, 10, 50))
        self.assertEqual(len(data), 48 + 72 * 5 + 24 * 10 + 24 * 50)
        checksum, most = 0, (1 << 64) - 1
        for (word,) in struct.iter_unpack("=Q", data[48:]):
            product = (checksum ^ word) * 0x9e3779b97f4a7c15 & most
            checksum = (product << 29 & most) | product >> 35
        self.assertEqual(checksum, struct.unpack("=Q", data[40:48])[0])
        words = [float(x) for x in (self.folder / "a.txt").read_text(encoding="utf-8").split()][3:]
        observations, vertices = words[:4 * 50], words[4 * 50:]
        self.assertEqual(list(struct.unpack("=75d", data[48:48 + 8 * 75])), vertices)
        self.assertEqual([x for o in struct.iter_unpack("=2i2d", data[48 + 8 * 75:]) for x in o], observations)

    def test_colmap(self):
        """A BAL problem as a COLMAP model, solved from there; in binary and in text."""
        text, cost = make_bal()
        path = self.write("a.txt", text)
        best = self.run_json(path, "--tolerance", "1e-12")["final_cost"]
        self.run_ok(path, "--iterations", 0, "--output", "binary/")
        self.run_ok(path, "--iterations", 0, "--output", "text/", "--colmap-text")
        for folder, ending in (("binary", ".bin"), ("text", ".txt")):
            self.assertEqual(sorted(p.name for p in (self.folder / folder).iterdir()),
                             sorted(name + ending for name in ("cameras", "images", "points3D")))
            result = self.run_json(folder, "--tolerance", "1e-12", "--output", f"{folder}_out")
            self.check_schema(result, "images")
            self.assertEqual([result[k] for k in ("images", "cameras", "points", "observations")], [5, 5, 60, 300])
            self.assertAlmostEqual(result["initial_cost"] / cost, 1.0, places=9)
            self.assertAlmostEqual(result["final_cost"] / best, 1.0, places=6)
            # As it came, and where the solve ended.
            self.assertTrue((self.folder / f"{folder}_out" / f"images{ending}").is_file())
            again = self.run_json(f"{folder}_out", "--iterations", 0)
            self.assertAlmostEqual(again["initial_cost"] / result["final_cost"], 1.0, places=9)
            # Errors are those of the solution.
            lines = [] if ending == ".bin" else (self.folder / "text_out" / "points3D.txt").read_text(
                encoding="utf-8").splitlines()
            errors = [float(line.split()[7]) for line in lines if not line.startswith("#")]
            self.assertTrue(all(0 < e < 2 for e in errors), errors)
        self.run_ok("binary", "--iterations", 3, "--output", "as_text", "--colmap-text")
        self.assertTrue((self.folder / "as_text" / "images.txt").is_file())
        self.run_ok("binary", "--iterations", 3, "--output", "a.ply")
        head = (self.folder / "a.ply").read_bytes().split(b"end_header\n", 1)[0]
        self.assertIn(b"element vertex %d\nproperty" % (60 + 5 * 5), head)
        out = self.run_ok("text", "--iterations", 1)
        self.assertIn("text: 5 images by 5 cameras, 60 points, 300 observations, read in", out)

    def test_colmap_choices(self):
        self.run_ok(self.write("a.txt", make_bal()[0]), "--iterations", 0, "--output", "model/")
        costs = [self.run_json("model", *args)["final_cost"]
                 for args in (("--fix-intrinsics",), (), ("--principal-point",))]
        self.assertEqual(costs, sorted(costs, reverse=True))
        self.assertEqual(len(set(costs)), 3)
        both = self.run_json("model", "--fix-intrinsics", "--tolerance", "1e-12", "--threads", 2)
        self.assertAlmostEqual(both["final_cost"] / costs[0], 1, places=5)

    def test_refuses_colmap(self):
        path = self.write("a.txt", make_bal(num_points=10)[0])
        self.run_ok(path, "--iterations", 0, "--output", "model/")
        self.run_ok(path, "--iterations", 0, "--output", "text/", "--colmap-text")
        self.write("file", "")
        (self.folder / "empty").mkdir()
        points = self.folder / "text" / "points3D.txt"
        points.write_text(points.read_text(encoding="utf-8").replace(" 0\n", " 9\n", 1), encoding="utf-8")
        for args, says in ((("empty",), "empty: no COLMAP model"),
                           (("text",), "text/points3D.txt:"),
                           (("model", "--output", "a.bbal"), "--output: a.bbal"),
                           (("model", "--output", "file"), "--output: file"),
                           (("model", "--output", "model", "--colmap-text"), "binary model"),
                           (("model", "--output", "no/such/folder"), "--output"),
                           (("model", "--output", "no/such/folder/"), "--output"),
                           (("model", "--principal-point", "--fix-intrinsics"), "--principal-point"),
                           ((path, "--fix-intrinsics"), "--fix-intrinsics")):
            with self.subTest(args=args):
                result = self.run_app(*args)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(says, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)

    def test_g2o(self):
        """A pose graph from file to file, its costs by g2o's formulas."""
        text = make_g2o()
        path = self.write("a.g2o", text)
        (self.folder / "a.gz").write_bytes(gzip.compress(text.encode()))
        result = self.run_json(path, "--tolerance", "1e-12", "--output", "out.g2o")
        self.check_schema(result, "poses")
        self.assertEqual([result[k] for k in ("poses", "cameras", "points", "observations")], [30, 0, 4, 73])
        self.assertLess(abs(2 * result["initial_cost"] / g2o_chi2(text) - 1), 1e-2)  # turned by up to 0.3 rad
        solved = (self.folder / "out.g2o").read_text(encoding="utf-8")
        self.assertLess(abs(2 * result["final_cost"] / g2o_chi2(solved) - 1), 1e-3)
        # 369 residuals less 29 * 6 + 4 * 3 unknowns.
        self.assertAlmostEqual(2 * result["final_cost"] / 183, 1, delta=5 * math.sqrt(2 / 183))
        self.assertEqual(self.run_json("a.gz", "--tolerance", "1e-12")["final_cost"], result["final_cost"])
        again = self.run_json("out.g2o", "--iterations", 0, "--output", "again.g2o.bz2")
        self.assertAlmostEqual(again["initial_cost"] / result["final_cost"], 1, places=12)
        # What was not solved for is there as it was, and so is the vertex that was held.
        kept = [[line.split()[0], *map(float, line.split()[1:])] for line in text.splitlines()
                if line.startswith(("EDGE", "PARAMS", "VERTEX_SE3:QUAT 0 "))]
        written = [[line.split()[0], *map(float, line.split()[1:])] for line in solved.splitlines()
                   if line.startswith(("EDGE", "PARAMS", "VERTEX_SE3:QUAT 0 "))]
        self.assertEqual(sorted(kept), sorted(written))
        out = self.run_ok(path, "--iterations", 1)
        self.assertIn("a.g2o: 30 poses, 0 cameras, 4 points, 73 edges, read in", out)
        self.assertIn("\nvertex 0 is held: the file fixes none and has no prior\n", out)
        self.assertNotIn("is held", self.run_ok(self.write("b.g2o", text + "FIX 3\n"), "--iterations", 1))
        solvers = {self.run_json(path, "--tolerance", "1e-12", "--linear-solver", name)["final_cost"]
                   for name in ("dense", "sparse")}
        self.assertLess(max(solvers) / min(solvers) - 1, 1e-9)

    def test_own_pose_graph(self):
        path = ROOT / "data" / "loops.g2o.gz"
        there = gzip.decompress(path.read_bytes()).decode().split()
        made = make_g2o(poses=80, turns=5, seed=1).split()
        self.assertEqual(len(there), len(made))
        for a, b in zip(there, made):
            if a != b:  # another machine's sine
                self.assertAlmostEqual(float(a), float(b), delta=1e-8)
        self.assertAlmostEqual(self.run_json(path)["final_cost"] / 292.4780, 1, delta=1e-6)

    def test_refuses_g2o(self):
        text = make_g2o(poses=12)
        path = self.write("a.g2o", text)
        lines = text.splitlines()
        self.write("tag.g2o", text + "EDGE_SE2 0 1 0 0 0 1 0 0 1 0 1\n")
        self.write("vertex.g2o", text + lines[-1].replace(" 1003 ", " 77 ") + "\n")
        self.write("cut.g2o", text[:-8])
        bal = self.write("a.txt", make_bal(num_points=10)[0])
        for args, says in ((("tag.g2o",), f"tag.g2o:{len(lines) + 1}: tag 'EDGE_SE2' is not supported"),
                           (("vertex.g2o",), f"vertex.g2o:{len(lines) + 1}: EDGE_SE3_TRACKXYZ: there is no vertex 77"),
                           (("cut.g2o",), f"cut.g2o:{len(lines)}: expected EDGE_SE3_TRACKXYZ"),
                           ((path, "--output", "a.ply"), "--output: a.ply"),
                           ((path, "--output", "b.txt"), "--output: b.txt"),
                           ((path, "--fix-intrinsics"), "--fix-intrinsics"),
                           ((bal, "--output", "b.g2o"), "--output: b.g2o")):
            with self.subTest(args=args):
                result = self.run_app(*args)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(says, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)

    def test_progress_on_a_terminal(self):
        """A line that is written over, with time left, and gone at the end."""
        import os
        import pty
        import subprocess
        import threading
        ours, its = pty.openpty()
        shown = bytearray()

        def listen():
            try:
                while data := os.read(ours, 4096):
                    shown.extend(data)
            except OSError:  # the other end is closed
                pass

        listener = threading.Thread(target=listen)
        listener.start()
        done = subprocess.run([str(self.folder_of_executables / self.app), "--city", "300", "--tolerance", "0",
                               "--iterations", "25"], cwd=self.folder, stdout=subprocess.PIPE, stderr=its, text=True, check=False,
                              timeout=300)
        os.close(its)
        listener.join()
        os.close(ours)
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("left", done.stdout)
        text = shown.decode()
        self.assertTrue(text.startswith("\rmaking a city of 300 cameras, seed 1\x1b[K"), text[:80])
        self.assertRegex(text, r"\riteration \d+ of at most 25, cost \d\.\d{6}e[-+]\d+, \d+ s, "
                               r"(about|at most) [0-9.]+ (s|min|h) left\x1b\[K")
        self.assertTrue(text.endswith("\r\x1b[K"), text[-80:])

    def test_table(self):
        path = self.write("a.txt", make_bal()[0])
        out = self.run_ok(path, "--iterations", 3)
        self.assertIn("5 cameras, 60 points, 300 observations", out)
        self.assertRegex(out, r"(?m)^iter .*cost.*lambda")
        for k in range(4):
            self.assertRegex(out, rf"(?m)^ *{k}[ x] ")
        self.assertIn("iteration limit, 3 iterations", out)

    def test_ceres(self):
        path = self.write("a.txt", make_bal()[0])
        result = self.run_app(path, "--compare-ceres", "--json", "a.json")
        if result.returncode == 2 and "built without Ceres" in result.stderr:
            self.assertEqual(self.files(), ["a.txt"])
            self.skipTest("built without Ceres")
        both = self.run_json(path, "--compare-ceres", "--tolerance", "1e-12")
        self.check_schema(both, "ceres")
        self.assertAlmostEqual(both["ceres"]["initial_cost"] / both["initial_cost"], 1, places=9)
        self.assertAlmostEqual(both["ceres"]["final_cost"] / both["final_cost"], 1, places=8)

    def test_own_problem(self):
        result = self.run_json(ROOT / "data" / "ring.txt.gz")
        self.assertAlmostEqual(result["initial_cost"] / 22716.82, 1, delta=1e-5)
        self.assertAlmostEqual(result["final_cost"] / 311.7207, 1, delta=1e-5)

    def test_published_problems(self):
        data = data_folder()
        if data is None:
            self.skipTest("no folder of data sets")
        for name, initial, final in (("ladybug-problem-49-7776-pre", 8.509125e5, 1.3344e4),
                                     ("trafalgar-problem-21-11315-pre", 4.413239e6, 3.0379e4)):
            result = self.run_json(data / "bal" / f"{name}.txt.gz", timeout=1200)
            self.assertAlmostEqual(result["initial_cost"] / initial, 1, delta=2e-7)
            self.assertLess(result["final_cost"], 1.001 * final)

    def test_refuses_options(self):
        path = self.write("a.txt", make_bal(num_points=10)[0])
        for args, says in (
                ((), "FILE"), ((path, "--city", 50), "--city"), ((path, "--seed", 2), "--seed"), ((path, path), str(path)), ((path, "--linear-solver", "qr"), "--linear"),
                ((path, "--linear-solver", ""), "--linear"), ((path, "--method", "gn"), "--method"),
                ((path, "--method", "course"), "--method"),
                ((path, "--loss", "l1"), "--loss"), ((path, "--loss", ""), "--loss"),
                ((path, "--loss", "none:1"), "--loss"), ((path, "--loss", "huber:0"), "--loss"),
                *(((path, "--loss", f"tukey:{w}"), "--loss")
                  for w in ("", "nan", "inf", "1e300", "-1", "x")),
                ((path, "--output", "-"), "--output"), ((path, "--output", ""), "--output"),
                ((path, "--json", ""), "--json"),
                ((path, "--output", "no/such/a.txt"), "--output"),
                ((path, "--json", "."), "--json"),
                ((path, "--json", "same", "--output", "same"), "same"),
                ((path, "--frobnicate"), "--frobnicate")):
            self.check_refused(*args, says=says)

    def test_refuses_files(self):
        text = make_bal(num_points=10)[0]
        lines = text.splitlines()
        cases = {
            "missing.txt": (None, "missing.txt: cannot be opened"),
            "empty.txt": ("", "empty.txt:1: "),
            "cut.txt": (text[:len(text) // 2], "cut.txt:"),
            "count.txt": (text.replace("5 10 50", "5 10 51", 1), "count.txt:52: "),
            "cameras.txt": (text.replace("5 10 50", "6 10 50", 1), "cameras.txt:"),
            "negative.txt": (text.replace("5 10 50", "-5 10 50", 1), "negative.txt:1: "),
            "index.txt": ("\n".join([lines[0], "0 10 1 2", *lines[2:]]) + "\n", "index.txt:2: "),
            "nan.txt": ("\n".join([*lines[:60], "nan", *lines[61:]]) + "\n", "nan.txt:61: "),
            "garbage.txt": (text + "more\n", f"garbage.txt:{len(lines) + 1}: "),
            "words.txt": ("not a BAL file\n", "words.txt:1: "),
        }
        for name, (content, _) in cases.items():
            if content is not None:
                self.write(name, content)
        (self.folder / "cut.gz").write_bytes(gzip.compress(text.encode())[:-20])
        cases["cut.gz"] = (b"", "cut.gz:")
        for name, (_, says) in cases.items():
            self.check_refused(name, "--json", "a.json", "--output", "b.txt", says=says)

    def test_refuses_what_cannot_be_solved(self):
        text = make_bal(num_points=10)[0]
        lines = text.splitlines()
        twice = self.write("twice.txt", "\n".join([lines[0], lines[2], *lines[2:]]) + "\n")
        self.check_refused(twice, "--json", "a.json", says="observations 0 and 1 ")

    def test_numeric_options(self):
        self.check_numeric_options(self.write("a.txt", make_bal(num_points=10)[0]))

    def test_json_to_stdout(self):
        path = self.write("a.txt", make_bal()[0])
        self.check_json_on_stdout(path, "--iterations", 5, "--tolerance", 0)

    def test_file_with_a_name_that_is_not_utf8(self):
        import os
        import subprocess
        name = os.path.join(os.fsencode(self.folder), b"a\xff.txt")
        with open(name, "w", encoding="utf-8") as file:
            file.write(make_bal(num_points=10)[0])
        done = subprocess.run([str(self.folder_of_executables / self.app), name, "--json", "a.json"],
                              cwd=self.folder, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a.json", self.files())

    def test_interrupted_solve_leaves_the_best_state(self):
        # Large, and far off: some seconds of steps that go down.
        path = self.write("a.txt", make_bal(40, 3000, noise=20.0)[0])
        out, result = self.check_interrupt(path, "--tolerance", 0, "--iterations", 1000000,
                                           "--output", "b.txt", after="\n   0 ")
        self.check_schema(result)
        self.assertTrue(result["status"].startswith("cancelled"), result["status"])
        self.assertIn("cancelled", out)
        again = self.run_json("b.txt", "--iterations", 0)
        self.assertEqual(again["initial_cost"], result["final_cost"])
        self.assertLessEqual(result["final_cost"], result["initial_cost"])

    def test_interrupted_city(self):
        out, result = self.check_interrupt("--city", 200, "--tolerance", 0, "--iterations", 1000000,
                                           "--output", "b.bbal", after="\n   0 ")
        self.check_schema(result)
        self.assertTrue(result["status"].startswith("cancelled"), result["status"])
        self.assertLess(result["iterations"], 1000)
        self.assertIn("cancelled", out)
        again = self.run_json("b.bbal", "--iterations", 0)
        self.assertEqual(again["initial_cost"], result["final_cost"])
        self.assertLessEqual(result["final_cost"], result["initial_cost"])

    def test_solvers_of_large_problems(self):
        costs = []
        for args in (["--linear-solver", "sparse"], ["--linear-solver", "pcg", "--forcing", 0],
                     ["--linear-solver", "pcg", "--preconditioner", "cluster-jacobi"],
                     ["--linear-solver", "implicit-pcg", "--preconditioner", "power-series"]):
            result = self.run_app("--city", 30, "--json", "out.json", *args)
            self.assertEqual(result.returncode, 0, result.stderr)
            report = strict_json((self.folder / "out.json").read_text())
            self.assertEqual(report["reduced_solver"], args[1])
            costs.append(report["final_cost"])
        for cost in costs:
            self.assertAlmostEqual(cost / costs[0], 1.0, delta=1e-6)

    def test_memory_limit(self):
        result = self.run_app("--city", 60, "--memory-limit", "1M")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"needs \d+ MB.*memory_limit is 1 MB")
        result = self.run_app("--city", 60, "--iterations", 1, "--memory-limit", "2G")
        self.assertEqual(result.returncode, 0, result.stderr)
        for wrong in ("", "-1", "x", "1T", "nan", "G"):
            result = self.run_app("--city", 60, "--memory-limit", wrong)
            self.assertEqual(result.returncode, 2, wrong)
            self.assertIn("--memory-limit", result.stderr)

    # Whatever the address space that the system gives: a solution, or one line that says why not.
    @without_sanitizers
    def test_little_memory(self):
        codes = set()
        for step in range(20):
            limit = int(12e6 * 1.2 ** step)

            def limited(limit=limit):
                resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

            result = subprocess.run(
                [str(self.folder_of_executables / self.app), "--city", "60", "--iterations", "2",
                 "--output", "out.bbal"], cwd=self.folder, capture_output=True, text=True, timeout=300,
                preexec_fn=limited)
            if result.returncode == 127:
                continue  # the loader itself has run out
            codes.add(result.returncode)
            self.assertIn(result.returncode, (0, 1, 2), f"{limit}: {result.stderr}")
            if result.returncode != 0:
                self.assertRegex(result.stderr, "memory", str(limit))
                self.assertFalse((self.folder / "out.bbal").exists())
            (self.folder / "out.bbal").unlink(missing_ok=True)
        self.assertIn(0, codes)
        self.assertGreater(len(codes), 1)

    def test_version(self):
        self.check_version()

    def test_help(self):
        self.check_help("--method", "FILE", "--linear-solver", "--iterations", "--threads", "--loss",
                        "--tolerance", "--output", "--json", "--compare-ceres", "--city", "--seed", ".ply",
                        ".bbal", "COLMAP", "--principal-point", "--fix-intrinsics", "--colmap-text")


if __name__ == "__main__":
    main(BaSolve)
