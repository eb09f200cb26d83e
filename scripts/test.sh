#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test.sh [CTEST ARGUMENT...]
#
# Installs what is missing (Debian 12, Ubuntu 22.04 or newer), builds everything and runs the tests.
# GLISSADE_CMAKE_ARGS holds further arguments for cmake.
source "$(dirname "${BASH_SOURCE[0]}")/lib_setup.sh"

need_packages "${packages_build[@]}" "${packages_app[@]}" "${packages_test[@]}"
need_packages --optional "${packages_optional[@]}"
need_packages --optional "${packages_browser[@]}"
need_evo
need_plotly
need_python
# shellcheck disable=SC2086
configure release -DGLISSADE_BUILD_TESTS=ON -DGLISSADE_BUILD_APPS=ON \
  ${python_venv:+-DGLISSADE_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$python_venv/bin/python"} \
  ${python_venv:+"-DPython3_EXECUTABLE=$python_venv/bin/python"} ${GLISSADE_CMAKE_ARGS:-}
say "building everything with $jobs jobs"
cmake --build --preset release -j "$jobs" || die "the build failed (its output is above)"
say "running the tests"
ctest --preset release -j "$jobs" "$@"
