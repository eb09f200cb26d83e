// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/edge_options.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "glissade/base/validate.h"

namespace glissade::internal {

bool SqrtOfInformation(int n, const double* omega, double* sqrt) {
  const auto at = [n](int row, int col) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
           static_cast<std::size_t>(col);
  };
  double largest = 0.0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, std::abs(omega[at(i, i)]));
  const double tolerance = 64.0 * n * std::numeric_limits<double>::epsilon();
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale = std::abs(omega[at(i, j)]) + std::abs(omega[at(j, i)]);
      if (std::abs(omega[at(i, j)] - omega[at(j, i)]) > 1e-9 * scale + tolerance * largest) {
        return false;
      }
    }
  }
  // Pivoted Cholesky on a symmetrised, diagonally scaled copy, so that units do not matter.
  std::vector<double> a(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  std::vector<double> scale(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double d = omega[at(i, i)];
    if (d < 0.0) return false;
    scale[static_cast<std::size_t>(i)] = d > 0.0 ? std::sqrt(d) : 1.0;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      a[at(i, j)] = 0.5 * (omega[at(i, j)] + omega[at(j, i)]) /
                    (scale[static_cast<std::size_t>(i)] * scale[static_cast<std::size_t>(j)]);
    }
  }
  std::fill_n(sqrt, n * n, 0.0);
  std::vector<char> done(static_cast<std::size_t>(n), 0);
  for (int row = 0; row < n; ++row) {
    int pivot = -1;
    for (int i = 0; i < n; ++i) {
      if (!done[static_cast<std::size_t>(i)] && (pivot < 0 || a[at(i, i)] > a[at(pivot, pivot)])) {
        pivot = i;
      }
    }
    if (a[at(pivot, pivot)] <= tolerance) break;  // the rest carries no information
    done[static_cast<std::size_t>(pivot)] = 1;
    const double root = std::sqrt(a[at(pivot, pivot)]);
    for (int j = 0; j < n; ++j) {
      if (j != pivot && done[static_cast<std::size_t>(j)]) continue;
      sqrt[at(row, j)] = j == pivot ? root : a[at(pivot, j)] / root;
    }
    for (int i = 0; i < n; ++i) {
      if (done[static_cast<std::size_t>(i)]) continue;
      for (int j = 0; j < n; ++j) {
        if (!done[static_cast<std::size_t>(j)]) a[at(i, j)] -= sqrt[at(row, i)] * sqrt[at(row, j)];
      }
    }
  }
  // What could not be eliminated must vanish, or Omega was indefinite.
  for (int i = 0; i < n; ++i) {
    if (done[static_cast<std::size_t>(i)]) continue;
    for (int j = 0; j < n; ++j) {
      if (!done[static_cast<std::size_t>(j)] && std::abs(a[at(i, j)]) > 1e3 * tolerance) {
        return false;
      }
    }
  }
  for (int row = 0; row < n; ++row) {
    for (int j = 0; j < n; ++j)
      sqrt[at(row, j)] *= scale[static_cast<std::size_t>(j)];
  }
  return true;
}

Status MakeSqrtInformation(int rows, const EdgeWeight& weight, double* sqrt, bool* identity) {
  const int size = rows * rows;
  if (weight.sqrt_information != nullptr && weight.information != nullptr) {
    return {StatusCode::kInvalidArgument, "give information or sqrt_information, not both"};
  }
  if (weight.sqrt_information != nullptr) {
    if (!AllFinite(weight.sqrt_information, size)) {
      return {StatusCode::kNotFinite, "square-root information is not finite"};
    }
    std::copy_n(weight.sqrt_information, size, sqrt);
  } else if (weight.information != nullptr) {
    if (!AllFinite(weight.information, size)) {
      return {StatusCode::kNotFinite, "information is not finite"};
    }
    if (!SqrtOfInformation(rows, weight.information, sqrt)) {
      return {StatusCode::kNotPositive, "information is not symmetric positive semi-definite"};
    }
  } else {
    std::fill_n(sqrt, size, 0.0);
    for (int i = 0; i < rows; ++i)
      sqrt[i * (rows + 1)] = 1.0;
    *identity = true;
    return {};
  }
  *identity = true;
  for (int i = 0; i < size; ++i)
    *identity = *identity && sqrt[i] == (i % (rows + 1) == 0 ? 1.0 : 0.0);
  return {};
}

}  // namespace glissade::internal
