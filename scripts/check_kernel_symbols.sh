#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_kernel_symbols.sh BUILD_DIR
#
# The kernels are compiled once per instruction set. This fails
#  - if a kernel object has a weak symbol: the linker would keep one copy for the whole program, and
#    that may be the AVX-512 one;
#  - if a baseline object touches a ymm or zmm register, or an AVX2 object a zmm register;
#  - if an object of one instruction set defines a global symbol that another one defines too.
set -euo pipefail
(($# == 1)) || { echo "usage: $0 BUILD_DIR" >&2; exit 2; }
command -v nm >/dev/null || { echo "skipped: no nm here" >&2; exit 77; }

mapfile -d '' -t objects < <(find "$1/src" -path '*/glissade_kernels_*.dir/*.o' -print0 | sort -z)
if ((${#objects[@]} == 0)); then
  echo "FAIL: no kernel objects under $1" >&2
  exit 1
fi

failed=0
fail() { echo "FAIL: $*" >&2; failed=1; }

for object in "${objects[@]}"; do
  name=${object##*/glissade_kernels_}
  if weak=$(nm -C "$object" | grep -E ' [WVuwv] '); then
    fail "weak symbols in $name:"
    head -n 10 <<<"$weak" >&2
  fi
  [[ $(uname -m) == x86_64 ]] && command -v objdump >/dev/null || continue
  case $name in
    *baseline.dir/* | dispatch.dir/*) forbidden='%[yz]mm' ;;
    *avx2.dir/*) forbidden='%zmm' ;;
    *) continue ;;
  esac
  wide=$(objdump -d --no-show-raw-insn "$object" | grep -cE "$forbidden" || true)
  ((wide == 0)) || fail "$wide instructions of $name use wider registers than its instruction set has"
done

twice=$(for object in "${objects[@]}"; do nm -C --defined-only --extern-only "$object"; done |
  awk 'NF >= 3 {sub(/^[^ ]* [^ ]* /, ""); print}' | sort | uniq -d)
if [[ -n $twice ]]; then
  fail "global symbols defined by more than one kernel object:"
  head -n 10 <<<"$twice" >&2
fi

((failed)) || echo "ok: ${#objects[@]} kernel objects: no weak symbols, no wider registers, no clashes"
exit $failed
