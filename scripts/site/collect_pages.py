#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collects the pages of the site in one folder, laid out as the repository is: docs/ and the other Markdown
files as they are, and pages that are made: of the C++ and Python references, of the programs' help, of source
files that pages link to. contents.md, the order of the pages, is put at the end of the first one.

    collect_pages.py SOURCE [--python PACKAGE] [--programs FOLDER]
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys

import python_reference

ROOT = pathlib.Path(__file__).resolve().parents[2]
LANGUAGES = {".cpp": "cpp", ".h": "cpp", ".py": "python", ".sh": "bash", ".txt": "cmake", ".yml": "yaml", ".json": "json"}


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def markdown_files():
    """Pages written by hand, from the root of the repository."""
    yield from (ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "data/README.md"))
    yield from sorted((ROOT / "docs").rglob("*.md"))


def linked_files():
    """Files and folders of the repository that pages link to and that are no pages."""
    for page in markdown_files():
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for target in re.findall(r"(?<!!)\[[^\]]*\]\(([^)#\s:]+)(?:#[^)]*)?\)", text):
            path = (page.parent / target).resolve()
            if path.exists() and path.is_relative_to(ROOT) and path.suffix not in (".md", ".png"):
                yield path


def source_pages(target):
    """A page for each of them, and one for each folder with what is in it."""
    for path in sorted(set(linked_files())):
        files = sorted(p for p in path.iterdir() if p.suffix in LANGUAGES) if path.is_dir() else [path]
        for file in files:
            inside = file.relative_to(ROOT)
            # Six backticks: a comment of the file may hold three.
            code = file.read_text(encoding="utf-8").rstrip()
            write(target / f"{inside}.md", f"---\norphan: true\n---\n# {inside}\n\n"
                  f"``````{LANGUAGES.get(file.suffix, 'text')}\n{code}\n``````\n")
            shutil.copy2(file, target / inside)
        if path.is_dir():
            links = "".join(f"- [{file.name}]({file.name}.md)\n" for file in files)
            write(target / path.relative_to(ROOT) / "index.md",
                  f"---\norphan: true\n---\n# {path.relative_to(ROOT)}\n\n{links}")


def toctree(names, options=""):
    return f"\n```{{toctree}}\n:hidden:\n:titlesonly:\n{options}\n" + "\n".join(names) + "\n```\n" if names else ""


def cpp_pages(target):
    """A page for each module of the table in docs/architecture.md that has public headers."""
    table = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    about = {}
    for names, text in re.findall(r"^\| ((?:`\w+`(?:, )?)+) \| (.+) \|$", table, re.MULTILINE):
        for name in re.findall(r"`(\w+)`", names):
            about[name] = text
    modules = sorted({path.relative_to(ROOT / "include/glissade").parts[0].removesuffix(".h")
                      for path in (ROOT / "include/glissade").rglob("*.h")} - {"structure", "glissade", "version"})
    missing = [name for name in modules if name not in about]
    if missing:
        raise SystemExit(f"docs/architecture.md does not list {', '.join(missing)}")
    order = [name for name in about if name in modules]
    rows = "\n".join(f"| [{name}]({name}.md) | {about[name]} |" for name in order)
    index = ("# C++ reference\n\nWhat the public headers declare, and what they say about it. Everything that is needed to "
             "build and solve a problem comes with `#include <glissade/glissade.h>`; the modules `io`, `sim`, `window`, "
             "`vision`, `testing` and `bridge` are included by name. Begin with [problem](problem.md), "
             "[graph](graph.md) and [minimizer](minimizer.md); for odometry with [window](window.md).\n\n"
             f"| module | what lives there |\n|---|---|\n{rows}\n")
    write(target / "index.md", index + toctree(order))
    for name in order:
        write(target / f"{name}.md", f"# {name}\n\n{about[name]}.\n\n```{{cpp-module}} {name}\n```\n")
    return order


def python_pages(target, package):
    found = python_reference.modules(str(package) if package else "")
    if not found:
        write(target / "index.md", "# Python reference\n\nThis build of the site found no stubs of the package "
              "(`python/glissade/*.pyi`), from which its reference is made: build the package first.\n")
        return []
    rows = "\n".join(f"| [`{'glissade.' * bool(name)}{name or 'glissade'}`]({name or 'glissade'}.md) | "
                     f"{text.split(chr(10))[0].replace('|', chr(92) + '|')} |" for name, (text, _) in sorted(found.items()))
    write(target / "index.md", "# Python reference\n\n`import glissade as gl`. Arrays are numpy's, of float64, a row per "
          f"thing; units are SI.\n\n| module | |\n|---|---|\n{rows}\n" + toctree([name or "glissade" for name in sorted(found)]))
    for name in found:
        write(target / f"{name or 'glissade'}.md",
              f"# {'glissade.' * bool(name)}{name or 'glissade'}\n\n```{{python-module}} {name or 'glissade'}\n```\n")
    return sorted(name or "glissade" for name in found)


def program_pages(target, folder):
    """Of what each says with --help, by the script that makes the manual pages of it."""
    names = [path.stem for path in (ROOT / "app").glob("*.cpp") if folder and (folder / path.stem).is_file()]
    if not names:
        write(target / "index.md", "# Programs\n\nThis build of the site found none of the programs, whose help stands "
              "here: build them first, or name their folder.\n")
        return []
    subprocess.run([sys.executable, ROOT / "scripts/make_man.py", "--markdown", target, folder], check=True)
    made = sorted(path.stem for path in target.glob("*.md") if path.stem != "index")
    with open(target / "index.md", "a", encoding="utf-8") as index:
        index.write(toctree(made))
    return made


def order_of_pages(source):
    """contents.md, and at the end what it does not name."""
    text = (pathlib.Path(__file__).parent / "contents.md").read_text(encoding="utf-8")
    pages = [str(path.relative_to(source / "docs").with_suffix("")) for path in sorted((source / "docs").rglob("*.md"))]
    more = [page for page in pages if page != "index" and not re.search(rf"^{page}$", text, re.MULTILINE)]
    return text + toctree(more, ":caption: More\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--python", type=pathlib.Path)
    parser.add_argument("--programs", type=pathlib.Path)
    arguments = parser.parse_args()
    source = arguments.source
    if source.exists():
        shutil.rmtree(source)
    source.mkdir(parents=True)
    for path in markdown_files():
        link = source / path.relative_to(ROOT)
        link.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, link)
    shutil.copytree(ROOT / "docs/images", source / "docs/images")
    with open(source / "docs/index.md", "a", encoding="utf-8") as index:
        index.write(order_of_pages(source))
    source_pages(source)
    cpp = cpp_pages(source / "reference/cpp")
    python = python_pages(source / "reference/python", arguments.python)
    programs = program_pages(source / "reference/programs", arguments.programs)
    print(f"collected {len(list(source.rglob('*.md')))} pages: {len(cpp)} modules of C++, {len(python)} of Python, "
          f"{len(programs)} programs")


if __name__ == "__main__":
    main()
