#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_consumer_compile_time.sh BUILD_DIR [SECONDS [SECONDS]]
#
# Compiles two translation units of test/consumer against the installed package, three times each:
# consumer.cpp (an edge type of its own, -O3) and readme.cpp (the program of README.md). Fails if the
# fastest took more user seconds of the processor than the first (default 5) or the second limit
# (default 5). User seconds, so that what else the machine does matters little.
set -euo pipefail
(($# >= 1)) || { echo "usage: $0 BUILD_DIR [SECONDS]" >&2; exit 2; }
source_dir=$(cd "$(dirname "$0")/../test/consumer" && pwd)
limits=("${2:-5}" "${3:-5}")
work=$(mktemp -d "$(cd "$1" && pwd)/consumer_compile_time.XXXXXX")
trap 'rm -rf "$work"' EXIT

# step COMMAND...: what it prints is shown only if it fails.
step() {
  "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; echo "FAIL: $*" >&2; exit 1; }
}

unset CMAKE_CXX_COMPILER_LAUNCHER CXXFLAGS
step cmake --install "$1" --prefix "$work/prefix"
step cmake -S "$source_dir" -B "$work/build" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON

python3 - "$work/build/compile_commands.json" "${limits[@]}" <<'PYTHON'
import json
import resource
import shlex
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
for name, limit in zip(("consumer.cpp", "readme.cpp"), limits):
    (entry,) = [e for e in entries if e["file"].endswith("/" + name)]
    fastest = min(user_seconds(entry) for _ in range(3))
    said = f"{name} takes {fastest:.2f} user seconds to compile (limit {limit:g})"
    failed |= fastest > limit
    print("FAIL: " + said if fastest > limit else "ok: " + said)
sys.exit(failed)
PYTHON
