// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Forward substitution with the lower factor L and many right-hand sides.
//
// kRhs right-hand sides are taken at a time and copied, a chunk of rows after the other, to a
// buffer where they are contiguous, so that lanes run along right-hand sides and every entry of L
// is a broadcast.

#ifndef GLISSADE_KERNELS_IMPL_TRIANGULAR_MANY_H_
#define GLISSADE_KERNELS_IMPL_TRIANGULAR_MANY_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

constexpr int kRhsVectors = 2;
constexpr int kRhs = kRhsVectors * kW;
constexpr int kChunk = 192;  // rows in the buffer: 24 KiB with AVX-512
constexpr int kFetch = 32;   // rows fetched from outside the chunk at a time
constexpr int kSolveRows = GLISSADE_KERNEL_WIDTH == 8 ? 8 : 4;  // rows in registers

GLISSADE_INLINE void FetchRows(int rows, int columns, const double* b, Index ldb, double* packed) {
  if (columns < kRhs) {
    for (int i = 0; i < rows * kRhs; ++i)
      packed[i] = 0.0;
  }
  for (int c = 0; c < columns; ++c) {
    for (int i = 0; i < rows; ++i)
      packed[i * kRhs + c] = b[i + c * ldb];
  }
}

GLISSADE_INLINE void PutRows(int rows, int columns, const double* packed, double* b, Index ldb) {
  for (int c = 0; c < columns; ++c) {
    for (int i = 0; i < rows; ++i)
      b[i + c * ldb] = packed[i * kRhs + c];
  }
}

/// y(r, :) -= sum_k l(r, k) x(k, :) for kRows rows, where l(r, k) is l[r + k * ld].
template <int kRows>
GLISSADE_INLINE void SubtractRows(int k, const double* l, Index ld, const double* x, double* y) {
  vd sum[kRows][kRhsVectors];
#pragma GCC unroll 8
  for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 2
    for (int v = 0; v < kRhsVectors; ++v)
      sum[r][v] = Load(y + r * kRhs + v * kW);
  }
#pragma GCC unroll 1
  for (int i = 0; i < k; ++i) {
    vd xi[kRhsVectors];
#pragma GCC unroll 2
    for (int v = 0; v < kRhsVectors; ++v)
      xi[v] = Load(x + v * kW);
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
      const vd s = Splat(l[r]);
#pragma GCC unroll 2
      for (int v = 0; v < kRhsVectors; ++v)
        sum[r][v] -= s * xi[v];
    }
    l += ld;
    x += kRhs;
  }
#pragma GCC unroll 8
  for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 2
    for (int v = 0; v < kRhsVectors; ++v)
      Store(y + r * kRhs + v * kW, sum[r][v]);
  }
}

inline void SubtractAllRows(int rows, int k, const double* l, Index ld, const double* x,
                            double* y) {
  int r = 0;
  for (; r + kSolveRows <= rows; r += kSolveRows) {
    SubtractRows<kSolveRows>(k, l + r, ld, x, y + r * kRhs);
  }
  for (; r < rows; ++r)
    SubtractRows<1>(k, l + r, ld, x, y + r * kRhs);
}

/// Divides row y by the pivot.
GLISSADE_INLINE void ScaleRow(double pivot, double* y) {
  const vd inverse = Splat(1.0 / pivot);
#pragma GCC unroll 2
  for (int v = 0; v < kRhsVectors; ++v)
    Store(y + v * kW, Load(y + v * kW) * inverse);
}

/// Solves with the rows x rows lower triangle at l, in the buffer.
inline void SolveChunkForward(int rows, const double* l, Index ld, double* y) {
  for (int r = 0; r < rows; r += kSolveRows) {
    const int w = Min(kSolveRows, rows - r);
    SubtractAllRows(w, r, l + r, ld, y, y + r * kRhs);
    for (int q = 0; q < w; ++q) {
      const double* diagonal = l + (r + q) + (r + q) * ld;
      SubtractRows<1>(q, diagonal - q * ld, ld, y + r * kRhs, y + (r + q) * kRhs);
      ScaleRow(*diagonal, y + (r + q) * kRhs);
    }
  }
}

void ForwardSolveMany(int n, const double* l, int lda, int nrhs, double* b, int ldb) {
  const Index ld = lda;
  double chunk[kChunk * kRhs];
  double fetched[kFetch * kRhs];
  for (int c = 0; c < nrhs; c += kRhs) {
    const int columns = Min(kRhs, nrhs - c);
    double* bc = b + c * static_cast<Index>(ldb);
    for (int r = 0; r < n; r += kChunk) {
      const int rows = Min(kChunk, n - r);
      FetchRows(rows, columns, bc + r, ldb, chunk);
      for (int k = 0; k < r; k += kFetch) {  // kChunk is a multiple of kFetch
        FetchRows(kFetch, columns, bc + k, ldb, fetched);
        SubtractAllRows(rows, kFetch, l + r + k * ld, ld, fetched, chunk);
      }
      SolveChunkForward(rows, l + r + r * ld, ld, chunk);
      PutRows(rows, columns, chunk, bc + r, ldb);
    }
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TRIANGULAR_MANY_H_
