#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/rerun_view.py: what it records of a run, what it refuses. The recording is made with the real SDK
(pip install rerun-sdk, for the Python that GLISSADE_RERUN_PYTHON names, or for that which runs this)."""

import json
import math
import os
import re
import subprocess
import sys

from app_test_util import ROOT, AppTest, main

SCRIPT = ROOT / "scripts/rerun_view.py"
FRAMES = 700
# Of 1 x 1: what a PNG needs at least.
PNG = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
                    "0000000a49444154789c636000000002000148afa4710000000049454e44ae426082")


def python_with_rerun():
    for candidate in (os.environ.get("GLISSADE_RERUN_PYTHON"), sys.executable):
        if candidate and subprocess.run([candidate, "-c", "import rerun"], capture_output=True, check=False).returncode == 0:
            return candidate
    return None


class RerunViewTest(AppTest):
    def run_view(self, python, *args, lines=()):
        # A home of its own: nothing of this is told to anybody, and nothing of the user's is changed.
        env = {**os.environ, "HOME": str(self.folder), "XDG_CONFIG_HOME": str(self.folder / ".config")}
        text = "".join(line if isinstance(line, str) else json.dumps(line) + "\n" for line in lines)
        return subprocess.run([python, *map(str, args)], input=text, capture_output=True, text=True, env=env, timeout=120,
                              check=False)

    def need_rerun(self):
        python = python_with_rerun()
        if python is None:
            self.skipTest("no Python with rerun-sdk here (GLISSADE_RERUN_PYTHON may name one)")
        return python

    def test_help_and_missing_sdk(self):
        result = self.run_view(sys.executable, SCRIPT, "--help")
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("--save", "rerun.io", '"landmarks"', "Exit code:"):
            self.assertIn(word, result.stdout)
        # A Python that has no packages but its own, -S, and so no SDK.
        result = self.run_view(sys.executable, "-S", SCRIPT, "--save", self.folder / "run.rrd")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr, "rerun_view.py: the rerun SDK is not installed: pip install rerun-sdk\n")
        self.assertEqual(self.files(), [])

    def test_what_is_recorded(self):
        python = self.need_rerun()
        image = self.folder / "image.png"
        image.write_bytes(PNG)
        lines = []
        for k in range(FRAMES):
            a = 0.01 * k
            frame = {"t": 0.05 * k, "p": None, "features": [[10 * i, 5 * i, i] for i in range(12)]}
            if k >= 20:
                frame.update(p=[math.cos(a), math.sin(a), a], q=[0, 0, math.sin(a / 2), math.cos(a / 2)], truth=[math.cos(a), math.sin(a), 0])
            if k % 10 == 0:
                frame["landmarks"] = [[i, k, 1] for i in range(9)]
            if k % 100 == 0:
                frame["image"] = str(image)
            lines.append(frame)
        record = self.folder / "run.rrd"
        result = self.run_view(python, SCRIPT, "--save", record, "--name", "a flight", lines=lines)
        self.assertEqual((result.returncode, result.stderr), (0, f"rerun_view.py: {FRAMES} frames shown\n"))
        self.assertGreater(record.stat().st_size, 10_000)
        self.assertEqual(self.run_view(python, "-m", "rerun", "rrd", "verify", record).returncode, 0)
        text = self.run_view(python, "-m", "rerun", "rrd", "print", record).stdout
        self.assertIn('"a flight"', text)
        rows = {}
        for count, entity in re.findall(r"with ([\d ,_]+) rows .* - /?(\S+) - data columns", text.replace("\u2009", "")):
            rows[entity] = rows.get(entity, 0) + int(re.sub(r"\D", "", count))
        posed = FRAMES - 20
        self.assertEqual({key: value for key, value in rows.items() if not key.startswith("__")}, {
            "world": 1, "world/body/axes": 1, "world/body": posed, "world/landmarks": FRAMES // 10, "camera/image": FRAMES // 100,
            "camera/features": FRAMES, "features/number": FRAMES,
            # Ways in pieces of 500 steps.
            "world/estimate/0": 500, "world/estimate/1": posed - 1 - 500, "world/truth/0": 500, "world/truth/1": posed - 1 - 500})

    def test_lines_that_make_no_sense(self):
        python = self.need_rerun()
        bad = ('{"t":\n', "[]\n", {"p": [1, 2, 3]}, {"t": None}, {"t": "1"}, '{"t": NaN}\n', '{"t": 1e999}\n', {"t": 1, "p": [1, 2]},
               {"t": 1, "q": [0, 0, 0, "1"]}, {"t": 1, "landmarks": 3}, {"t": 1, "features": [[1, 2]]}, {"t": 1, "image": 5},
               {"t": 1, "image": str(self.folder / "none.png")})
        result = self.run_view(python, SCRIPT, "--save", self.folder / "run.rrd", lines=({"t": 1}, "\n", {"t": 1, "p": [1, 2]}))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "rerun_view.py: line 3: 'p' is not 3 numbers\n"
                                        "rerun_view.py: 1 frames shown, 1 lines left out\n")
        result = self.run_view(python, SCRIPT, "--save", self.folder / "run.rrd", lines=(*bad, {"t": 2}))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 5 + 1, result.stderr)
        self.assertIn(f"1 frames shown, {len(bad)} lines left out", result.stderr)

    def test_a_file_that_cannot_be_written(self):
        python = self.need_rerun()
        result = self.run_view(python, SCRIPT, "--save", self.folder / "none" / "run.rrd")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
        self.assertIn("run.rrd", result.stderr)


if __name__ == "__main__":
    main(RerunViewTest)
