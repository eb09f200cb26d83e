// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// One step of a Householder QR on a row-major panel: what marginalization in square-root form is
// made of. Lanes are columns; a block of columns is read twice, the second time from the
// first-level cache.

#ifndef GLISSADE_KERNELS_IMPL_HOUSEHOLDER_H_
#define GLISSADE_KERNELS_IMPL_HOUSEHOLDER_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

/// R vectors of columns: a -= tau v (v' a), v[0] = 1.
template <int R>
__attribute__((noinline)) void ReflectColumns(int rows, double* a, Index stride, const double* v,
                                              double tau) {
  vd w[R];
#pragma GCC unroll 8
  for (int r = 0; r < R; ++r)
    w[r] = Load(a + r * kW);
  const double* row = a + stride;
  for (int i = 1; i < rows; ++i, row += stride) {
    const vd vi = Splat(v[i]);
#pragma GCC unroll 8
    for (int r = 0; r < R; ++r)
      w[r] += vi * Load(row + r * kW);
  }
  const vd t = Splat(tau);
#pragma GCC unroll 8
  for (int r = 0; r < R; ++r) {
    w[r] *= t;
    Store(a + r * kW, Load(a + r * kW) - w[r]);
  }
  double* out = a + stride;
  for (int i = 1; i < rows; ++i, out += stride) {
    const vd vi = Splat(v[i]);
#pragma GCC unroll 8
    for (int r = 0; r < R; ++r)
      Store(out + r * kW, Load(out + r * kW) - vi * w[r]);
  }
}

double HouseholderColumn(int rows, int col, int cols, double* a, int stride, double* v) {
  const Index ld = stride;
  double sigma[4] = {};
  for (int i = 1; i < rows; ++i) {
    const double x = a[col + i * ld];
    v[i] = x;
    sigma[i & 3] += x * x;
  }
  const double below = (sigma[0] + sigma[1]) + (sigma[2] + sigma[3]);
  const double alpha = a[col];
  if (!(below > 0.0)) return alpha;
  const double norm = __builtin_sqrt(alpha * alpha + below);
  const double beta = alpha > 0.0 ? -norm : norm;
  const double tau = (beta - alpha) / beta;
  const double scale = 1.0 / (alpha - beta);
  for (int i = 1; i < rows; ++i)
    v[i] *= scale;
  // Whole vectors from a multiple of the width on: what lies before col is zero and stays so.
  // A row is a multiple of 8 long, so that the last one ends within it.
  const int end = (cols + kW - 1) / kW * kW;
  int c = col / kW * kW;
  for (; c + 8 * kW <= end; c += 8 * kW)
    ReflectColumns<8>(rows, a + c, ld, v, tau);
  const int left = (end - c) / kW;
  int r = 0;
  if (left - r >= 4) {
    ReflectColumns<4>(rows, a + c + r * kW, ld, v, tau);
    r += 4;
  }
  if (left - r >= 2) {
    ReflectColumns<2>(rows, a + c + r * kW, ld, v, tau);
    r += 2;
  }
  if (left - r >= 1) ReflectColumns<1>(rows, a + c + r * kW, ld, v, tau);
  a[col] = beta;
  for (int i = 1; i < rows; ++i)
    a[col + i * ld] = 0.0;
  return beta;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_HOUSEHOLDER_H_
