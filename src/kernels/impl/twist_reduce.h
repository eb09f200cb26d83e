// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The product of a group's panel with its transpose; see kernels/twists.h.

#ifndef GLISSADE_KERNELS_IMPL_TWIST_REDUCE_H_
#define GLISSADE_KERNELS_IMPL_TWIST_REDUCE_H_

#include "kernels/impl/tile.h"
#include "kernels/impl/twists.h"

namespace glissade::kernels {
namespace {

/// Columns that the rows of a panel from 8 * block on have numbers in.
GLISSADE_INLINE int PanelDepth(const TwistGroup& group, int block) {
  const int target = (kPanelRows * block - FirstTargetRow(group)) / 6;
  return group.dim * (block == 0 ? group.used : group.targets[target].used);
}

/// Adds column k of A times row k of B' to the first kRows vectors of the tile.
template <int kRows, int R>
GLISSADE_INLINE void TileStep(const double* a, const double* b, Tile<R>& t) {
  vd x[kRows];
  LoadRows<kRows, false>(a, kW, x);
  AddOuter(x, b, t);
}

/// C = -A B' for R vectors of rows, of which the r-th has depth[r] columns.
template <int R>
__attribute__((noinline)) void FallingTile(const int (&depth)[kMr], const double* a,
                                           const double* b, Index ld, double* c, Index ldc) {
  Tile<R> t;
  ClearTile(t);
  int k = 0;
  if constexpr (R > 2) {
#pragma GCC unroll 1
    for (; k < depth[2]; ++k, a += ld, b += ld)
      TileStep<3>(a, b, t);
  }
  if constexpr (R > 1) {
#pragma GCC unroll 1
    for (; k < depth[1]; ++k, a += ld, b += ld)
      TileStep<2>(a, b, t);
  }
#pragma GCC unroll 1
  for (; k < depth[0]; ++k, a += ld, b += ld)
    TileStep<1>(a, b, t);
#pragma GCC unroll 8
  for (int j = 0; j < kNr; ++j) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r)
      Store(c + j * ldc + r * kW, -t.v[j][r]);
  }
}

void TwistReduce(const TwistGroup* group, const double* w, double* reduced) {
  const int n = TwistRows(*group);
  const int stride = (n + kPanelRows - 1) / kPanelRows * kPanelRows;
  const Index ld = stride;
  for (int j = 0; j < stride; j += kNr) {
    for (int i = j; i < stride; i += kMr * kW) {
      int depth[kMr];
      const int vectors = Min(kMr, (stride - i) / kW);
      for (int r = 0; r < vectors; ++r)
        depth[r] = PanelDepth(*group, (i + r * kW) / kPanelRows);
      const double *a = w + i, *b = w + j;
      double* c = reduced + i + j * ld;
      if (vectors == 1) {
        FallingTile<1>(depth, a, b, ld, c, ld);
      } else if (vectors == 2) {
        FallingTile<2>(depth, a, b, ld, c, ld);
      } else {
        FallingTile<kMr>(depth, a, b, ld, c, ld);
      }
    }
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWIST_REDUCE_H_
