#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_wheel.sh [BUILD_FOLDER]
#
# Builds the wheel, repairs it by auditwheel, installs it in an empty virtual environment away from the
# sources, and runs the tests of the package and mypy there. With a build folder (of CMake's default
# generator, configured with GLISSADE_BUILD_PYTHON=ON) what is compiled there is taken; it is then one
# without tests and apps.
source "$(dirname "${BASH_SOURCE[0]}")/lib_setup.sh"
need_python
[[ $python_venv ]] || { say "no Python environment: the wheel is not checked"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python=$python_venv/bin/python

start=$SECONDS
options=()
if (($#)); then
  generator=$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' "$1/CMakeCache.txt")
  export CMAKE_GENERATOR="$generator"
  options=(--no-build-isolation -C "build-dir=$(realpath "$1")" -C cmake.define.GLISSADE_WHEEL_OF_BUILD=ON)
fi
CMAKE_BUILD_PARALLEL_LEVEL=$jobs "$python" -m pip wheel -q --disable-pip-version-check --no-deps \
  "${options[@]}" -w "$work/wheel" .
say "wheel built in $((SECONDS - start)) s: $(basename "$work"/wheel/*.whl)"

PATH=$python_venv/bin:$PATH "$python" -m auditwheel repair -w "$work/repaired" "$work"/wheel/*.whl >"$work/repair.log" 2>&1 || { cat "$work/repair.log" >&2; die "auditwheel failed"; }
say "repaired: $(basename "$work"/repaired/*.whl), $(du -k "$work"/repaired/*.whl | cut -f1) KiB"

"$python" -m venv --system-site-packages "$work/venv"
# What the tests need is in the environment that the wheel was built with; the package is not.
"$work/venv/bin/python" -m pip install -q --disable-pip-version-check --no-deps "$work"/repaired/*.whl
site=$("$python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')
echo "$site" >"$("$work/venv/bin/python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')/test_tools.pth"
cp -r test/python "$work/tests"
cd "$work"
where=$(env -u PYTHONPATH "$work/venv/bin/python" -c 'import glissade; print(glissade.__file__)')
[[ $where == "$work/venv"/* ]] || die "the package was imported from $where"
GLISSADE_SOURCE=$OLDPWD "$work/venv/bin/python" -m pytest -q -p no:cacheprovider -k "not notebook" "$work/tests"
"$work/venv/bin/python" -m mypy --strict --cache-dir "$work/mypy" -p glissade
