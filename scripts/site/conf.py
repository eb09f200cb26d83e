# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings for the documentation site. Built by scripts/build_site.sh, which collects the pages in
build/site/source first."""

import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

version_header = (ROOT / "include/glissade/version.h").read_text(encoding="utf-8")
project = "glissade"
author = "The glissade authors"
copyright = "2026, " + author  # noqa: A001 (Sphinx's name)
release = version = ".".join(re.findall(r"#define GLISSADE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", version_header))

extensions = ["myst_parser", "sphinx_design", "sphinx_copybutton",
              "repository_links", "language_tabs", "katex_math", "cpp_reference", "python_reference", "symbol_links"]
root_doc = "docs/index"
exclude_patterns = []
nitpicky = True

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 5  # as a git forge makes them
myst_dmath_double_inline = True
highlight_language = "none"
smartquotes = False  # they make dashes of "--option", and quotation marks of R'

html_theme = "furo"
html_title = "glissade"
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_search_summary = False  # they are fetched, which a browser refuses for pages on a disk
html_theme_options = {
    "light_css_variables": {"code-font-size": "0.78em", "color-brand-primary": "#0b5fa5", "color-brand-content": "#0b5fa5"},
    "dark_css_variables": {"color-brand-primary": "#6cb6ff", "color-brand-content": "#6cb6ff"},
}
