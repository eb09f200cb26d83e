#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_no_eigen_symbols.sh LIBRARY...
#
# Fails if an archive has or needs a symbol that names the namespace Eigen. The library is compiled
# with the namespace renamed, so that no inline function of Eigen can be merged with the copy of a
# consumer that was built for another instruction set (src/CMakeLists.txt).
set -euo pipefail
(($# > 0)) || { echo "usage: $0 LIBRARY..." >&2; exit 2; }
command -v nm >/dev/null || { echo "skipped: no nm here" >&2; exit 77; }

failed=0
for library in "$@"; do
  symbols=$(nm -C "$library" 2>/dev/null) || { echo "FAIL: nm cannot read $library" >&2; exit 1; }
  [[ -n $symbols ]] || { echo "FAIL: $library has no symbols" >&2; exit 1; }
  if grep -E '(^|[^A-Za-z0-9_])Eigen::' <<<"$symbols" >/tmp/eigen_symbols.$$; then
    echo "FAIL: $library: $(wc -l </tmp/eigen_symbols.$$) symbols in namespace Eigen, such as" >&2
    head -n 5 /tmp/eigen_symbols.$$ >&2
    failed=1
  else
    echo "ok: $(basename "$library"): $(wc -l <<<"$symbols") lines of symbols, none in Eigen"
  fi
  rm -f /tmp/eigen_symbols.$$
done
exit $failed
