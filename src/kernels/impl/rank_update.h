// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// C +-= A B' or C = -A B', whole or lower triangle (A == B then): the panel update of Schur
// complements and of the blocked factorization.
//
// Tiles of tile.h over row blocks that stay in the first-level cache. The kNr rows of B that a
// column of tiles needs are copied to a contiguous buffer, zero-padded, which makes column edges
// ordinary.

#ifndef GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_
#define GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_

#include "kernels/impl/tile.h"

namespace glissade::kernels {
namespace {

// Columns of A and B, and rows of A, taken at a time: such a block of A (37 KiB with AVX-512) stays
// in the first-level cache while the columns of C pass by. Copying it to a contiguous buffer did
// not pay (0 to -10 %) except where the leading dimension is a multiple of 512.
constexpr int kDepth = 96;
constexpr int kRowBlock = 2 * kMr * kW;

// What becomes of C: kAdd, kSub, or kSetNegative, which does not read it.
constexpr int kAdd = 1, kSub = -1, kSetNegative = 0;

GLISSADE_INLINE vd Combine(vd c, vd t, int sign) {
  return sign == kAdd ? c + t : c - t;
}

/// C tile (R vectors x `columns` columns) combined with t.
template <int R, bool kPartial, int kSign>
GLISSADE_INLINE void UpdateTile(double* c, Index ldc, int columns, int last, const Tile<R>& t) {
#pragma GCC unroll 8
  for (int j = 0; j < kNr; ++j) {
    if (j >= columns) return;
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      double* p = c + j * ldc + r * kW;
      const bool partial = kPartial && r == R - 1;
      vd x = Zero();
      if (kSign != kSetNegative) x = partial ? LoadPartial(p, last) : Load(p);
      x = Combine(x, t.v[j][r], kSign);
      if (partial) {
        StorePartial(p, x, last);
      } else {
        Store(p, x);
      }
    }
  }
}

template <int R, bool kPartial, int kSign>
__attribute__((noinline)) void RankTile(int k, const double* a, Index lda, const double* b,
                                        Index ldb, double* c, Index ldc, int columns, int last) {
  Tile<R> t;
  TileProduct<R, kPartial>(k, a, lda, b, ldb, last, t);
  UpdateTile<R, kPartial, kSign>(c, ldc, columns, last, t);
}

/// The tile on the diagonal, of which only the lower triangle counts.
template <int kSign>
__attribute__((noinline)) void DiagonalTile(int k, const double* a, Index lda, const double* b,
                                            Index ldb, double* c, Index ldc, int n) {
  constexpr int kRows = kNr / kW;
  Tile<kRows> t;
  if (n == kNr) {
    TileProduct<kRows, false>(k, a, lda, b, ldb, kW, t);
  } else {
    // Square, so b (the padded copy of the same rows) serves as a.
    TileProduct<kRows, false>(k, b, ldb, b, ldb, kW, t);
  }
#if GLISSADE_KERNEL_WIDTH == 8
  static_assert(kNr <= kW, "one vector a column");
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
    if (q >= n) return;
    const unsigned char rows = static_cast<unsigned char>(((1 << n) - 1) & (0xff << q));
    double* column = c + q * ldc;
    vd x = Zero();
    if (kSign != kSetNegative) x = __builtin_ia32_loadupd512_mask(column, x, rows);
    __builtin_ia32_storeupd512_mask(column, Combine(x, t.v[q][0], kSign), rows);
  }
#else
  double s[kNr][kNr];
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
#pragma GCC unroll 4
    for (int r = 0; r < kRows; ++r)
      Store(&s[q][r * kW], t.v[q][r]);
  }
  for (int q = 0; q < n; ++q) {
    for (int r = q; r < n; ++r) {
      const double x = kSign == kSetNegative ? 0.0 : c[r + q * ldc];
      c[r + q * ldc] = kSign == kAdd ? x + s[q][r] : x - s[q][r];
    }
  }
#endif
}

/// Rows [0, m) of one column of tiles.
template <int kSign>
inline void RankColumn(int m, int k, const double* a, Index lda, const double* b, Index ldb,
                       double* c, Index ldc, int columns) {
  int i = 0;
  for (; m - i >= kMr * kW; i += kMr * kW) {
    RankTile<kMr, false, kSign>(k, a + i, lda, b, ldb, c + i, ldc, columns, kW);
  }
  if (i == m) return;
  const int last = 1 + (m - i - 1) % kW;
  switch ((m - i + kW - 1) / kW) {
    case 1:
      RankTile<1, true, kSign>(k, a + i, lda, b, ldb, c + i, ldc, columns, last);
      break;
    case 2:
      RankTile<2, true, kSign>(k, a + i, lda, b, ldb, c + i, ldc, columns, last);
      break;
    default:
      RankTile<kMr, true, kSign>(k, a + i, lda, b, ldb, c + i, ldc, columns, last);
      break;
  }
}

template <bool kLower, int kSign>
void RankUpdate(int m, int n, int k, const double* a, Index lda, const double* b, Index ldb,
                double* c, Index ldc) {
  double padded[kDepth * kNr];
  for (int k0 = 0; k0 < k; k0 += kDepth) {
    const int kc = Min(kDepth, k - k0);
    for (int i0 = 0; i0 < m; i0 += kRowBlock) {
      const int i1 = Min(m, i0 + kRowBlock);
      for (int j = 0; j < (kLower ? i1 : n); j += kNr) {
        const int columns = Min(kNr, n - j);
        const double* ak = a + k0 * lda;
        const double* bj = b + j + k0 * ldb;
        Index ldbj = ldb;
        if (columns < kNr) {
          for (int i = 0; i < kc; ++i) {
            for (int q = 0; q < kNr; ++q)
              padded[i * kNr + q] = q < columns ? bj[q + i * ldb] : 0.0;
          }
          bj = padded;
          ldbj = kNr;
        }
        int i = i0;
        if (kLower && j >= i0) {
          DiagonalTile<kSign>(kc, ak + j, lda, bj, ldbj, c + j + j * ldc, ldc, columns);
          i = j + columns;
        }
        RankColumn<kSign>(i1 - i, kc, ak + i, lda, bj, ldbj, c + i + j * ldc, ldc, columns);
      }
    }
  }
}

void SyrkLowerSub(int n, int k, const double* w, int ldw, double* s, int lds) {
  RankUpdate<true, kSub>(n, n, k, w, ldw, w, ldw, s, lds);
}
void SyrkLowerAdd(int n, int k, const double* w, int ldw, double* s, int lds) {
  RankUpdate<true, kAdd>(n, n, k, w, ldw, w, ldw, s, lds);
}
void SyrkLowerSetNegative(int n, int k, const double* w, int ldw, double* s, int lds) {
  const int first = Min(k, kDepth);
  RankUpdate<true, kSetNegative>(n, n, first, w, ldw, w, ldw, s, lds);
  RankUpdate<true, kSub>(n, n, k - first, w + static_cast<Index>(first) * ldw, ldw,
                         w + static_cast<Index>(first) * ldw, ldw, s, lds);
}
void GemmNtSub(int m, int n, int k, const double* a, int lda, const double* b, int ldb, double* c,
               int ldc) {
  RankUpdate<false, kSub>(m, n, k, a, lda, b, ldb, c, ldc);
}
void GemmNtAdd(int m, int n, int k, const double* a, int lda, const double* b, int ldb, double* c,
               int ldc) {
  RankUpdate<false, kAdd>(m, n, k, a, lda, b, ldb, c, ldc);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_
