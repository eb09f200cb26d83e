// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "glissade/losses/loss.h"

/// \file
/// Weights of edges as Python gives them.
namespace glissade::python {

/// One matrix for all edges, or one each: of shape (), (r,), (r, r) or (n, r, r); a scalar and a
/// vector are the diagonal.
class Weights {
 public:
  /// At most one of the two; neither means the identity. ValueError for another shape.
  Weights(const std::optional<ArrayLike>& sqrt_information,
          const std::optional<ArrayLike>& information, std::size_t rows, std::size_t num_edges);

  /// Square roots instead of the information, of the same number.
  void SetSqrt(std::vector<double> matrices) {
    matrices_ = std::move(matrices);
    is_sqrt_ = true;
  }

  [[nodiscard]] bool is_finite() const {
    return std::all_of(matrices_.begin(), matrices_.end(),
                       [](double x) { return std::isfinite(x); });
  }
  [[nodiscard]] bool is_identity() const { return matrices_.empty(); }
  [[nodiscard]] bool is_sqrt() const { return is_sqrt_; }
  [[nodiscard]] bool same_for_all() const { return matrices_.size() == rows_ * rows_; }
  /// Of an edge: rows x rows, row-major.
  [[nodiscard]] const double* Of(std::size_t edge) const {
    return matrices_.data() + (same_for_all() ? 0 : edge * rows_ * rows_);
  }

 private:
  std::size_t rows_;
  bool is_sqrt_ = true;
  std::vector<double> matrices_;
};

inline constexpr const char* kWeightDoc =
    "sqrt_information L (the residual is L r) or information Omega = L'L: a number, (r,) diagonal, "
    "(r, r), or (n, r, r) one for each edge.";

}  // namespace glissade::python
