// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Inverse of the small symmetric positive definite blocks of landmarks.

#ifndef GLISSADE_KERNELS_IMPL_SMALL_H_
#define GLISSADE_KERNELS_IMPL_SMALL_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

/// H^-1 = L^-T D^-1 L^-1 from H = L D L', fully unrolled.
template <int N>
GLISSADE_INLINE int InvertSpd(double* h) {
  double l[N][N];  // l[r][c], r > c
  double u[N][N];  // l * d
  double inverse_d[N];
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
    inverse_d[c] = 1.0 / u[c][c];
#pragma GCC unroll 4
    for (int r = c + 1; r < N; ++r)
      l[r][c] = u[r][c] * inverse_d[c];
  }
  double m[N][N];  // L^-1, unit lower
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
  double inverse[N][N];
  double check = 0.0;  // stays 0 for finite numbers, is NaN otherwise
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
    for (int r = c; r < N; ++r) {
      double s = 0.0;
#pragma GCC unroll 4
      for (int k = r; k < N; ++k)
        s += m[k][r] * inverse_d[k] * m[k][c];
      inverse[r][c] = s;
      check += s * 0.0;
    }
  }
  if (!(check == 0.0)) return 1;
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
    for (int r = c; r < N; ++r)
      h[r * N + c] = h[c * N + r] = inverse[r][c];
  }
  return 0;
}

int InvertSpdSmall(int n, double* h) {
  switch (n) {
    case 1:
      return InvertSpd<1>(h);
    case 2:
      return InvertSpd<2>(h);
    case 3:
      return InvertSpd<3>(h);
    case 4:
      return InvertSpd<4>(h);
    default:
      return 1;
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SMALL_H_
