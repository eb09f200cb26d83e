// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Solves with the lower factor L and one right-hand side.
//
// Blocks of kSolve columns: inside a block a scalar chain (one multiplication by the reciprocal
// pivot and one subtraction per unknown), outside all kSolve columns in one pass over the vector.

#ifndef GLISSADE_KERNELS_IMPL_TRIANGULAR_H_
#define GLISSADE_KERNELS_IMPL_TRIANGULAR_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

constexpr int kSolve = 8;

/// Forward substitution in the diagonal block at l.
GLISSADE_INLINE void SolveBlockForward(const double* l, Index lda, double (&x)[kSolve]) {
  double inverse[kSolve];
#pragma GCC unroll 8
  for (int c = 0; c < kSolve; ++c)
    inverse[c] = 1.0 / l[c + c * lda];
#pragma GCC unroll 8
  for (int c = 0; c < kSolve; ++c) {
    x[c] *= inverse[c];
#pragma GCC unroll 8
    for (int r = c + 1; r < kSolve; ++r)
      x[r] -= l[r + c * lda] * x[c];
  }
}

/// Backward substitution (with L') in the diagonal block.
GLISSADE_INLINE void SolveBlockBackward(const double* l, Index lda, double (&x)[kSolve]) {
  double inverse[kSolve];
#pragma GCC unroll 8
  for (int c = 0; c < kSolve; ++c)
    inverse[c] = 1.0 / l[c + c * lda];
#pragma GCC unroll 8
  for (int c = kSolve - 1; c >= 0; --c) {
    x[c] *= inverse[c];
#pragma GCC unroll 8
    for (int r = 0; r < c; ++r)
      x[r] -= l[c + r * lda] * x[c];
  }
}

void ForwardSolve(int n, const double* l, int lda, double* x) {
  const Index ld = lda;
  int j = 0;
  for (; j + kSolve <= n; j += kSolve) {
    const double* lj = l + j + j * ld;
    double s[kSolve];
#pragma GCC unroll 8
    for (int c = 0; c < kSolve; ++c)
      s[c] = x[j + c];
    SolveBlockForward(lj, ld, s);
#pragma GCC unroll 8
    for (int c = 0; c < kSolve; ++c)
      x[j + c] = s[c];
    int i = j + kSolve;
    lj += kSolve;
#pragma GCC unroll 1
    for (; i + kW <= n; i += kW, lj += kW) {
      vd y0 = Load(x + i);
      vd y1 = Zero();
#pragma GCC unroll 8
      for (int c = 0; c < kSolve; c += 2) {
        y0 -= Load(lj + c * ld) * Splat(s[c]);
        y1 -= Load(lj + (c + 1) * ld) * Splat(s[c + 1]);
      }
      Store(x + i, y0 + y1);
    }
    if (i < n) {
      vd y = LoadPartial(x + i, n - i);
#pragma GCC unroll 8
      for (int c = 0; c < kSolve; ++c)
        y -= LoadPartial(lj + c * ld, n - i) * Splat(s[c]);
      StorePartial(x + i, y, n - i);
    }
  }
  for (; j < n; ++j) {  // the last columns, fewer than kSolve
    x[j] /= l[j + j * ld];
    for (int i = j + 1; i < n; ++i)
      x[i] -= l[i + j * ld] * x[j];
  }
}

void BackwardSolve(int n, const double* l, int lda, double* x) {
  const Index ld = lda;
  int j = n - n % kSolve;
  for (int c = n - 1; c >= j; --c) {  // the last columns, fewer than kSolve
    double sum = x[c];
    for (int i = c + 1; i < n; ++i)
      sum -= l[i + c * ld] * x[i];
    x[c] = sum / l[c + c * ld];
  }
  for (j -= kSolve; j >= 0; j -= kSolve) {
    const double* lj = l + j + j * ld;
    const double* li = lj + kSolve;
    vd sum[kSolve];
#pragma GCC unroll 8
    for (int c = 0; c < kSolve; ++c)
      sum[c] = Zero();
    int i = j + kSolve;
#pragma GCC unroll 1
    for (; i + kW <= n; i += kW, li += kW) {
      const vd y = Load(x + i);
#pragma GCC unroll 8
      for (int c = 0; c < kSolve; ++c)
        sum[c] += Load(li + c * ld) * y;
    }
    if (i < n) {
      const vd y = LoadPartial(x + i, n - i);
#pragma GCC unroll 8
      for (int c = 0; c < kSolve; ++c)
        sum[c] += LoadPartial(li + c * ld, n - i) * y;
    }
    double s[kSolve];
#pragma GCC unroll 8
    for (int c = 0; c < kSolve; ++c)
      s[c] = x[j + c] - Sum(sum[c]);
    SolveBlockBackward(lj, ld, s);
#pragma GCC unroll 8
    for (int c = 0; c < kSolve; ++c)
      x[j + c] = s[c];
  }
}

void CholeskySolve(int n, const double* l, int lda, double* x) {
  ForwardSolve(n, l, lda, x);
  BackwardSolve(n, l, lda, x);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TRIANGULAR_H_
