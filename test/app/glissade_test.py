#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""glissade: its commands are the programs beside it, under its own name."""

import shutil
import subprocess
import sys

from app_test_util import ROOT, AppTest, main, strict_json

sys.path.insert(0, str(ROOT / "scripts"))
import help_text  # noqa: E402

PROGRAMS = {"solve": "ba_solve", "check": "vio_check", "run": "vio_run", "replay": "vio_replay", "report": "traj_eval",
            "window": "window_solve", "sweep": "prior_weight_sweep", "gauge": "gauge_study"}


class GlissadeTest(AppTest):
    app = "glissade"

    def built(self):
        """The commands whose programs are in this build."""
        return {name: program for name, program in PROGRAMS.items()
                if (self.folder_of_executables / program).is_file()}

    def test_help_names_all_commands(self):
        text = self.run_ok("--help")
        self.assertEqual(text, self.run_ok("help"))
        self.assertEqual(text, self.run_ok("-h"))
        self.assertEqual(text, self.run_ok("help", "help"))
        page = help_text.parse(text)
        self.assertEqual({c.name: c.program for c in help_text.commands_of(page)}, PROGRAMS)
        for command in help_text.commands_of(page):
            self.assertTrue(command.group)
        self.assertIn("Examples:", text)
        self.assertIn("Exit code:", text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 104, line)

    def test_help_of_a_command_goes_by_its_name(self):
        for name, program in self.built().items():
            with self.subTest(command=name):
                text = self.run_ok("help", name)
                self.assertEqual(text, self.run_ok(name, "--help"))
                self.assertIn(f"\nUsage: glissade {name} [OPTIONS]", text)
                self.assertIn(f"  glissade {name}", text.partition("Examples:")[2])
                for other in PROGRAMS.values():
                    self.assertNotRegex(text, rf"(?<![\w/]){other}\b")
                for line in text.splitlines():
                    self.assertLessEqual(len(line), 112, line)
                # And under its own name it says the same with that.
                own = subprocess.run([self.folder_of_executables / program, "--help"], capture_output=True, text=True,
                                     check=True).stdout
                self.assertIn(f"\nUsage: {program} [OPTIONS]", own)
                self.assertNotIn(f"glissade {name}", own)
                ours = {(o.name, o.type) for o in help_text.parse(text).options}
                self.assertEqual(ours, {(o.name, o.type) for o in help_text.parse(own).options})

    def test_versions(self):
        self.check_version()
        self.assertRegex(self.run_ok("solve", "--version"), r"^glissade solve \(glissade\) \d+\.\d+\.\d+\n")

    def test_work_is_the_programs(self):
        ring = ROOT / "data" / "ring.txt.gz"
        program = subprocess.run([self.folder_of_executables / "ba_solve", ring, "--output", "own.txt", "--iterations", "3"],
                                 cwd=self.folder, capture_output=True, text=True, check=True)
        self.run_ok("solve", ring, "--output", "front.txt", "--iterations", "3", "--json", "front.json")
        self.assertIn("\n", program.stdout)
        self.assertEqual((self.folder / "own.txt").read_bytes(), (self.folder / "front.txt").read_bytes())
        # The figures do not depend on the name that it was called by.
        result = strict_json((self.folder / "front.json").read_text(encoding="utf-8"))
        self.assertEqual(result["schema"], "glissade/ba_solve/1")
        self.assertEqual(result["iterations"], 3)

    def test_arguments_arrive_as_they_are(self):
        self.write("a file with 'quotes' and $signs", "1 1 1\n")
        result = self.run_app("solve", "a file with 'quotes' and $signs")
        self.assertEqual(result.returncode, 2)
        self.assertTrue(result.stderr.startswith("glissade solve: a file with 'quotes' and $signs:"), result.stderr)
        self.check_refused("window", "", says="glissade window: ")

    def test_exit_codes_are_the_programs(self):
        self.check_refused("solve", "absent.txt", says="glissade solve: absent.txt")
        self.check_refused("solve", "--nonsense", says="glissade solve: unknown option --nonsense")
        if "check" in self.built():
            self.assertEqual(self.run_app("check", ROOT / "data" / "flight").returncode, 0)

    def check_refused(self, *args, says=""):
        """One line and exit code 2, as everywhere; it may go by a command's name."""
        result = self.run_app(*args)
        self.assertEqual(result.returncode, 2, (args, result.stdout, result.stderr))
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertRegex(result.stderr, r"^glissade( \w+)?: ")
        self.assertIn(says, result.stderr)

    def test_unknown_commands(self):
        for word, meant in (("sovle", "solve"), ("slove", "solve"), ("replya", "replay"), ("windows", "window"),
                            ("rn", "run"), ("gau", "gauge"), ("ba_solve", "solve"), ("vio_run", "run"), ("hlep", "help")):
            self.check_refused(word, says=f"there is no command '{word}'; did you mean '{meant}'?")
        for word in ("nonsense", "x", "Q", "évaluer"):
            self.check_refused(word, "--help", says=f"there is no command '{word}' (see --help)")
        self.check_refused("help", "sovle", says="did you mean 'solve'?")
        self.check_refused("help", "solve", "check", says="help")
        self.check_refused(says="COMMAND is required")
        self.check_refused("--solve", says="unknown option --solve")
        self.check_refused("--vresion", says="did you mean --version?")
        self.check_refused("", says="there is no command ''")

    def test_program_that_is_not_there(self):
        alone = self.folder / "alone"
        alone.mkdir()
        shutil.copy(self.folder_of_executables / "glissade", alone)
        for name, program in PROGRAMS.items():
            done = subprocess.run([alone / "glissade", name, "--help"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stdout, "")
            self.assertEqual(done.stderr.count("\n"), 1)
            self.assertTrue(done.stderr.startswith(f"glissade: {name}: there is no {alone / program}: "), done.stderr)
            if program == "vio_run":
                self.assertRegex(done.stderr, "OpenCV|glissade-vision")
        (alone / "ba_solve").write_text("no program", encoding="utf-8")
        done = subprocess.run([alone / "glissade", "solve"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("glissade: solve: ", done.stderr)
        self.assertIn("Permission denied", done.stderr)

    def test_through_a_link(self):
        link = self.folder / "gl"
        link.symlink_to(self.folder_of_executables / "glissade")
        done = subprocess.run([link, "solve", "--version"], capture_output=True, text=True, check=True)
        self.assertTrue(done.stdout.startswith("glissade solve (glissade)"), done.stdout)

    def test_loads_nothing_but_what_it_needs(self):
        if shutil.which("ldd") is None:
            self.skipTest("no ldd")
        libraries = subprocess.run(["ldd", self.folder_of_executables / "glissade"], capture_output=True, text=True,
                                   check=True).stdout
        self.assertNotRegex(libraries, "opencv|ceres|yaml")

    def test_interrupt_goes_to_the_program(self):
        out, result = self.check_interrupt("solve", "--city", 100, "--tolerance", 0, "--iterations", 1000000, after="   2 ")
        self.assertIn("cost", out)
        self.assertGreater(result["iterations"], 0)

    def check_header(self, result, interrupted=False):
        app, self.app = self.app, "ba_solve"
        try:
            super().check_header(result, interrupted)
        finally:
            self.app = app


if __name__ == "__main__":
    main(GlissadeTest)
