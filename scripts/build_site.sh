#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The documentation as pages to read, in build/site/html: tutorial, guides, theory, and the references of
# C++, Python and the programs. Installs Doxygen, KaTeX (Debian, Ubuntu) and Sphinx (in build/site-venv)
# where they are missing; after that it needs no network. Warnings are errors, and so are links to nothing.
#
#     scripts/build_site.sh [FOLDER_OF_THE_PROGRAMS [PYTHON_PACKAGE_WITH_STUBS]]
#
# By default those of build/release, and the package that was built last below build/, or its sources.
source "$(dirname "${BASH_SOURCE[0]}")/lib_setup.sh"

need_packages "${packages_site[@]}"
need_site
programs=${1:-build/release/bin}
stubs=$(find build -path '*/glissade/_core.pyi' -printf '%T@ %h\n' 2>/dev/null | sort -n | tail -n 1 | cut -d ' ' -f 2-)
package=${2:-${stubs:-python/glissade}}
site=build/site
mkdir -p "$site"

doxygen scripts/site/Doxyfile >"$site/doxygen.log" 2>&1 || { cat "$site/doxygen.log" >&2; die "Doxygen failed"; }
# Specializations of std::hash are left out, and Doxygen says so.
if grep -E 'warning|error' "$site/doxygen.log" | grep -v 'class std::hash'; then die "Doxygen's warnings are errors"; fi

build/site-venv/bin/python scripts/site/collect_pages.py "$site/source" --python "$package" --programs "$programs"
rm -rf "$site/html" "$site/doctrees"
build/site-venv/bin/sphinx-build -q -W --keep-going -j "$jobs" -c scripts/site -d "$site/doctrees" -D doxygen_xml="$site/doxygen" \
  -D python_package="$package" "$site/source" "$site/html"
printf '<!doctype html><meta charset="utf-8"><title>glissade</title><meta http-equiv="refresh" content="0; url=docs/index.html">\n' \
  >"$site/html/index.html"
build/site-venv/bin/python scripts/check_links.py "$site/html"
say "the site is in $site/html, its first page is $site/html/index.html"
