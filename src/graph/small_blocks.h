// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Sums and products of the small row-major blocks of one edge, as plain loops. Numbers of columns
/// that are usual are known to the compiler, so that it unrolls and vectorizes the inner loop.
namespace glissade::internal {

namespace fixed {

/// kCols: the number of columns, or 0 where it is `cols`.
template <int kCols>
inline void AddTransposedProduct(int rows, int a_cols, int cols, double sign, const double* a,
                                 const double* b, double* out) {
  const int n = kCols > 0 ? kCols : cols;
  for (int i = 0; i < a_cols; ++i) {
    double* const to = out + i * n;
    if constexpr (kCols > 0) {
      double row[kCols] = {};
      for (int k = 0; k < rows; ++k) {
        const double x = sign * a[k * a_cols + i];
        for (int j = 0; j < kCols; ++j)
          row[j] += x * b[k * kCols + j];
      }
      for (int j = 0; j < kCols; ++j)
        to[j] += row[j];
    } else {
      for (int j = 0; j < n; ++j) {
        double sum = 0.0;
        for (int k = 0; k < rows; ++k)
          sum += sign * a[k * a_cols + i] * b[k * n + j];
        to[j] += sum;
      }
    }
  }
}

}  // namespace fixed

/// out (a_cols x cols) += sign * a' b, with a (rows x a_cols) and b (rows x cols).
inline void AddTransposedProduct(int rows, int a_cols, int cols, double sign, const double* a,
                                 const double* b, double* out) {
  switch (cols) {
    case 1:
      return fixed::AddTransposedProduct<1>(rows, a_cols, cols, sign, a, b, out);
    case 2:
      return fixed::AddTransposedProduct<2>(rows, a_cols, cols, sign, a, b, out);
    case 3:
      return fixed::AddTransposedProduct<3>(rows, a_cols, cols, sign, a, b, out);
    case 4:
      return fixed::AddTransposedProduct<4>(rows, a_cols, cols, sign, a, b, out);
    case 6:
      return fixed::AddTransposedProduct<6>(rows, a_cols, cols, sign, a, b, out);
    case 9:
      return fixed::AddTransposedProduct<9>(rows, a_cols, cols, sign, a, b, out);
    default:
      return fixed::AddTransposedProduct<0>(rows, a_cols, cols, sign, a, b, out);
  }
}

/// x (rows x cols) <- L x, with L (rows x rows). work: as large as x.
inline void MultiplyInPlace(int rows, int cols, const double* L, double* x, double* work) {
  for (int i = 0; i < rows; ++i) {
    double* const row = work + i * cols;
    for (int j = 0; j < cols; ++j)
      row[j] = 0.0;
    for (int k = 0; k < rows; ++k) {
      const double l = L[i * rows + k];
      for (int j = 0; j < cols; ++j)
        row[j] += l * x[k * cols + j];
    }
  }
  for (int i = 0; i < rows * cols; ++i)
    x[i] = work[i];
}

inline double SquaredNorm(int size, const double* x) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i)
    sum += x[i] * x[i];
  return sum;
}

/// 0 if all are finite, else NaN: 0 * x is 0 exactly where x is finite.
inline double Poison(int size, const double* x) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i)
    sum += 0.0 * x[i];
  return sum;
}

/// out (rows x cols, row-major) -= block, whose rows are `stride` apart.
inline void SubtractBlock(int rows, int cols, int stride, const double* block, double* out) {
  for (int a = 0; a < rows; ++a) {
    for (int b = 0; b < cols; ++b)
      out[a * cols + b] -= block[a * stride + b];
  }
}

/// out (rows x cols, row-major) -= block', block of `cols` rows that are `stride` apart.
inline void SubtractTransposed(int rows, int cols, int stride, const double* block, double* out) {
  for (int a = 0; a < rows; ++a) {
    for (int b = 0; b < cols; ++b)
      out[a * cols + b] -= block[b * stride + a];
  }
}

/// out (n x n, row-major) -= the symmetric block of which block[c * stride + k], k >= c, is given.
inline void SubtractLower(int n, int stride, const double* block, double* out) {
  for (int c = 0; c < n; ++c) {
    out[c * n + c] -= block[c * stride + c];
    for (int k = c + 1; k < n; ++k) {
      const double value = block[c * stride + k];
      out[c * n + k] -= value;
      out[k * n + c] -= value;
    }
  }
}

}  // namespace glissade::internal
