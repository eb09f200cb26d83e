# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the apps share. Each is run as: NAME_test.py FOLDER_OF_THE_EXECUTABLES"""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def data_folder():
    """The folder of large data sets, None where there is none."""
    folder = pathlib.Path(os.environ.get("GLISSADE_DATA", ROOT.parent / "shared" / "data"))
    return folder if folder.is_dir() else None


def strict_json(text):
    """Parses JSON as the standard has it: no NaN, no Infinity."""

    def refuse(name):
        raise ValueError(f"{name} is no JSON")

    return json.loads(text, parse_constant=refuse)


def drawing():
    """The environment for scripts/plot_*.py, with the package of this build behind PYTHONPATH; None where
    glissade.plot cannot be imported."""
    built = AppTest.folder_of_executables.parent / "python"
    paths = filter(None, (os.environ.get("PYTHONPATH"), str(built)))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    found = subprocess.run([sys.executable, "-c", "import glissade.plot"], env=environment, capture_output=True,
                           check=False)
    return environment if found.returncode == 0 else None


# What no numeric option takes. A test adds what its option must refuse besides.
NO_NUMBERS = ("nan", "inf", "-inf", "1e300", "-1e300", "1e999", "", " ", "text", "1x", "0x10", "1,5",
              "--", "-")
# For a program that takes long to load its libraries: all options parse numbers by one function.
FEW_NO_NUMBERS = ("nan", "1x")

HEADER = {"schema", "version", "isa", "file", "interrupted"}


# Under sanitizers, where an app runs ten times as long, a study of its numbers is left out: it walks
# through no code that its shorter runs do not.
without_sanitizers = unittest.skipIf("GLISSADE_SANITIZED" in os.environ, "numbers are tested without sanitizers")


