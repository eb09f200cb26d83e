# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the apps share. Each is run as: NAME_test.py FOLDER_OF_THE_EXECUTABLES"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
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


class AppTest(unittest.TestCase):
    """Runs one app in an empty folder of its own."""

    app = ""
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
        """Runs with --json; the parsed result."""
        path = self.folder / "result.json"
        self.run_ok(*args, "--json", path, **kwargs)
        return strict_json(path.read_text(encoding="utf-8"))

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
        for word in (*words, "Examples:", "Exit code:", self.app):
            self.assertIn(word, text)


def main(test_class):
    if len(sys.argv) < 2:
        sys.exit("usage: " + sys.argv[0] + " FOLDER_OF_THE_EXECUTABLES [unittest options]")
    test_class.folder_of_executables = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
