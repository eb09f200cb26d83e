// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Products of small row-major blocks as plain loops over sizes the compiler knows. It unrolls and
/// vectorizes them as well as Eigen's expressions, and a consumer's translation unit that brings
/// an edge of its own compiles in half the time.
namespace glissade::internal {

/// out (A x B) += sign * a' b, with a (R x A) and b (R x B).
template <int R, int A, int B>
inline void AddTransposedProduct(double sign, const double* a, const double* b, double* out) {
  for (int i = 0; i < A; ++i) {
    double row[B] = {};
    for (int k = 0; k < R; ++k) {
      const double x = sign * a[k * A + i];
      for (int j = 0; j < B; ++j)
        row[j] += x * b[k * B + j];
    }
    for (int j = 0; j < B; ++j)
      out[i * B + j] += row[j];
  }
}

/// x (R x C) <- L x, with L (R x R).
template <int R, int C>
inline void MultiplyInPlace(const double* L, double* x) {
  double product[R * C] = {};
  for (int i = 0; i < R; ++i) {
    for (int k = 0; k < R; ++k) {
      const double l = L[i * R + k];
      for (int j = 0; j < C; ++j)
        product[i * C + j] += l * x[k * C + j];
    }
  }
  for (int i = 0; i < R * C; ++i)
    x[i] = product[i];
}

template <int N>
inline double SquaredNorm(const double* x) {
  double sum = 0.0;
  for (int i = 0; i < N; ++i)
    sum += x[i] * x[i];
  return sum;
}

/// 0 if all are finite, else NaN: 0 * x is 0 exactly where x is finite.
template <int N>
inline double Poison(const double* x) {
  double sum = 0.0;
  for (int i = 0; i < N; ++i)
    sum += 0.0 * x[i];
  return sum;
}

}  // namespace glissade::internal
