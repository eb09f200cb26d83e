#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# demo.sh [ARGUMENT...]
#
# Installs what is missing (Debian 12, Ubuntu 22.04 or newer), builds testMonoBA and runs it with the
# given arguments.
source "$(dirname "${BASH_SOURCE[0]}")/lib_setup.sh"

need_packages "${packages_build[@]}" "${packages_app[@]}"
configure release >/dev/null  # what is skipped there is no matter of the demo
say "building testMonoBA (takes some minutes the first time)"
# Somebody who watches sees the progress; a log gets the output only if something is wrong.
log=$(mktemp)
build() { cmake --build --preset release --target testMonoBA -j "$jobs" 2>&1; }
if [[ -t 1 ]]; then
  build | tee "$log" | sed -un 's/^\(\[ *[0-9]*%\]\).*/\1/p' | while read -r done_so_far; do
    printf '\r%s ' "$done_so_far"
  done && printf '\r'
else
  build >"$log"
fi || {
  tail -n 40 "$log" >&2
  rm -f "$log"
  die "the build failed (the end of its output is above)"
}
rm -f "$log"
say "build/release/bin/testMonoBA${*:+ $*}"
exec build/release/bin/testMonoBA "$@"
