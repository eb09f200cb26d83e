#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Commands that README.md, docs/, data/README.md and the programs' own help show: their options
exist, their files of data/ and scripts are there, and those that take a moment only are run.

    commands_test.py FOLDER_OF_THE_EXECUTABLES
"""

import functools
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path()
APPS = {path.stem for path in (ROOT / "app").glob("*.cpp")}
sys.path.insert(0, str(ROOT / "scripts"))
import help_text  # noqa: E402
BENCHES = {path.stem for path in (ROOT / "bench").glob("*.cpp")}
# By hand only: they take long, or need what is not here.
NOT_RUN = {"gauge_study", "prior_weight_sweep", "marginal_study", "sim_images"} | BENCHES


def commands(text):
    """Lines of indented or fenced blocks that begin with a program or a script; continued lines joined."""
    text = text.replace("\\\n", " ")
    for line in text.splitlines():
        indented = re.match(r"(?: {4}|  )(\S.*)$", line) or re.match(r"((?:scripts|build)/\S+.*)$", line)
        if not indented:
            continue
        for part in re.split(r"\s*(?:&&|\|)\s*", indented.group(1).split("  ")[0].split(" #")[0]):
            try:
                words = shlex.split(part)
            except ValueError:
                continue
            while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
                words = words[1:]
            if words[:1] == ["glissade"]:
                words = by_program(words)
            if words and (words[0] in APPS | BENCHES or words[0].startswith("scripts/")):
                yield words


def by_program(words):
    """"glissade solve FILE" as "ba_solve FILE"."""
    programs = {c.name: c.program for c in help_text.commands_of(help_text.parse(help_of("glissade")))}
    return [programs[words[1]], *words[2:]] if len(words) > 1 and words[1] in programs else words


def is_here(program):
    """Not a program that this build leaves out: some need packages."""
    return program not in APPS or (BIN / program).is_file()


def documented():
    """(where, words) of every command."""
    for path in (ROOT / "README.md", ROOT / "data/README.md", *sorted((ROOT / "docs").rglob("*.md"))):
        for words in commands(path.read_text(encoding="utf-8")):
            if is_here(words[0]):
                yield str(path.relative_to(ROOT)), words
    for app in filter(is_here, sorted(APPS)):
        examples = help_of(app).partition("Examples:")[2]
        for words in filter(lambda found: is_here(found[0]), commands(examples)):
            yield f"{app} --help", words


@functools.cache
def help_of(app):
    return subprocess.run([str(BIN / app), "--help"], capture_output=True, text=True, check=True).stdout


class Commands(unittest.TestCase):
    def test_options_and_files_exist(self):
        found = 0
        for where, words in documented():
            with self.subTest(where=where, command=" ".join(words)):
                found += 1
                if words[0].startswith("scripts/"):
                    self.assertTrue((ROOT / words[0]).is_file(), words[0])
                for word in words[1:]:
                    if word.startswith("data/"):
                        self.assertTrue((ROOT / word).exists(), word)
                    if word.startswith("--") and words[0] in APPS:
                        self.assertRegex(help_of(words[0]), rf"(?m)^ +(-\w,)?{re.escape(word)}\b")
                    if word.startswith("--") and words[0] in BENCHES:
                        source = (ROOT / "bench" / f"{words[0]}.cpp").read_text(encoding="utf-8")
                        self.assertIn(word, source)
        self.assertGreater(found, 20)

    def test_short_commands_run(self):
        run = 0
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "data").symlink_to(ROOT / "data")
            for where, words in documented():
                named = [w for w in words[1:] if re.search(r"\.txt|\.yaml|^[A-Z][A-Z_0-9]*$|\$|\[", w)]
                if words[0] not in APPS - NOT_RUN:
                    continue
                if any(not w.startswith("data/") for w in named) and words[0] != "make_data":
                    continue  # a file of the reader's
                if words[0] == "make_data" and any(w.isupper() or "[" in w for w in words):
                    continue
                if "--report" in words and not (BIN / "../share/glissade/plotly.min.js").is_file():
                    continue
                with self.subTest(where=where, command=" ".join(words)):
                    done = subprocess.run([str(BIN / words[0]), *words[1:]], cwd=folder, text=True,
                                          capture_output=True, check=False, timeout=300)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    run += 1
        self.assertGreater(run, 8)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
