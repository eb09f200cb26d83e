#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""All apps: an option, a key of a JSON file and an exit code mean the same in each (docs/programs.md)."""

import collections
import functools
import re
import sys

from app_test_util import ROOT, AppTest, main

sys.path.insert(0, str(ROOT / "scripts"))
import help_text  # noqa: E402

# Options whose text has a part of each program's own.
TEXTS = {
    "--seed": "Seed of .*",
    "--trials": "Repetitions of everything random: .*",
    "--iterations": "At most N steps( of a frame)?",
    "--keyframes": "Keyframes of a window.*",
    "--points": "Points to be seen.*",
    "--loss": "Of the observations: .* W the width in (px|sigmas)",
    "--time-offset": r"Added to the stamps of (frames|the estimate) \(s\)",
    "--save-tracks": r"Write the tracks \(VIOTRACKS\) to PATH, a folder.*",
    "--output": "Write .*",  # a solution, windows or a trajectory
    "--method": "'lm': .*",
    "--format": "(Of the image files|In which --output is written).*",
    "--rate": ".*(a|per) second.*",
}
# Options that take different things.
TYPES = {
    "--output": {"FILE", "PATH"},  # what ba_solve writes may be a folder
    "--method": {"lm|nielsen|dogleg", "lm|nielsen|dogleg|course"},  # the course's is for its scene
    "--format": {"png|jpg", "tum|euroc|kitti"},  # of what is written: images or a trajectory
}

# What takes a moment: arguments by which a program writes all its keys.
QUICK = {
    "ba_solve": ["{data}/ring.txt.gz", "--iterations", "3"],
    "window_solve": ["{data}/win10.txt.gz", "--repeat", "2"],
    "vio_replay": ["{data}/flight", "--batch", "--consistency"],
    "vio_check": ["{data}/flight"],
    "traj_eval": ["{data}/flight_odometry.txt.gz", "{data}/flight"],
    "prior_weight_sweep": ["--weights", "0,1e3"],
    "marginal_study": ["--flight", "10", "--keyframes", "4", "--points", "60"],
    "testMonoBA": [],
}
# Keys that are one thing in one place and another elsewhere.
KEYS = {
    "iterations": "testMonoBA: the table of all steps, as the course prints it; else their number",
    "covariance": "vio_replay: the time of a stage; gauge_study: the study's",
    "points": "testMonoBA: each of them; gauge_study: how they lie; else their number",
    "poses": "testMonoBA: each of them; else their number",
    "trials": "prior_weight_sweep: each of them in a row; else their number",
    "fixed": "prior_weight_sweep: whether; marginal_study: the window's whose gauge is",
    "frame": "vio_replay: the time of a frame; else its number",
    "solve": "vio_replay: the time of a stage",
    "before": "matrices, and names of what they are about",
    "going": "matrices, and names of what they are about",
    "alignment": "its kind",
    "events": "vio_replay: how many of each kind",
    "max": "of times and errors",
    "ellipses_x_y_xx_xy_yy": "numbers in the order of the name",
    "estimate": "a number with its unit beside it, or none",
}
# Ends of names of keys: the units that there are. Computing is measured in ms, recordings in s.
UNIT = re.compile(r"_(ms|s|ns|mb|m|per_m|px|hz|rad|deg|deg_per_m|mps|mps2|radps|m_rad|percent|log10|degrees?)$")
NOT_AT_THE_END = re.compile(r"(?:^|_)(ms|mb|px|hz|deg|percent|mps)(?:_(?!per_m$|rad$))")


def normalized(text):
    """Without defaults, and without what an option goes with."""
    text = re.sub(r" \((?:needs|not with) --[a-z-]+\)", "", text)
    text = re.sub(r"; default[^)]*\)", ")", text)
    text = re.sub(r" \(default[^)]*\)", "", text)
    return re.sub(r" Default: \S+", "", text).rstrip(".").strip()


def kind(value):
    if value is None:
        return None
    names = {bool: "bool", int: "number", float: "number", str: "text", list: "list", dict: "object"}
    return names[type(value)]


