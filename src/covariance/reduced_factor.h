// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/graph/fix.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/structure/structure.h"

namespace glissade::internal {

/// The reduced system S of normal equations without its damping, scaled by the diagonal of H
/// (Jacobi) and factored by Cholesky: S = D L L' D, D = diag(H)^1/2.
class ReducedFactor {
 public:
  /// Of what the last Eliminate() left. False where S has directions without information: pivots
  /// below min_pivot, which missing() then marks (none: S is not positive definite for another
  /// reason).
  bool Factor(NormalEquations* equations, double min_pivot);
  [[nodiscard]] const std::vector<std::uint8_t>& missing() const { return missing_; }
  [[nodiscard]] int num_missing() const { return num_missing_; }
  [[nodiscard]] int size() const { return n_; }

  /// Columns, size() x pose.dim from Y on, that select a pose's full tangent. Y is zero before.
  void SelectPose(const PoseBlock& pose, std::span<const FreeTangent> tangents, double* Y) const;
  /// Y <- L^-1 D^-1 Y, m columns; what is held is certain: its rows become zero.
  void ForwardSolve(int m, double* Y) const;

 private:
  void Scale(const SchurOperator& S, const NormalEquations& equations);

  int n_ = 0;
  int stride_ = 0;
  std::vector<double> factor_;
  std::vector<double> inverse_scale_;  // 1 / sqrt(H_kk)
  std::vector<std::uint8_t> held_, missing_;
  int num_missing_ = 0;
};

}  // namespace glissade::internal
