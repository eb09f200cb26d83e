// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// S +-= W W' or S = -W W', lower triangle: the update of Schur complements.
//
// Tiles of tile.h over row blocks that stay in the first-level cache. The kNr rows of W that a
// column of tiles multiplies with are copied to a contiguous buffer where they are fewer,
// zero-padded, which makes column edges ordinary.

#ifndef GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_
#define GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_

#include "kernels/impl/tile.h"
#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

// Columns and rows of W taken at a time: such a block (37 KiB with AVX-512) stays in the
// first-level cache while the columns of S pass by. Copying it to a contiguous buffer did not pay
// (0 to -10 %) except where the leading dimension is a multiple of 512.
constexpr int kDepth = kUpdateDepth;
constexpr int kRowBlock = 2 * kMr * kW;

// What becomes of S: kAdd, kSub, or kSetNegative, which does not read it.
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

/// S combined with W W', lower triangle.
template <int kSign>
void RankUpdate(int n, int k, const double* w, Index ldw, double* s, Index lds) {
  double padded[kDepth * kNr];
  for (int k0 = 0; k0 < k; k0 += kDepth) {
    const int kc = Min(kDepth, k - k0);
    const double* wk = w + k0 * ldw;
    for (int i0 = 0; i0 < n; i0 += kRowBlock) {
      const int i1 = Min(n, i0 + kRowBlock);
      for (int j = 0; j < i1; j += kNr) {
        const int columns = Min(kNr, n - j);
        const double* b = wk + j;
        Index ldb = ldw;
        if (columns < kNr) {
          for (int i = 0; i < kc; ++i) {
            for (int q = 0; q < kNr; ++q)
              padded[i * kNr + q] = q < columns ? b[q + i * ldw] : 0.0;
          }
          b = padded;
          ldb = kNr;
        }
        int i = i0;
        if (j >= i0) {
          DiagonalTile<kSign>(kc, wk + j, ldw, b, ldb, s + j + j * lds, lds, columns);
          i = j + columns;
        }
        RankColumn<kSign>(i1 - i, kc, wk + i, ldw, b, ldb, s + i + j * lds, lds, columns);
      }
    }
  }
}

void SyrkLowerSub(int n, int k, const double* w, int ldw, double* s, int lds) {
  RankUpdate<kSub>(n, k, w, ldw, s, lds);
}
void SyrkLowerAdd(int n, int k, const double* w, int ldw, double* s, int lds) {
  RankUpdate<kAdd>(n, k, w, ldw, s, lds);
}
void SyrkLowerSetNegative(int n, int k, const double* w, int ldw, double* s, int lds) {
  const int first = Min(k, kDepth);
  RankUpdate<kSetNegative>(n, first, w, ldw, s, lds);
  RankUpdate<kSub>(n, k - first, w + static_cast<Index>(first) * ldw, ldw, s, lds);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_RANK_UPDATE_H_
