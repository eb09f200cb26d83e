# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Blocks of C++ and Python, one right after the other, become tabs; the reader's choice holds for all pages.
In the Markdown they are two plain blocks, as a git forge shows them."""

from docutils import nodes
from sphinx.transforms import SphinxTransform
from sphinx_design.shared import create_component

LABELS = {"cpp": "C++", "python": "Python"}


def language(node):
    return node.get("language") if isinstance(node, nodes.literal_block) else None


def tabs_of(blocks):
    tabs = create_component("tab-set", classes=["sd-tab-set"])
    for block in blocks:
        item = create_component("tab-item", classes=["sd-tab-item"])
        label = nodes.rubric("", LABELS[language(block)], classes=["sd-tab-label"])
        label["sync_group"], label["sync_id"] = "language", language(block)
        content = create_component("tab-content", classes=["sd-tab-content"])
        content += block
        item += [label, content]
        tabs += item
    return tabs


class LanguageTabs(SphinxTransform):
    default_priority = 400

    def apply(self):
        for block in list(self.document.findall(nodes.literal_block)):
            if language(block) != "cpp" or block.parent is None:
                continue
            parent = block.parent
            others = [n for n in parent.children[parent.index(block) + 1:] if not isinstance(n, nodes.comment)]
            if others and language(others[0]) == "python":
                parent.remove(others[0])
                parent.replace(block, tabs_of([block, others[0]]))


def setup(app):
    app.add_transform(LanguageTabs)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
