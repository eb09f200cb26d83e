// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Cholesky factorization A = L L', lower, in place.
//
// Two levels: panels of columns (CholeskyPanelColumns()), whose trailing matrix is updated at once
// (rank_update.h), and inside a panel a left-looking sweep over block columns of kNr columns. A
// block column is computed in tiles that hold kNr columns in registers: products with the columns
// on the left, then the triangular solve, without touching memory in between. The factorization of
// the kNr x kNr diagonal block is a chain of dependent scalar operations; it runs as L D L', whose
// chain has one division per pivot and no square root, and is scaled to L L' afterwards.

#ifndef GLISSADE_KERNELS_IMPL_CHOLESKY_H_
#define GLISSADE_KERNELS_IMPL_CHOLESKY_H_

#include "kernels/impl/rank_update.h"
#include "kernels/impl/tile.h"

namespace glissade::kernels {
namespace {

/// A factored diagonal block: L unit lower triangular, D, and 1/sqrt(D).
struct DiagonalBlock {
  double l[kNr][kNr];  // l[c][r]: column-major; diagonal and above unused
  double d[kNr];
  double inverse_sqrt_d[kNr];
};

/// On entry l and d hold the lower triangle of the block. Returns 0 or 1 + index of the failed
/// pivot.
GLISSADE_INLINE int FactorDiagonalBlock(double (&t)[kNr][kNr], DiagonalBlock& block) {
#pragma GCC unroll 8
  for (int c = 0; c < kNr; ++c) {
    const double d = t[c][c];
    if (!(d > 0.0)) return c + 1;
    const double inverse = 1.0 / d;
    block.d[c] = d;
#pragma GCC unroll 8
    for (int r = c + 1; r < kNr; ++r)
      block.l[c][r] = t[c][r] * inverse;
#pragma GCC unroll 8
    for (int q = c + 1; q < kNr; ++q) {
#pragma GCC unroll 8
      for (int r = q; r < kNr; ++r)
        t[q][r] -= block.l[c][q] * t[c][r];
    }
  }
  for (int c = 0; c < kNr; ++c)
    block.inverse_sqrt_d[c] = 1.0 / __builtin_sqrt(block.d[c]);
  return 0;
}

/// t <- t L^-T for the rows of a tile, L the Cholesky factor of the block.
template <int R, int kFirst>
GLISSADE_INLINE void SolveTile(const DiagonalBlock& block, Tile<R>& t) {
#pragma GCC unroll 8
  for (int c = 0; c < kNr; ++c) {
#pragma GCC unroll 8
    for (int q = c + 1; q < kNr; ++q) {
      const vd l = Splat(block.l[c][q]);
#pragma GCC unroll 4
      for (int r = kFirst; r < R; ++r)
        t.v[q][r] -= l * t.v[c][r];
    }
  }
#pragma GCC unroll 8
  for (int c = 0; c < kNr; ++c) {
    const vd s = Splat(block.inverse_sqrt_d[c]);
#pragma GCC unroll 4
    for (int r = kFirst; r < R; ++r)
      t.v[c][r] *= s;
  }
}

/// t <- c - t over the vectors kFirst.. of the tile.
template <int R, int kFirst, bool kPartial>
GLISSADE_INLINE void SubtractFromMemory(const double* c, Index ldc, int last, Tile<R>& t) {
#pragma GCC unroll 8
  for (int j = 0; j < kNr; ++j) {
#pragma GCC unroll 4
    for (int r = kFirst; r < R; ++r) {
      const double* p = c + j * ldc + r * kW;
      t.v[j][r] = (kPartial && r == R - 1 ? LoadPartial(p, last) : Load(p)) - t.v[j][r];
    }
  }
}

template <int R, int kFirst, bool kPartial>
GLISSADE_INLINE void StoreTile(double* c, Index ldc, int last, const Tile<R>& t) {
#pragma GCC unroll 8
  for (int j = 0; j < kNr; ++j) {
#pragma GCC unroll 4
    for (int r = kFirst; r < R; ++r) {
      double* p = c + j * ldc + r * kW;
      if (kPartial && r == R - 1) {
        StorePartial(p, t.v[j][r], last);
      } else {
        Store(p, t.v[j][r]);
      }
    }
  }
}

/// Rows below the diagonal block: R vectors at row i of block column j (both relative to a).
template <int R, bool kPartial>
__attribute__((noinline)) void PanelRows(const double* a, Index lda, int j, int i, int last,
                                         const DiagonalBlock& block) {
  Tile<R> t;
  double* c = const_cast<double*>(a) + i + j * lda;
  TileProduct<R, kPartial>(j, a + i, lda, a + j, lda, last, t);
  SubtractFromMemory<R, 0, kPartial>(c, lda, last, t);
  SolveTile<R, 0>(block, t);
  StoreTile<R, 0, kPartial>(c, lda, last, t);
}

/// The tile that holds the diagonal block of block column j in its first vectors and the rows below
/// it in the others. Returns 0 or 1 + index of the failed pivot in the block.
template <int R, bool kPartial>
__attribute__((noinline)) int PanelDiagonal(double* a, Index lda, int j, int last,
                                            DiagonalBlock& block) {
  constexpr int kFirst = kNr / kW;
  Tile<R> t;
  double* c = a + j + j * lda;
  TileProduct<R, kPartial>(j, a + j, lda, a + j, lda, last, t);
  double s[kNr][kNr];
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
#pragma GCC unroll 4
    for (int r = 0; r < kFirst; ++r)
      Store(&s[q][r * kW], t.v[q][r]);
  }
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
#pragma GCC unroll 8
    for (int r = q; r < kNr; ++r)
      s[q][r] = c[r + q * lda] - s[q][r];
  }
  const int info = FactorDiagonalBlock(s, block);
  if (info != 0) return info;
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
    const double scale = block.d[q] * block.inverse_sqrt_d[q];
    c[q + q * lda] = scale;
#pragma GCC unroll 8
    for (int r = q + 1; r < kNr; ++r)
      c[r + q * lda] = block.l[q][r] * scale;
  }
  if (R > kFirst) {
    SubtractFromMemory<R, kFirst, kPartial>(c, lda, last, t);
    SolveTile<R, kFirst>(block, t);
    StoreTile<R, kFirst, kPartial>(c, lda, last, t);
  }
  return 0;
}

