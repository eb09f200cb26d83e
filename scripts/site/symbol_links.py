# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Names in `code` that the reference knows lead to it: `SolveOptions::max_iterations`, `SetFixed`,
`Huber{1.0}`, `problem.add_poses()`, `vio_replay --batch`. Of a name that several have the first of MEANT is meant,
or none."""

import collections
import pathlib
import re

from docutils import nodes
from sphinx.transforms.post_transforms import SphinxPostTransform

import cpp_reference
import doxygen_xml
import python_reference

MEANT = ("Problem", "Graph", "SlidingWindow", "SolveOptions", "SolveSummary", "IterationSummary", "SlidingWindowOptions",
         "Termination", "StatusCode")
NAME = re.compile(r"(?:glissade::|gl\.|glissade\.)?(~?[A-Za-z_][\w.]*(?:::\w+)*)(?:[({<].*)?$", re.DOTALL)
# Words that are members' names too, and mostly mean something else.
TOO_PLAIN = {"ok", "size", "empty", "begin", "end", "data", "name", "x", "y", "p", "q", "R", "J", "b", "H", "r", "u", "v", "w",
             "edge", "vertex", "pose", "point", "points", "edges", "weight", "code", "kind", "value", "id", "rows", "cost"}


def walk(entities):
    for entity in entities:
        yield entity
        yield from walk(entity.members)


def programs(app):
    """{how one calls it: (page, "")}, of the programs' pages."""
    for path in (pathlib.Path(app.srcdir) / "reference/programs").glob("*.md"):
        text = path.read_text(encoding="utf-8")
        for name in re.findall(r"^# (\S+(?: \S+)?)$|^The program `(\w+)` by another name", text, re.MULTILINE):
            if path.stem != "index":
                yield "".join(name), (f"reference/programs/{path.stem}", "")


def index_of(app):
    """{what one writes: (page, anchor)}."""
    places, short, types = dict(programs(app)), collections.defaultdict(set), set()
    for header, entities in doxygen_xml.headers(app.config.doxygen_xml).items():
        page = f"reference/cpp/{header.split('/')[1].removesuffix('.h')}"
        places[header] = places[header.removeprefix("glissade/")] = (page, cpp_reference.header_anchor(header))
        for entity in walk(entities):
            places.setdefault(entity.name, (page, entity.anchor))
            if entity.kind not in ("function", "variable"):
                types.add(entity.name)
            if "::" in entity.name:
                short[entity.name.rpartition("::")[2]].add(entity.name)
    for name, entity in python_reference.names(app.config.python_package).items():
        places.setdefault(name, entity)
        if "." in name:
            short[name.rpartition(".")[2]].add(name)
    for name, owners in short.items():
        if name in TOO_PLAIN:
            continue
        # In Python a member's name alone is mostly that of an argument.
        only = [owner for owner in owners if len(owners) == 1 and "." not in owner]
        meant = [f"{kind}{dot}{name}" for kind in MEANT for dot in ("::", ".") if f"{kind}{dot}{name}" in owners]
        if meant and name not in types:
            places[name] = places[meant[0]]  # Problem::Solve, not the function that it calls
        elif only:
            places.setdefault(name, places[only[0]])
    return places


class SymbolLinks(SphinxPostTransform):
    default_priority = 900
    formats = ("html",)

    def run(self):
        places = self.app.glissade_symbols
        for literal in list(self.document.findall(nodes.literal)):
            if isinstance(literal.parent, (nodes.reference, nodes.title)) or not isinstance(literal.parent, nodes.Element):
                continue
            found = NAME.match(literal.astext())
            text = literal.astext().removeprefix("include/")
            place = places.get(text) or found and places.get(found.group(1)) or called(text, places)
            if not place:
                continue
            page, anchor = place
            own = page == self.env.docname
            if own and (not anchor or any(anchor in p["ids"] for p in ancestors_signatures(literal))):
                continue  # its own description
            uri = self.app.builder.get_relative_uri(self.env.docname, page) if page != self.env.docname else ""
            link = nodes.reference("", "", internal=True, refuri=f"{uri}#{anchor}" if anchor else uri, classes=["symbol"])
            literal.replace_self(link)
            link += literal


def called(text, places):
    """The page of a program that is called with arguments."""
    words = text.split()
    for k in (2, 1):
        place = places.get(" ".join(words[:k])) if len(words) > k else None
        if place and not place[1]:
            return place
    return None


def ancestors_signatures(node):
    while node.parent is not None:
        node = node.parent
        if node.tagname == "desc":
            yield node[0]


def setup(app):
    app.add_post_transform(SymbolLinks)
    app.connect("builder-inited", lambda app: setattr(app, "glissade_symbols", index_of(app)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
