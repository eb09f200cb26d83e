# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Code blocks of README.md and docs/, for the tests that compile and run them."""

import dataclasses
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"(?:^<!-- (?P<says>[^\n]*?) -->\n)?^```(?P<language>[a-z+]*)\n(?P<code>.*?)^```$",
                   re.MULTILINE | re.DOTALL)
LANGUAGES = {"c++": "cpp"}


@dataclasses.dataclass
class Block:
    page: pathlib.Path
    line: int        # of its first line of code
    language: str
    says: str        # the comment before it, without the brackets
    code: str

    @property
    def where(self):
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page):
    """All fenced blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    return [Block(page, text.count("\n", 0, match.start("code")) + 1,
                  LANGUAGES.get(match["language"], match["language"]), match["says"] or "", match["code"])
            for match in FENCE.finditer(text)]


def is_program(page):
    """Whether the page says that its C++, from top to bottom, is one program."""
    return "<!-- page: one program -->" in page.read_text(encoding="utf-8")


def missing_lines(wanted, printed):
    """Lines of `wanted` that `printed` does not have in this order. A line "..." stands for any number."""
    rest, missing = [line.strip() for line in printed.splitlines()], []
    for line in filter(None, map(str.strip, wanted.splitlines())):
        if line == "...":
            continue
        if line in rest:
            rest = rest[rest.index(line) + 1:]
        else:
            missing.append(line)
    return missing
