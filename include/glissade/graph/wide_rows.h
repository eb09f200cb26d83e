// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/edges/concept.h"
#include "glissade/losses/loss.h"

namespace glissade::internal {

/// First column of vertex i's Jacobian where those of all vertices of E stand side by side; with i
/// = arity, the number of columns.
template <class E>
constexpr int FirstColumn(int i) {
  int column = 0;
  ForEachIndex<E::Vertices::kSize>(
      [&](auto k) { column += k < i ? EdgeVertex<E, k>::kTangentDim : 0; });
  return column;
}

/// Whether rows [J | r] of an edge are worth the library's vector kernels: many rows between large
/// vertices (IMU terms: 15 x 31).
template <class E>
constexpr bool IsWide() {
  bool wide = E::kResidualDim >= 8;
  ForEachIndex<E::Vertices::kSize>(
      [&](auto k) { wide = wide && EdgeVertex<E, k>::kTangentDim > 4; });
  return wide;
}

/// Numbers from row to row of [J | r].
template <class E>
constexpr int WideStride() {
  return (FirstColumn<E>(E::Vertices::kSize) + 1 + 7) / 8 * 8;
}

/// Whitens the rows in `panel` (rows x stride, row-major; columns: J, then r at dims) by L (rows x
/// rows, row-major; null: identity), weighs them by the loss and puts -[J r]'[J r] into `products`
/// (stride x stride): products[c * stride + k] for k >= c. Adds 1/2 rho to the cost.
/// False where something is not finite. `work` is as large as the panel; both are overwritten.
bool SquareRows(int rows, int dims, int stride, const double* L, const Loss& loss, double* panel,
                double* work, double* products, double* cost);

/// out (A x B, row-major) -= block, whose rows are kStride apart.
template <int A, int B, int kStride>
inline void SubtractBlock(const double* block, double* out) {
  for (int a = 0; a < A; ++a) {
    for (int b = 0; b < B; ++b)
      out[a * B + b] -= block[a * kStride + b];
  }
}

/// out (A x B, row-major) -= block', block of B rows that are kStride apart.
template <int A, int B, int kStride>
inline void SubtractTransposed(const double* block, double* out) {
  for (int a = 0; a < A; ++a) {
    for (int b = 0; b < B; ++b)
      out[a * B + b] -= block[b * kStride + a];
  }
}

/// out (A x A, row-major) -= the symmetric block of which block[c * kStride + k], k >= c, is given.
template <int A, int kStride>
inline void SubtractLower(const double* block, double* out) {
  for (int c = 0; c < A; ++c) {
    out[c * A + c] -= block[c * kStride + c];
    for (int k = c + 1; k < A; ++k) {
      const double value = block[c * kStride + k];
      out[c * A + k] -= value;
      out[k * A + c] -= value;
    }
  }
}

}  // namespace glissade::internal