/// The last n - j < kNr columns of the matrix: scalar code on a padded copy.
inline int LastColumns(int n, double* a, Index lda, int j, DiagonalBlock& block) {
  const int w = n - j;
  double s[kNr][kNr] = {};
  for (int k = 0; k < j; ++k) {
    const double* x = a + j + k * lda;
    for (int q = 0; q < w; ++q) {
      for (int r = q; r < w; ++r)
        s[q][r] += x[q] * x[r];
    }
  }
  for (int q = 0; q < w; ++q) {
    for (int r = q; r < w; ++r)
      s[q][r] = a[j + r + (j + q) * lda] - s[q][r];
  }
  for (int q = w; q < kNr; ++q)
    s[q][q] = 1.0;
  const int info = FactorDiagonalBlock(s, block);
  if (info != 0) return info;
  for (int q = 0; q < w; ++q) {
    double* c = a + (j + q) * lda + j;
    const double scale = block.d[q] * block.inverse_sqrt_d[q];
    c[q] = scale;
    for (int r = q + 1; r < w; ++r)
      c[r] = block.l[q][r] * scale;
  }
  return 0;
}

/// Factors the first nb columns of the n x n matrix, left-looking; nb == n or a multiple of kNr.
inline int FactorPanel(int n, int nb, double* a, Index lda) {
  DiagonalBlock block;
  for (int j = 0; j < nb; j += kNr) {
    if (n - j < kNr) {
      const int info = LastColumns(n, a, lda, j, block);
      return info == 0 ? 0 : j + info;
    }
    int info;
    int i = n - j;  // rows from the diagonal on
    if (i >= kMr * kW) {
      info = PanelDiagonal<kMr, false>(a, lda, j, kW, block);
      i = j + kMr * kW;
    } else {
      const int last = 1 + (i - 1) % kW;
      switch ((i + kW - 1) / kW) {
#if GLISSADE_KERNEL_WIDTH >= 4
        case 1:
          info = PanelDiagonal<1, false>(a, lda, j, kW, block);
          break;
        case 2:
          info = PanelDiagonal<2, true>(a, lda, j, last, block);
          break;
#endif
        default:
          info = PanelDiagonal<kMr, true>(a, lda, j, last, block);
          break;
      }
      i = n;
    }
    if (info != 0) return j + info;
    for (; n - i >= kMr * kW; i += kMr * kW)
      PanelRows<kMr, false>(a, lda, j, i, kW, block);
    if (i < n) {
      const int last = 1 + (n - i - 1) % kW;
      switch ((n - i + kW - 1) / kW) {
        case 1:
          PanelRows<1, true>(a, lda, j, i, last, block);
          break;
        case 2:
          PanelRows<2, true>(a, lda, j, i, last, block);
          break;
        default:
          PanelRows<kMr, true>(a, lda, j, i, last, block);
          break;
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_CHOLESKY_H_
