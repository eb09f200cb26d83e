#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/check_docs_figures.py: a number that is no longer true is found, and written as it is."""

import importlib.util
import json
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("figures", ROOT / "scripts/check_docs_figures.py")
figures = importlib.util.module_from_spec(spec)
spec.loader.exec_module(figures)

RESULTS = {"sweep": {"rows": [{"weight": 1, "iterations": 39}, {"weight": 2, "iterations": 6}],
                     "error": 3.6e-10, "rms": 0.01234, "less": -0.0042}}


def check(document, text, values, write=False, **how):
    """Messages, and the document afterwards."""
    documents = {"d.md": document}
    figure = {"doc": "d.md", "text": text, "values": values, **how}
    return figures.check(figure, RESULTS, documents, write), documents["d.md"]


class Figures(unittest.TestCase):
    def test_a_number_that_is_no_longer_true_is_found(self):
        text, values = "takes @ iterations", ["row(sweep['rows'], weight=1)['iterations']"]
        self.assertEqual(check("It takes 39 iterations.", text, values)[0], [])
        wrong, document = check("one\nIt takes 53.5\niterations.", text, values)
        self.assertEqual(len(wrong), 1)
        self.assertIn("d.md:2: 53.5 is 39", wrong[0])
        self.assertEqual(document, "one\nIt takes 53.5\niterations.")

    def test_it_is_written_with_as_many_digits(self):
        for before, after, value in ((".0200 m", ".0123 m", "sweep['rms']"),
                                     ("1e-3 m", "1e-2 m", "sweep['rms']"),
                                     ("2.00e-10 m", "3.60e-10 m", "sweep['error']"),
                                     ("+.010 m", "-.004 m", "sweep['less']"),
                                     ("7 m", "0 m", "sweep['rms']")):
            wrong, document = check(f"an error of {before}", "an error of @ m", [value], write=True)
            self.assertEqual(len(wrong), 1, before)
            self.assertEqual(document, f"an error of {after}")

    def test_numbers_that_are_rounding_have_a_factor(self):
        value = ["sweep['error']"]
        self.assertEqual(check("to 2e-10 m", "to @ m", value, factor=3)[0], [])
        self.assertEqual(len(check("to 1e-10 m", "to @ m", value, factor=3)[0]), 1)
        self.assertEqual(len(check("to 2e-9 m", "to @ m", value, factor=3)[0]), 1)
        self.assertEqual(len(check("to 0 m", "to @ m", value, factor=3)[0]), 1)

    def test_tolerances(self):
        value = ["sweep['rms']"]
        self.assertEqual(check("0.0123 m", "@ m", value)[0], [])  # what it rounds to
        self.assertEqual(len(check("0.0130 m", "@ m", value)[0]), 1)
        self.assertEqual(check("0.0130 m", "@ m", value, tolerance=0.06)[0], [])
        self.assertEqual(check("0.0130 m", "@ m", value, absolute=0.001)[0], [])

    def test_a_sentence_that_is_gone_is_found(self):
        wrong, _ = check("something else", "takes @ iterations", ["1"])
        self.assertIn("does not say", wrong[0])

    def test_cells_in_between(self):
        self.assertEqual(check("| 1 | whatever | 39 |", "| 1 | ... | @ |", ["39"])[0], [])

    def test_every_figure_is_in_its_document_and_has_a_command(self):
        table = json.loads((ROOT / "docs/figures.json").read_text(encoding="utf-8"))
        self.assertGreater(len(table["figures"]), 20)
        for figure in table["figures"]:
            self.assertIn(figure["command"], table["commands"])
            text = (ROOT / figure["doc"]).read_text(encoding="utf-8")
            match = figures.pattern_of(figure["text"]).search(text)
            self.assertIsNotNone(match, figure["text"])
            self.assertEqual(len(match.groups()), len(figure["values"]), figure["text"])

    def test_every_picture_of_the_docs_is_made_by_a_script(self):
        scripts = "".join(path.read_text(encoding="utf-8")
                          for path in (ROOT / "scripts").glob("*") if path.suffix in (".py", ".sh"))
        shown = set()
        for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md")):
            for name in re.findall(r"\]\((?:docs/|\.\./)?images/(\w+)\.png\)", path.read_text(encoding="utf-8")):
                shown.add(name)
                self.assertTrue((ROOT / "docs/images" / f"{name}.png").is_file(), name)
                stem = re.sub(r"^gauge_study_real_.*", "gauge_study_real_", name)
                known = stem in scripts or re.search(rf'to\(f?"{stem.removeprefix("gauge_study_")}',
                                                     scripts)
                self.assertTrue(known, f"{name}.png of {path.name} is made by no script")
        for path in (ROOT / "docs/images").glob("*.png"):
            if not path.stem.startswith("gauge_study_real_"):
                self.assertIn(path.stem, shown, "a picture that no page shows")


if __name__ == "__main__":
    unittest.main()
