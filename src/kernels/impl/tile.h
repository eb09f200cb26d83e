// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The register tile all dense kernels share: kTileRows vectors of rows by kNr columns, the sum over
// k of A(:,k) B(:,k)' kept in registers. Lanes run along rows, so A is loaded and B is broadcast.

#ifndef GLISSADE_KERNELS_IMPL_TILE_H_
#define GLISSADE_KERNELS_IMPL_TILE_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

// Columns of a tile, a multiple of kW; and its height in vectors: 24 of 32 registers accumulate
// with AVX-512, 12 of 16 with AVX2; SSE2 needs registers for the products, having no fused
// multiply-add.
#if GLISSADE_KERNEL_WIDTH == 8
constexpr int kNr = 8;
constexpr int kMr = 3;
#elif GLISSADE_KERNEL_WIDTH == 4
constexpr int kNr = 4;
constexpr int kMr = 3;
#else
constexpr int kNr = 4;
constexpr int kMr = 2;
#endif

template <int R>
struct Tile {
  vd v[kNr][R];
};

/// R vectors of rows; when partial the last one has only `last` rows.
template <int R, bool kPartial>
GLISSADE_INLINE void LoadRows(const double* p, int last, vd (&out)[R]) {
#pragma GCC unroll 4
  for (int r = 0; r < R; ++r) {
    out[r] = kPartial && r == R - 1 ? LoadPartial(p + r * kW, last) : Load(p + r * kW);
  }
}

template <int R>
GLISSADE_INLINE void ClearTile(Tile<R>& t) {
#pragma GCC unroll 8
  for (int c = 0; c < kNr; ++c) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r)
      t.v[c][r] = Zero();
  }
}

/// t += x b' in the first kRows vectors of rows; b: kNr numbers.
template <int kRows, int R>
GLISSADE_INLINE void AddOuter(const vd (&x)[kRows], const double* b, Tile<R>& t) {
#pragma GCC unroll 8
  for (int c = 0; c < kNr; ++c) {
    const vd y = Splat(b[c]);
#pragma GCC unroll 4
    for (int r = 0; r < kRows; ++r)
      t.v[c][r] += x[r] * y;
  }
}

/// t = sum_k a(:,k) b(:,k)'. b points at kNr values for k = 0; the next k are ldb further.
template <int R, bool kPartial>
GLISSADE_INLINE void TileProduct(int k, const double* a, Index lda, const double* b, Index ldb,
                                 int last, Tile<R>& t) {
  ClearTile(t);
#pragma GCC unroll 1
  for (int i = 0; i < k; ++i) {
    vd x[R];
    LoadRows<R, kPartial>(a, last, x);
    AddOuter(x, b, t);
    a += lda;
    b += ldb;
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TILE_H_
