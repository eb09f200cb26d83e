// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "kernels/dispatch.h"

#include <stdlib.h>
#include <string.h>

#ifndef GLISSADE_KERNELS_X86
#define GLISSADE_KERNELS_X86 0
#endif

namespace glissade::kernels {

extern const KernelTable glissade_kernels_baseline;
#if GLISSADE_KERNELS_X86
extern const KernelTable glissade_kernels_avx2;
extern const KernelTable glissade_kernels_avx512;
#endif

namespace {

bool CpuSupports(Isa isa) {
#if GLISSADE_KERNELS_X86
  // The flags each folder is compiled with (CMakeLists.txt); libgcc also checks that the operating
  // system saves the wide registers.
  switch (isa) {
    case Isa::kBaseline:
      return true;
    case Isa::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case Isa::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  }
  return false;
#else
  return isa == Isa::kBaseline;
#endif
}

Isa BestIsa() {
  if (CpuSupports(Isa::kAvx2)) return CpuSupports(Isa::kAvx512) ? Isa::kAvx512 : Isa::kAvx2;
  return Isa::kBaseline;
}

const IsaSelection& Selection() {
  static const IsaSelection selection = SelectIsa(BestIsa(), getenv("GLISSADE_ISA"));
  return selection;
}

}  // namespace

IsaSelection SelectIsa(Isa best, const char* requested) {
  if (requested == nullptr || *requested == '\0') return {best, ""};
  Isa wanted;
  if (strcmp(requested, "baseline") == 0) {
    wanted = Isa::kBaseline;
  } else if (strcmp(requested, "avx2") == 0) {
    wanted = Isa::kAvx2;
  } else if (strcmp(requested, "avx512") == 0) {
    wanted = Isa::kAvx512;
  } else {
    return {best, "GLISSADE_ISA is none of baseline, avx2, avx512"};
  }
  if (wanted <= best) return {wanted, ""};
  return {best, best == Isa::kAvx2
                    ? "GLISSADE_ISA=avx512 on a machine that has baseline and avx2 only"
                    : "GLISSADE_ISA=avx2 or avx512 on a machine that has baseline only"};
}

const KernelTable* KernelsFor(Isa isa) {
  if (isa > BestIsa()) return nullptr;
#if GLISSADE_KERNELS_X86
  if (isa == Isa::kAvx512) return &glissade_kernels_avx512;
  if (isa == Isa::kAvx2) return &glissade_kernels_avx2;
#endif
  return &glissade_kernels_baseline;
}

const KernelTable& Kernels() {
  static const KernelTable& table = *KernelsFor(Selection().isa);
  return table;
}

const char* IsaSelectionNote() {
  return Selection().note;
}

}  // namespace glissade::kernels
