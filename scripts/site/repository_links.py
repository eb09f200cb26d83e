# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Links from a page to a file of the repository lead to that file's page of the site, where collect_pages.py
made one; in the Markdown they are relative paths, which a git forge follows by itself."""

import posixpath

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms import SphinxTransform


class RepositoryLinks(SphinxTransform):
    default_priority = 5  # before Sphinx makes downloads of them

    def apply(self):
        here = posixpath.dirname(self.env.docname)
        for node in list(self.document.findall(
                lambda n: isinstance(n, (addnodes.download_reference, addnodes.pending_xref)))):
            if node.get("reftype") != "myst":
                continue
            page = posixpath.normpath(posixpath.join(here, node["reftarget"]))
            if isinstance(node, addnodes.pending_xref):
                page += "/index"  # a folder
            if page not in self.env.found_docs:
                continue
            link = nodes.reference("", "", internal=True,
                                   refuri=self.app.builder.get_relative_uri(self.env.docname, page))
            link += node.children
            node.replace_self(link)


def setup(app):
    app.add_transform(RepositoryLinks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
