#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the links of a folder of HTML pages: every file and every anchor that a page points to is there,
and a page takes nothing from the network (scripts, styles, fonts, pictures). Links to other sites are counted,
listed by --external, and asked for by --online.

    check_links.py FOLDER [--external] [--online]
"""

import argparse
import concurrent.futures
import html.parser
import pathlib
import re
import sys
import urllib.parse
import urllib.request

TAKEN = {("script", "src"), ("img", "src"), ("link", "href"), ("source", "src"), ("iframe", "src")}
# <link rel> that name another page and load nothing.
ONLY_NAMED = {"next", "prev", "index", "search", "canonical", "author", "license"}


class Page(html.parser.HTMLParser):
    """Anchors of a page, where it points to, and what it loads."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loads = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        for name in ("id", "name") if tag == "a" else ("id",):
            if attrs.get(name):
                self.anchors.add(attrs[name])
        for name in ("href", "src"):
            if attrs.get(name) and tag != "base":
                self.links.append(attrs[name])
                if (tag, name) in TAKEN and attrs.get("rel") not in ONLY_NAMED:
                    self.loads.append(attrs[name])
        if tag == "meta" and attrs.get("http-equiv") == "refresh":
            self.links.append(attrs["content"].partition("url=")[2])


def read_pages(folder):
    return {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}


def check(folder):
    """(messages, {external link: a page that has it})."""
    pages, wrong, external = read_pages(folder), [], {}
    for path, page in pages.items():
        shown = path.relative_to(folder.resolve())
        wrong += [f"{shown} loads {load} from the network" for load in page.loads if re.match(r"(https?:)?//", load)]
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme in ("http", "https"):
                external.setdefault(link, str(shown))
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                wrong.append(f"{shown}: {link}: there is no such file")
            elif parts.fragment and target in pages and \
                    urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                wrong.append(f"{shown}: {link}: there is no such anchor")
    for style in folder.rglob("*.css"):
        for load in re.findall(r"url\(['\"]?((?:https?:)?//[^)'\"]+)", style.read_text(encoding="utf-8")):
            wrong.append(f"{style.relative_to(folder)} loads {load} from the network")
    return sorted(set(wrong)), external


def ask(link):
    """None, or what is wrong with an address."""
    try:
        request = urllib.request.Request(link, headers={"User-Agent": "check_links"})
        with urllib.request.urlopen(request, timeout=20):
            return None
    except OSError as error:
        return f"{link}: {error}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--external", action="store_true", help="list the links to other sites")
    parser.add_argument("--online", action="store_true", help="ask for them, too")
    arguments = parser.parse_args()
    wrong, external = check(arguments.folder)
    if arguments.external:
        for link, page in sorted(external.items()):
            print(f"{link}  ({page})")
    if arguments.online:
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            wrong += filter(None, pool.map(ask, sorted(external)))
    for message in wrong:
        print(message, file=sys.stderr)
    pages = len(list(arguments.folder.rglob("*.html")))
    print(f"{pages} pages, {len(external)} links to other sites, {len(wrong)} wrong links")
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
