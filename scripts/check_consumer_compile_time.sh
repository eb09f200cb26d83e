#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_consumer_compile_time.sh BUILD_DIR [SECONDS SECONDS SECONDS SECONDS]
#
# Compiles the units of test/compile_time against the installed package at -O2, three times each:
# solve.cpp (the least that solves), range_edge.cpp and reprojection_edge.cpp (edges of one's own),
# front_end.cpp (IMU, two cameras, files). Prints the median of the user seconds of the processor, so
# that what else the machine does matters little, and fails if the fastest took more than its limit.
set -euo pipefail
(($# == 1 || $# == 5)) || { echo "usage: $0 BUILD_DIR [SECONDS SECONDS SECONDS SECONDS]" >&2; exit 2; }
source_dir=$(cd "$(dirname "$0")/../test/compile_time" && pwd)
limits=("${@:2}")
((${#limits[@]})) || limits=(1.5 2.5 3 8)
work=$(mktemp -d "$(cd "$1" && pwd)/consumer_compile_time.XXXXXX")
trap 'rm -rf "$work"' EXIT

# step COMMAND...: what it prints is shown only if it fails.
step() {
  "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; echo "FAIL: $*" >&2; exit 1; }
}

unset CMAKE_CXX_COMPILER_LAUNCHER CXXFLAGS
step cmake --install "$1" --prefix "$work/prefix"
step cmake -S "$source_dir" -B "$work/build" -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O2 \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON

python3 - "$work/build/compile_commands.json" "${limits[@]}" <<'PYTHON'
import json
import resource
import shlex
import statistics
import subprocess
import sys

path, limits = sys.argv[1], map(float, sys.argv[2:])


def user_seconds(entry):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(shlex.split(entry["command"]), cwd=entry["directory"], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


with open(path, encoding="utf-8") as file:
    entries = json.load(file)
failed = False
for name, limit in zip(("solve", "range_edge", "reprojection_edge", "front_end"), limits):
    (entry,) = [e for e in entries if e["file"].endswith(f"/{name}.cpp")]
    taken = [user_seconds(entry) for _ in range(3)]
    failed |= min(taken) > limit
    print(f"{'FAIL' if min(taken) > limit else 'ok'}: {name}.cpp takes {statistics.median(taken):.2f} "
          f"user seconds to compile (fastest {min(taken):.2f}, limit {limit:g})")
sys.exit(failed)
PYTHON
