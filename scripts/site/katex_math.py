# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Equations by KaTeX, from the files of Debian's libjs-katex: nothing is fetched when a page is read."""

import pathlib
import shutil

from docutils import nodes

KATEX = pathlib.Path("/usr/share/javascript/katex")


def visit_inline(translator, node):
    translator.body.append(translator.starttag(node, "span", "", CLASS="katex-source"))
    translator.body.append(translator.encode(node.astext()) + "</span>")
    raise nodes.SkipNode


def visit_block(translator, node):
    translator.body.append(translator.starttag(node, "div", "", CLASS="katex-source katex-block"))
    translator.body.append(translator.encode(node.astext()) + "</div>")
    raise nodes.SkipNode


def use_where_needed(app, pagename, templatename, context, doctree):
    if doctree is not None and next(iter(doctree.findall(
            lambda node: isinstance(node, (nodes.math, nodes.math_block)))), None) is not None:
        app.add_css_file("katex/katex.min.css")
        app.add_js_file("katex/katex.min.js")
        app.add_js_file("math.js")


def copy_files(app, exception):
    if exception or app.builder.format != "html":
        return
    target = pathlib.Path(app.outdir) / "_static/katex"
    target.mkdir(parents=True, exist_ok=True)
    for name in ("katex.min.css", "katex.min.js"):
        shutil.copyfile(KATEX / name, target / name)
    (target / "fonts").mkdir(exist_ok=True)
    for font in (KATEX / "fonts").glob("*.woff2"):
        shutil.copyfile(font, target / "fonts" / font.name)


def setup(app):
    app.add_html_math_renderer("katex", (visit_inline, None), (visit_block, None))
    app.config.html_math_renderer = "katex"
    app.connect("html-page-context", use_where_needed)
    app.connect("build-finished", copy_files)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
