#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/check_links.py on pages that are wrong; and links between the Markdown files, which need no site: the
files and the headings that they name are there."""

import importlib.util
import pathlib
import re
import tempfile
import unittest

import markdown_blocks

ROOT = markdown_blocks.ROOT
spec = importlib.util.spec_from_file_location("check_links", ROOT / "scripts/check_links.py")
check_links = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check_links)


def anchors(path):
    """Of the headings of a Markdown file, as a git forge makes them."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        yield re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


class Links(unittest.TestCase):
    def check(self, **pages):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in pages.items():
                (pathlib.Path(folder) / f"{name}.html").write_text(text, encoding="utf-8")
            return check_links.check(pathlib.Path(folder))

    def test_links_to_nothing_are_found(self):
        wrong, external = self.check(a='<a href="b.html#here">b</a> <a href="b.html#there">b</a> <a href="c.html">c</a>'
                                       '<a href="https://example.org/x">x</a>', b='<h1 id="here">b</h1>')
        self.assertEqual(len(wrong), 2, wrong)
        self.assertIn("b.html#there", wrong[0])
        self.assertIn("c.html", wrong[1])
        self.assertEqual(external, {"https://example.org/x": "a.html"})

    def test_what_is_taken_from_the_network_is_found(self):
        wrong, _ = self.check(a='<script src="https://cdn.example.org/x.js"></script><link rel="canonical" href="https://a.org">'
                                '<img src="//example.org/a.png">')
        self.assertEqual(len(wrong), 2, wrong)

    def test_links_of_the_markdown_files(self):
        checked = 0
        for page in [*markdown_blocks.pages(), ROOT / "CONTRIBUTING.md", ROOT / "data/README.md"]:
            text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
            for target in re.findall(r"\[[^\]]*\]\(([^)\s]+)\)", text):
                if re.match(r"[a-z]+:", target):
                    continue
                with self.subTest(page=str(page.relative_to(ROOT)), link=target):
                    name, _, anchor = target.partition("#")
                    path = (page.parent / name).resolve() if name else page
                    self.assertTrue(path.exists(), "there is no such file")
                    if anchor and path.suffix == ".md":
                        self.assertIn(anchor, set(anchors(path)), "there is no such heading")
                    checked += 1
        self.assertGreater(checked, 100)


if __name__ == "__main__":
    unittest.main()