def keys_of(value, path=()):
    """(path, key, kind of its value) of all objects; of a list's first element alone."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield path, key, kind(inner)
            yield from keys_of(inner, (*path, key))
    elif isinstance(value, list) and value:
        yield from keys_of(value[0], path)


class AllAppsTest(AppTest):
    @functools.cached_property
    def programs(self):
        folder = self.folder_of_executables
        names = help_text.program_names(folder, ROOT / "app")
        self.assertGreater(len(names), 3)
        return {name: help_text.parse(help_text.ask(folder / name)) for name in names}

    def test_an_option_means_the_same_everywhere(self):
        uses = collections.defaultdict(dict)
        for program, page in self.programs.items():
            self.assertTrue(page.options, program)
            for option in page.options:
                self.assertTrue(option.text, (program, option.name))
                uses[option.name][program] = option
        shared = 0
        for name, by_program in uses.items():
            with self.subTest(option=name, programs=sorted(by_program)):
                types = {o.type for o in by_program.values()}
                self.assertLessEqual(types, TYPES.get(name, set(list(types)[:1])))
                texts = {normalized(o.text) for o in by_program.values()}
                if name in TEXTS:
                    for text in texts:
                        self.assertRegex(text, rf"^{TEXTS[name]}$")
                else:
                    self.assertEqual(len(texts), 1, texts)
                shared += len(by_program) > 1
        self.assertGreater(shared, 12)
        if {"vio_run", "marginal_study"} <= set(self.programs):  # nothing was left out of the build
            self.assertLessEqual(set(TEXTS) | set(TYPES), set(uses))

    def test_unknown_options_are_refused_in_one_line(self):
        for program in self.programs:
            with self.subTest(program=program):
                self.app = program
                self.check_refused("--no-such-option", says="unknown option --no-such-option")
                self.check_refused("--no-such-option=3", says="unknown option --no-such-option")
                self.check_refused("-Q", says="unknown option -Q")
                self.check_refused("--versoin", says="; did you mean --version?")

    def test_help_and_version(self):
        for program, page in self.programs.items():
            with self.subTest(program=program):
                self.app = program
                self.assertEqual(page.name, program)
                self.assertTrue(page.examples)
                self.assertRegex(page.exit_code, r"^(0|that of the command)\b.*\b2 where")
                self.assertEqual(page.option("--help").names, ["-h", "--help"])
                self.check_version()
                for option in page.options:
                    self.assertRegex(option.name, r"^--[a-z]+(-[a-z]+)*$")
                    self.assertRegex(option.type, r"^(|N|X|X,X,\.\.\.|FILE|DIR|PATH|SIZE|WxH|FAULT|[a-z0-9:W|-]+)$")

    def test_a_key_means_the_same_everywhere(self):
        kinds = collections.defaultdict(dict)
        run = 0
        for program, arguments in QUICK.items():
            if program not in self.programs:
                continue
            self.app = program
            result = self.run_json(*(a.format(data=ROOT / "data") for a in arguments))
            run += 1
            for path, key, what in keys_of(result):
                with self.subTest(program=program, key=key):
                    self.assertRegex(key, r"^[a-z][a-z0-9_]*$")
                    if NOT_AT_THE_END.search(key):
                        self.assertRegex(key, UNIT)
                        self.assertEqual(len(NOT_AT_THE_END.findall(key)), 0, "units end the names of keys")
                if what is not None and not (path and path[-1] == "events"):
                    kinds[key].setdefault(what, set()).add(program)
        self.assertGreater(run, 3)
        for key, by_kind in kinds.items():
            if key not in KEYS:
                self.assertEqual(len(by_kind), 1, (key, dict(by_kind)))
        # One name for the time of a solve, whole numbers of steps, and what was asked for.
        for key in ("time_s", "solve_time_s", "ms", "seconds", "num_trials", "n_iterations"):
            self.assertNotIn(key, kinds)

    def test_files_that_make_no_sense(self):
        """Exit code 2 and one line, whatever takes a file or a folder."""
        takes_file = {name: page for name, page in self.programs.items()
                      if page.arguments and name not in ("make_data", "sim_images", "glissade")}
        self.assertGreater(len(takes_file), 2)
        for program, page in takes_file.items():
            with self.subTest(program=program):
                self.app = program
                self.check_refused(*(["no/such/thing"] * len(page.arguments)), says="no/such/thing")
                if page.option("--json"):
                    self.check_refused(*(["x"] * len(page.arguments)), "--json", "no/such/folder/x.json", says="--json")


if __name__ == "__main__":
    main(AllAppsTest)
