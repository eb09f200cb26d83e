#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_deb.sh BUILD_DIR [--with-vision]
#
# Makes Debian packages of what has been built in BUILD_DIR, installs them in a fresh Debian of the same
# release (debootstrap, a folder), and uses them there as a user would: programs, manual pages, a program
# of one's own by CMake and by pkg-config. With --with-vision the programs that need OpenCV are installed,
# too (some 500 MB of packages); without, apt is asked whether they could be.
#
# Where the bare system comes from, and where this cannot be done: lib_root.sh.
source "$(dirname "${BASH_SOURCE[0]}")/lib_root.sh"

build=$(realpath "${1:?usage: check_deb.sh BUILD_DIR [--with-vision]}")
with_vision=${2:-}
source_dir=$PWD
command -v dpkg-shlibdeps >/dev/null || need_packages --optional dpkg-dev
command -v dpkg-shlibdeps >/dev/null || skip "there is no dpkg-shlibdeps (Debian: dpkg-dev), and it cannot be installed"
make_root

# ---- The packages ------------------------------------------------------------------------------------
rm -rf "$build/packages"
timed "cpack" cmake --build "$build" --target package
ls -l "$build"/packages/*.deb | awk '{printf "   %5.1f MB  %s\n", $5 / 1e6, $NF}'

cp "$build"/packages/*.deb "$root/try/"
cp -r "$source_dir/test/consumer" "$source_dir/test/common" "$root/try/"

# ---- Install and use ---------------------------------------------------------------------------------
timed "installing the packages" inside bash -c "${install[*]} /try/libglissade-dev_*.deb /try/glissade-tools_*.deb \
  /try/glissade-doc_*.deb \$(ls /try/libglissade[0-9]*.deb 2>/dev/null)"
timed "installing man and a compiler" inside "${install[@]}" man-db groff-base g++ cmake make pkg-config

cat >"$root/try/use.sh" <<'USE'
set -euo pipefail
cd /tmp
expect() { # WORDS COMMAND...: what it prints holds the words
  local words=$1 text
  shift
  text=$("$@" 2>&1) || { echo "failed: $*: $text"; exit 1; }
  grep -qF -- "$words" <<<"$text" || { echo "'$words' is not in what '$*' prints: $text"; exit 1; }
}
expect "(glissade)" glissade --version
expect "glissade solve" glissade help solve
make_data bal ring.txt --cameras 12 --points 150
expect "converged" glissade solve ring.txt --output solved.ply --json solved.json
grep -q '"schema": "glissade/ba_solve/1"' solved.json
expect "1 order: 6" testMonoBA
expect "position [m]" glissade report /usr/share/doc/glissade/data/flight_odometry.txt.gz \
  /usr/share/doc/glissade/data/flight --report page.html
grep -q Plotly page.html
if glissade run . 2>message; then exit 1; fi
grep -q "glissade-vision\|OpenCV" message
test "$(wc -l <message)" = 1

expect "glissade-solve" man glissade
expect "--linear-solver" man glissade-solve
expect "GLISSADE-SOLVE(1)" man ba_solve
bash -c '. /usr/share/bash-completion/completions/ba_solve; complete -p ba_solve' >/dev/null
test -f /usr/share/zsh/vendor-completions/_glissade

expect "-lglissade_io" pkg-config --libs glissade_io
g++ -O1 /try/consumer/readme.cpp -o by_pkg_config $(pkg-config --cflags --libs glissade)
./by_pkg_config
cmake -S /try/consumer/package -B by_cmake -DCMAKE_BUILD_TYPE=Release -DINSTALLED=/usr -DBINDIR=bin \
  -DDOCDIR=share/doc/glissade -DHAS_IO=ON "-DAPPS=glissade,ba_solve,testMonoBA,traj_eval,vio_replay,vio_check"
cmake --build by_cmake
by_cmake/consumer
USE
timed "programs, manual pages, programs of one's own" inside bash /try/use.sh

if compgen -G "$root/try/glissade-vision_*.deb" >/dev/null; then
  if [[ $with_vision == --with-vision ]]; then
    timed "installing glissade-vision" inside bash -c "${install[*]} /try/glissade-vision_*.deb"
    timed "glissade run" inside bash -c 'glissade run --version && man glissade-run | grep -q -- --realtime &&
      sim_images /tmp/room --spline sine --seconds 2 --mono --size 320x240 && glissade run /tmp/room --mono --no-such 2>&1 |
      grep -q "unknown option --no-such"'
  else
    timed "glissade-vision could be installed" inside bash -c "apt-get install -s /try/glissade-vision_*.deb"
  fi
fi
timed "removing them" inside bash -c 'apt-get purge -y -q "glissade-*" libglissade-dev &&
  ! command -v glissade && ! test -e /usr/include/glissade && ! test -e /usr/lib/libglissade.a'
say "packages: all is well, after $SECONDS s"
