#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Opens the pages of the documentation site in a browser, from the disk: nothing complains, every equation is
typeset, and on a telephone no page is wider than the screen.

    site_test.py FOLDER     (build/site/html)
"""

import pathlib
import sys
import unittest

import markdown_blocks

sys.path.insert(0, str(markdown_blocks.ROOT / "test/app"))
import browser_util  # noqa: E402

SITE = pathlib.Path()
PHONE = 400
FACTS = """({
  equations: document.querySelectorAll('.katex-source').length,
  typeset: document.querySelectorAll('.katex-source > .katex, .katex-source > .katex-display').length,
  wrong: document.querySelectorAll('.katex-error').length,
  width: document.documentElement.scrollWidth,
})"""


@unittest.skipUnless(browser_util.CHROMIUM, "no Chromium")
class Site(unittest.TestCase):
    def test_pages_in_a_browser(self):
        pages = [page for page in sorted(SITE.rglob("*.html")) if page.parent != SITE]  # search, index, redirect
        self.assertGreater(len(pages), 50)
        browser, equations = browser_util.Browser(PHONE, 800), 0
        try:
            for page in pages:
                with self.subTest(page=str(page.relative_to(SITE))):
                    browser.open(page.resolve(), "document.readyState === 'complete'")
                    self.assertEqual(browser.complaints(), [])
                    facts = browser.evaluate(FACTS)
                    self.assertEqual(facts["wrong"], 0)
                    self.assertEqual(facts["equations"], facts["typeset"])
                    self.assertLessEqual(facts["width"], PHONE)
                    equations += facts["equations"]
        finally:
            browser.close()
        self.assertGreater(equations, 50)

    def test_the_search_finds_pages(self):
        browser = browser_util.Browser(1200, 800)
        try:
            browser.call("Page.navigate", url=(SITE / "search.html").as_uri() + "?q=CheckNullspace")
            browser.wait_for("document.querySelectorAll('#search-results li a').length > 3")
            self.assertEqual(browser.complaints(), [])
        finally:
            browser.close()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    SITE = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
