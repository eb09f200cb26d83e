// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/edges/concept.h"
#include "glissade/losses/loss.h"

namespace glissade {

/// Weight and loss an edge of type E is added with.
template <class E>
struct EdgeOptions {
  using Information = SquareMatrix<E::kResidualDim>;

  /// L of the whitened residual L r, with Omega = L' L. At most one of the two is given; neither
  /// means the identity.
  std::optional<Information> sqrt_information = std::nullopt;
  /// Omega: symmetric, positive semi-definite.
  std::optional<Information> information = std::nullopt;
  Loss loss = {};
};

namespace internal {

/// L (n x n row-major, upper triangular up to a row permutation) with L' L = Omega, by pivoted
/// Cholesky; false where Omega is not symmetric positive semi-definite.
bool SqrtOfInformation(int n, const double* omega, double* sqrt);

/// What the user gave as a weight: rows x rows, row-major, or null.
struct EdgeWeight {
  const double* sqrt_information = nullptr;
  const double* information = nullptr;
};
template <class E>
EdgeWeight WeightOf(const EdgeOptions<E>& options) {
  return {options.sqrt_information ? options.sqrt_information->data() : nullptr,
          options.information ? options.information->data() : nullptr};
}

/// Checks and converts it to L (rows x rows); identity is set where L = I.
Status MakeSqrtInformation(int rows, const EdgeWeight& weight, double* sqrt, bool* identity);

}  // namespace internal
}  // namespace glissade
