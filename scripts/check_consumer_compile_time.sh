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
  -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
best=
for _ in 1 2 3; do
  seconds=$(cmake --build "$work/build" --clean-first |
    sed -n 's/.*Elapsed time: \([0-9.]*\) s\..*/\1/p' | sort -g | tail -n 1)
  [[ -n $seconds ]] || { echo "FAIL: no time in the compiler's output" >&2; exit 1; }
  best=$(printf '%s\n' "$seconds" ${best:+"$best"} | sort -g | head -n 1)
done
if awk "BEGIN {exit !($best > $limit)}"; then
  echo "FAIL: the consumer's translation unit takes $best s to compile; the limit is $limit s" >&2
  exit 1
fi
echo "ok: the consumer's translation unit takes $best s to compile (limit $limit s)"
