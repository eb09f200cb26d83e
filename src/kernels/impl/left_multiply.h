// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Rows of one edge times its square-root information.

#ifndef GLISSADE_KERNELS_IMPL_LEFT_MULTIPLY_H_
#define GLISSADE_KERNELS_IMPL_LEFT_MULTIPLY_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

template <int kVectors>
GLISSADE_INLINE void MultiplyRow(int first, int rows, const double* l, const double* a,
                                 Index stride, double* out) {
  vd sum[kVectors] = {};
  for (int m = first; m < rows; ++m) {
    const vd x = Splat(l[m]);
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v)
      sum[v] += x * Load(a + m * stride + v * kW);
  }
#pragma GCC unroll 4
  for (int v = 0; v < kVectors; ++v)
    Store(out + v * kW, sum[v]);
}

void LeftMultiply(int rows, const double* l, const double* a, double* out, int stride) {
  for (int k = 0; k < rows; ++k, l += rows) {
    // Square roots of information are mostly upper triangles.
    int first = 0;
    while (first < rows - 1 && l[first] == 0.0)
      ++first;
    double* row = out + static_cast<Index>(k) * stride;
    int c = 0;
    for (; c + 4 * kW <= stride; c += 4 * kW)
      MultiplyRow<4>(first, rows, l, a + c, stride, row + c);
    for (; c + kW <= stride; c += kW)
      MultiplyRow<1>(first, rows, l, a + c, stride, row + c);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_LEFT_MULTIPLY_H_
