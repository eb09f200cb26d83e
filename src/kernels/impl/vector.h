// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Products with vectors: dot, axpy and the symmetric matrix-vector product.

#ifndef GLISSADE_KERNELS_IMPL_VECTOR_H_
#define GLISSADE_KERNELS_IMPL_VECTOR_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

double Dot(int n, const double* x, const double* y) {
  vd s[4] = {Zero(), Zero(), Zero(), Zero()};
  int i = 0;
  for (; i + 4 * kW <= n; i += 4 * kW) {
#pragma GCC unroll 4
    for (int u = 0; u < 4; ++u)
      s[u] += Load(x + i + u * kW) * Load(y + i + u * kW);
  }
  for (; i + kW <= n; i += kW)
    s[0] += Load(x + i) * Load(y + i);
  if (i < n) s[1] += LoadPartial(x + i, n - i) * LoadPartial(y + i, n - i);
  return Sum((s[0] + s[1]) + (s[2] + s[3]));
}

void Axpy(int n, double alpha, const double* x, double* y) {
  const vd a = Splat(alpha);
  int i = 0;
  for (; i + kW <= n; i += kW)
    Store(y + i, Load(y + i) + a * Load(x + i));
  if (i < n) StorePartial(y + i, LoadPartial(y + i, n - i) + a * LoadPartial(x + i, n - i), n - i);
}

/// Adds the part of y = A x that kColumns columns from j on bring, their diagonal block included.
template <int kColumns>
GLISSADE_INLINE void SymvColumns(int n, const double* a, Index lda, int j, const double* x,
                                 double* y) {
  const double* aj = a + j + j * lda;
  double s[kColumns];
#pragma GCC unroll 4
  for (int c = 0; c < kColumns; ++c)
    s[c] = aj[c + c * lda] * x[j + c];
#pragma GCC unroll 4
  for (int c = 0; c < kColumns; ++c) {
#pragma GCC unroll 4
    for (int r = c + 1; r < kColumns; ++r) {
      s[c] += aj[r + c * lda] * x[j + r];
      s[r] += aj[r + c * lda] * x[j + c];
    }
  }
  vd sum[kColumns];
  vd xj[kColumns];
#pragma GCC unroll 4
  for (int c = 0; c < kColumns; ++c) {
    sum[c] = Zero();
    xj[c] = Splat(x[j + c]);
  }
  int i = j + kColumns;
  aj += kColumns;
#pragma GCC unroll 1
  for (; i + kW <= n; i += kW, aj += kW) {
    const vd xi = Load(x + i);
    vd yi = Load(y + i);
#pragma GCC unroll 4
    for (int c = 0; c < kColumns; ++c) {
      const vd l = Load(aj + c * lda);
      yi += l * xj[c];
      sum[c] += l * xi;
    }
    Store(y + i, yi);
  }
  if (i < n) {
    const vd xi = LoadPartial(x + i, n - i);
    vd yi = LoadPartial(y + i, n - i);
#pragma GCC unroll 4
    for (int c = 0; c < kColumns; ++c) {
      const vd l = LoadPartial(aj + c * lda, n - i);
      yi += l * xj[c];
      sum[c] += l * xi;
    }
    StorePartial(y + i, yi, n - i);
  }
#pragma GCC unroll 4
  for (int c = 0; c < kColumns; ++c)
    y[j + c] += s[c] + Sum(sum[c]);
}

void SymvLowerColumns(int n, int columns, const double* a, int lda, const double* x, double* y) {
  int j = 0;
  for (; j + 4 <= columns; j += 4)
    SymvColumns<4>(n, a, lda, j, x, y);
  for (; j < columns; ++j)
    SymvColumns<1>(n, a, lda, j, x, y);
}

void SymvLower(int n, const double* a, int lda, const double* x, double* y) {
  for (int i = 0; i < n; ++i)
    y[i] = 0.0;
  SymvLowerColumns(n, n, a, lda, x, y);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_VECTOR_H_
