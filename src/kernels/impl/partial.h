// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Fronts of a multifrontal Cholesky factorization: the first columns of a dense symmetric matrix
// are eliminated, the rest becomes the Schur complement that goes to the parent front.

#ifndef GLISSADE_KERNELS_IMPL_PARTIAL_H_
#define GLISSADE_KERNELS_IMPL_PARTIAL_H_

#include "kernels/impl/cholesky.h"
#include "kernels/impl/triangular.h"
#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

/// Column c of the factor, left-looking: the columns of a panel that do not fill a block column.
inline int FactorColumn(int n, double* a, Index lda, int c) {
  double* column = a + c * lda;
  int i = c;
#pragma GCC unroll 1
  for (; i + kW <= n; i += kW) {
    vd y = Load(column + i);
    for (int k = 0; k < c; ++k)
      y -= Load(a + i + k * lda) * Splat(a[c + k * lda]);
    Store(column + i, y);
  }
  for (; i < n; ++i) {
    double y = column[i];
    for (int k = 0; k < c; ++k)
      y -= a[i + k * lda] * a[c + k * lda];
    column[i] = y;
  }
  const double pivot = column[c];
  if (!(pivot > 0.0)) return c + 1;
  const double root = __builtin_sqrt(pivot);
  const double inverse = 1.0 / root;
  column[c] = root;
  for (i = c + 1; i < n; ++i)
    column[i] *= inverse;
  return 0;
}

/// The first nb columns of the factor; what is right of them stays as it is.
int CholeskyPanel(int n, int nb, double* a, int lda) {
  const Index ld = lda;
  const int whole = nb == n ? nb : nb - nb % kNr;
  int info = FactorPanel(n, whole, a, ld);
  for (int c = whole; info == 0 && c < nb; ++c)
    info = FactorColumn(n, a, ld, c);
  return info;
}

int CholeskyPartial(int n, int nb, double* a, int lda) {
  const Index ld = lda;
  for (int j = 0; j < nb;) {
    const int columns = CholeskyPanelColumns(nb - j);
    double* s = a + j + j * ld;
    const int info = CholeskyPanel(n - j, columns, s, lda);
    if (info != 0) return j + info;
    j += columns;
    if (j < n) RankUpdate<kSub>(n - j, columns, s + columns, ld, a + j + j * ld, ld);
  }
  return 0;
}

int Cholesky(int n, double* a, int lda) {
  return CholeskyPartial(n, n, a, lda);
}

/// x1 <- L11^-1 x1, x2 <- x2 - L21 x1.
void ForwardSolvePartial(int n, int nb, const double* l, int lda, double* x) {
  const Index ld = lda;
  ForwardSolve(nb, l, lda, x);
  int i = nb;
#pragma GCC unroll 1
  for (; i + kW <= n; i += kW) {
    vd y = Load(x + i);
    for (int k = 0; k < nb; ++k)
      y -= Load(l + i + k * ld) * Splat(x[k]);
    Store(x + i, y);
  }
  for (; i < n; ++i) {
    double y = x[i];
    for (int k = 0; k < nb; ++k)
      y -= l[i + k * ld] * x[k];
    x[i] = y;
  }
}

/// x1 <- L11^-T (x1 - L21' x2).
void BackwardSolvePartial(int n, int nb, const double* l, int lda, double* x) {
  const Index ld = lda;
  for (int k = 0; k < nb; ++k) {
    const double* column = l + k * ld;
    vd sum = Zero();
    int i = nb;
    for (; i + kW <= n; i += kW)
      sum += Load(column + i) * Load(x + i);
    double y = Sum(sum);
    for (; i < n; ++i)
      y += column[i] * x[i];
    x[k] -= y;
  }
  BackwardSolve(nb, l, lda, x);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_PARTIAL_H_
