// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>

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

/// Checks and converts what the user gave to L; identity is set where L = I.
template <int R>
Status MakeSqrtInformation(const std::optional<SquareMatrix<R>>& sqrt_information,
                           const std::optional<SquareMatrix<R>>& information, SquareMatrix<R>* sqrt,
                           bool* identity) {
  *sqrt = SquareMatrix<R>::Identity();
  *identity = true;
  if (sqrt_information && information) {
    return {StatusCode::kInvalidArgument, "give information or sqrt_information, not both"};
  }
  if (sqrt_information) {
    if (!sqrt_information->allFinite()) {
      return {StatusCode::kNotFinite, "square-root information is not finite"};
    }
    *sqrt = *sqrt_information;
  } else if (information) {
    if (!information->allFinite()) {
      return {StatusCode::kNotFinite, "information is not finite"};
    }
    if (!SqrtOfInformation(R, information->data(), sqrt->data())) {
      return {StatusCode::kNotPositive, "information is not symmetric positive semi-definite"};
    }
  }
  *identity = *sqrt == SquareMatrix<R>::Identity();
  return {};
}

}  // namespace internal
}  // namespace glissade
