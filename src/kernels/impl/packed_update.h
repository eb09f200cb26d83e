// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// S -= W W' for matrices that are larger than the caches: W is first copied so that what a tile
// reads lies together (K. Goto, R. van de Geijn, "Anatomy of high-performance matrix
// multiplication", ACM TOMS 2008). Groups of as many rows as a tile has, each k by k; the kNr rows
// that a column of tiles multiplies with are a part of such a group.

#ifndef GLISSADE_KERNELS_IMPL_PACKED_UPDATE_H_
#define GLISSADE_KERNELS_IMPL_PACKED_UPDATE_H_

#include "kernels/impl/rank_update.h"
#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

constexpr int kGroup = kMr * kW;
static_assert(kGroup % kNr == 0 && kPackedRows % kGroup == 0);
static_assert(kColumnBlock % kNr == 0);
/// Columns of S whose rows of W stay in the second-level cache while all groups pass by.
constexpr int kColumnsAtOnce = 240;

void PackRows(int n, int k, const double* w, int ldw, double* packed) {
  for (int i0 = 0; i0 < n; i0 += kGroup) {
    const int rows = Min(kGroup, n - i0);
    for (int c = 0; c < k; ++c, packed += kGroup) {
      const double* from = w + i0 + static_cast<Index>(c) * ldw;
      for (int i = 0; i < rows; ++i)
        packed[i] = from[i];
      for (int i = rows; i < kGroup; ++i)
        packed[i] = 0.0;
    }
  }
}

/// The next tile's part of S is asked for while this one is computed.
GLISSADE_INLINE void PrefetchTile(const double* c, Index ldc) {
#pragma GCC unroll 8
  for (int q = 0; q < kNr; ++q) {
    __builtin_prefetch(c + q * ldc, 1);
    __builtin_prefetch(c + q * ldc + kGroup - 1, 1);
  }
}

void SyrkPackedSub(int n, int k, const double* packed, double* s, int lds, int begin, int end) {
  const Index ld = lds;
  const auto rows_of = [&](int row) {
    return packed + static_cast<Index>(row / kGroup) * kGroup * k + row % kGroup;
  };
  for (int j0 = begin; j0 < end; j0 += kColumnsAtOnce) {
    const int j1 = Min(end, j0 + kColumnsAtOnce);
    for (int i0 = j0 - j0 % kGroup; i0 < n; i0 += kGroup) {
      const int i1 = Min(n, i0 + kGroup);
      for (int j = j0; j < Min(j1, i1); j += kNr) {
        const int columns = Min(kNr, n - j);
        const double* b = rows_of(j);
        int i = i0;
        if (j >= i0) {
          DiagonalTile<kSub>(k, b, kGroup, b, kGroup, s + j + j * ld, ld, columns);
          i = j + columns;
        } else if (j + 2 * kNr <= Min(j1, i0)) {
          PrefetchTile(s + i0 + (j + kNr) * ld, ld);
        }
        if (i < i1)
          RankColumn<kSub>(i1 - i, k, rows_of(i), kGroup, b, kGroup, s + i + j * ld, ld, columns);
      }
    }
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_PACKED_UPDATE_H_
