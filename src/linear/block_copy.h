// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace glissade::internal {

enum class BlockCopy { kSet, kAdd };

template <BlockCopy kMode, int kRows>
inline void CopyColumns(int rows, int cols, const double* from, std::ptrdiff_t from_stride,
                        double* to, std::ptrdiff_t to_stride) {
  const int count = kRows > 0 ? kRows : rows;
  for (int c = 0; c < cols; ++c, from += from_stride, to += to_stride) {
    for (int r = 0; r < count; ++r)
      to[r] = kMode == BlockCopy::kAdd ? to[r] + from[r] : from[r];
  }
}

/// Sets or adds a small block, column by column. Loops over the heights that occur (pose, speed and
/// biases) are unrolled: as run-time loops they cost more than what they move.
template <BlockCopy kMode>
inline void CopyBlock(int rows, int cols, const double* from, std::ptrdiff_t from_stride,
                      double* to, std::ptrdiff_t to_stride) {
  if (rows == 6) {
    CopyColumns<kMode, 6>(rows, cols, from, from_stride, to, to_stride);
  } else if (rows == 9) {
    CopyColumns<kMode, 9>(rows, cols, from, from_stride, to, to_stride);
  } else {
    CopyColumns<kMode, 0>(rows, cols, from, from_stride, to, to_stride);
  }
}

template <int kRows, int kCols>
inline void TransposeInto(const double* from, double* to, std::ptrdiff_t to_stride) {
  for (int c = 0; c < kCols; ++c) {
    for (int r = 0; r < kRows; ++r)
      to[r + c * to_stride] = from[r * kCols + c];
  }
}

/// to (column-major) = from (rows x cols, row-major).
inline void CopyRowMajorBlock(int rows, int cols, const double* from, double* to,
                              std::ptrdiff_t to_stride) {
  if (rows == 6 && cols == 6) return TransposeInto<6, 6>(from, to, to_stride);
  if (rows == 9 && cols == 6) return TransposeInto<9, 6>(from, to, to_stride);
  if (rows == 9 && cols == 9) return TransposeInto<9, 9>(from, to, to_stride);
  if (rows == 6 && cols == 9) return TransposeInto<6, 9>(from, to, to_stride);
  for (int c = 0; c < cols; ++c) {
    for (int r = 0; r < rows; ++r)
      to[r + c * to_stride] = from[r * cols + c];
  }
}

}  // namespace glissade::internal
