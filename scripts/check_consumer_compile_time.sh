#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_consumer_compile_time.sh BUILD_DIR [SECONDS]
#
# Compiles the consumer's translation unit (test/consumer, an edge type of its own) against the
# installed package three times and fails if the fastest took more than SECONDS (default 5).
set -euo pipefail
(($# >= 1)) || { echo "usage: $0 BUILD_DIR [SECONDS]" >&2; exit 2; }
source_dir=$(cd "$(dirname "$0")/../test/consumer" && pwd)
limit=${2:-5}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

unset CMAKE_CXX_COMPILER_LAUNCHER CXXFLAGS
cmake --install "$1" --prefix "$work/prefix" >/dev/null
cmake -S "$source_dir" -B "$work/build" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null

python3 - "$work/build/compile_commands.json" "$limit" <<'PYTHON'
import json
import shlex
import subprocess
import sys
import time

path, limit = sys.argv[1], float(sys.argv[2])
(entry,) = [e for e in json.load(open(path)) if e["file"].endswith("/consumer.cpp")]
command = shlex.split(entry["command"])
times = []
for _ in range(3):
    start = time.monotonic()
    subprocess.run(command, cwd=entry["directory"], check=True)
    times.append(time.monotonic() - start)
said = f"the consumer's translation unit takes {min(times):.2f} s to compile (limit {limit:g} s)"
if min(times) > limit:
    sys.exit(f"FAIL: {said}")
print(f"ok: {said}")
PYTHON