class AppTest(unittest.TestCase):
    """Runs one app in an empty folder of its own."""

    app = ""
    numeric_options = {}  # option -> further values that it refuses
    folder_of_executables = pathlib.Path()

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="glissade_app_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def run_app(self, *args, timeout=300):
        return subprocess.run([str(self.folder_of_executables / self.app), *map(str, args)],
                              cwd=self.folder, capture_output=True, text=True, timeout=timeout,
                              check=False)

    def run_ok(self, *args, **kwargs):
        result = self.run_app(*args, **kwargs)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        return result.stdout

    def run_json(self, *args, **kwargs):
        """Runs with --json; the parsed result, whose header has been checked."""
        path = self.folder / "result.json"
        self.run_ok(*args, "--json", path, **kwargs)
        result = strict_json(path.read_text(encoding="utf-8"))
        self.check_header(result)
        return result

    def check_header(self, result, interrupted=False):
        self.assertEqual(list(result)[:5], ["schema", "version", "isa", "file", "interrupted"])
        self.assertEqual(result["schema"], f"glissade/{self.app}/1")
        self.assertRegex(result["version"], r"^\d+\.\d+\.\d+$")
        self.assertIn(result["isa"], ("baseline", "avx2", "avx512"))
        self.assertEqual(result["interrupted"], interrupted)

    def check_json_on_stdout(self, *args):
        """With --json - nothing but JSON is on stdout; the text for people is on stderr."""
        text = self.run_ok(*args)
        result = self.run_app(*args, "--json", "-")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.check_header(strict_json(result.stdout))
        # The same text, numbers that are times or memory apart.
        def words(lines):
            return re.sub(r"[-+]?[0-9][-+0-9.e]*", "#", lines).split()
        self.assertEqual(words(result.stderr), words(text))
        self.assertEqual([f for f in self.files() if f == "-"], [])

    def check_interrupt(self, *args, after, timeout=120):
        """Sends Ctrl-C once stdout has had a line that contains `after` (None: after four seconds
        of silence); gives stdout and the JSON that was written all the same."""
        path = self.folder / "interrupted.json"
        command = [str(self.folder_of_executables / self.app), *map(str, args), "--json", str(path)]
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            self.addCleanup(process.kill)
            watch = threading.Timer(timeout, process.kill)  # not for ever, whatever goes wrong
            watch.start()
            self.addCleanup(watch.cancel)
            out = ""
            if after is None:
                try:
                    process.wait(4.0)
                except subprocess.TimeoutExpired:
                    pass
            else:
                # It comes while the work goes on: lines are flushed.
                while after not in out:
                    line = process.stdout.readline()
                    if not line:
                        self.fail(out + process.stderr.read())
                    out += line
            self.assertIsNone(process.poll(), "too quick to be interrupted")
            process.send_signal(signal.SIGINT)
            rest, error = process.communicate(timeout=timeout)
        self.assertEqual(process.returncode, 130, error)
        self.assertIn("interrupted", error)
        self.assertEqual(error.count("\n"), 1, error)
        result = strict_json(path.read_text(encoding="utf-8"))
        self.check_header(result, interrupted=True)
        return out + rest, result

    def check_numeric_options(self, *args, no_numbers=None):
        """No option takes for a number what is none, or one that it cannot mean."""
        for option, more in self.numeric_options.items():
            for value in (*(no_numbers or NO_NUMBERS), *more):
                self.check_refused(*args, f"{option}={value}", says=option)
                if not value.startswith("--"):
                    self.check_refused(*args, option, value, says=option)
        # Nor is one left out of this test.
        text = self.run_ok("--help")
        numeric = set(re.findall(r"^  (--[a-z-]+) (?:N|X|X,X,\.\.\.)(?: |$)", text, re.MULTILINE))
        self.assertEqual(numeric, set(self.numeric_options))

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def files(self):
        return sorted(p.name for p in self.folder.iterdir())

    def check_refused(self, *args, says=""):
        """One clear line on stderr, exit code 2, nothing written and nothing on stdout."""
        before = self.files()
        result = self.run_app(*args)
        self.assertEqual(result.returncode, 2, (args, result.stdout, result.stderr))
        self.assertEqual(result.stdout, "", args)
        self.assertEqual(result.stderr.count("\n"), 1, (args, result.stderr))
        self.assertTrue(result.stderr.startswith(self.app + ": "), result.stderr)
        self.assertIn(says, result.stderr)
        self.assertEqual(self.files(), before, args)

    def check_help(self, *words):
        text = self.run_ok("--help")
        for word in (*words, "Examples:", "Exit code:", self.app, "--version", "--json", "130",
                     "--linear-solver", "'auto' (default)"):
            self.assertIn(word, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 100, line)

    def check_version(self):
        text = self.run_ok("--version")
        self.assertRegex(text, rf"^{self.app} \(glissade\) \d+\.\d+\.\d+\n")
        self.assertRegex(text, r"(?m)^instruction sets: baseline.*; in use here: (baseline|avx2|avx512)$")
        self.assertRegex(text, r"(?m)^options: .*Ceres")
        self.assertRegex(text, r"(?m)^compiler: \S+ [0-9.]+$")

    def check_linear_solvers(self, *args, cost):
        """All lead to the same; the default is the library's own choice."""
        results = {which: self.run_json(*args, "--linear-solver", which)
                   for which in ("auto", "dense", "sparse", "pcg", "implicit-pcg")}
        for which, result in results.items():
            self.assertEqual(result["linear_solver"], which)
            self.assertAlmostEqual(cost(result) / cost(results["auto"]), 1, delta=1e-6, msg=which)
        default = self.run_json(*args)
        self.assertEqual(default["linear_solver"], "auto")
        self.assertEqual(cost(default), cost(results["auto"]))
        self.check_refused(*args, "--linear-solver", "qr", says="--linear-solver")


def main(test_class):
    if len(sys.argv) < 2:
        sys.exit("usage: " + sys.argv[0] + " FOLDER_OF_THE_EXECUTABLES [unittest options]")
    test_class.folder_of_executables = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
