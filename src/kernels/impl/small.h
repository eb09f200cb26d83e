// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Factors of the inverse of the small symmetric positive definite blocks of landmarks.

#ifndef GLISSADE_KERNELS_IMPL_SMALL_H_
#define GLISSADE_KERNELS_IMPL_SMALL_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

/// C = D^-1/2 L^-1 from H = L D L', fully unrolled.
template <int N>
GLISSADE_INLINE int InverseFactorOf(double* h) {
  double l[N][N];  // l[r][c], r > c
  double u[N][N];  // l * d
  double root[N];  // of 1 / d
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
    for (int r = c; r < N; ++r) {
      double s = h[r * N + c];
#pragma GCC unroll 4
      for (int k = 0; k < c; ++k)
        s -= u[r][k] * l[c][k];
      u[r][c] = s;
    }
    // Not > 0 covers NaN; an infinite pivot would leave a zero inverse behind it.
    if (!(u[c][c] > 0.0) || !(u[c][c] <= __DBL_MAX__)) return 1;
    const double inverse_d = 1.0 / u[c][c];
    root[c] = __builtin_sqrt(inverse_d);
#pragma GCC unroll 4
    for (int r = c + 1; r < N; ++r)
      l[r][c] = u[r][c] * inverse_d;
  }
  double m[N][N];  // L^-1, unit lower; then C
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
    m[c][c] = 1.0;
#pragma GCC unroll 4
    for (int r = c + 1; r < N; ++r) {
      double s = 0.0;
#pragma GCC unroll 4
      for (int k = c; k < r; ++k)
        s -= l[r][k] * m[k][c];
      m[r][c] = s;
    }
  }
  double check = 0.0;  // stays 0 for finite numbers, is NaN otherwise
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
    for (int r = c; r < N; ++r) {
      m[r][c] *= root[r];
      // The inverse has its square.
      check += m[r][c] * m[r][c] * 0.0;
    }
  }
  if (!(check == 0.0)) return 1;
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
    for (int r = 0; r < N; ++r)
      h[r * N + c] = r >= c ? m[r][c] : 0.0;
  }
  return 0;
}

int InverseFactor(int n, double* h) {
  switch (n) {
    case 1:
      return InverseFactorOf<1>(h);
    case 2:
      return InverseFactorOf<2>(h);
    case 3:
      return InverseFactorOf<3>(h);
    case 4:
      return InverseFactorOf<4>(h);
    default:
      return 1;
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SMALL_H_
