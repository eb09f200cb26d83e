// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covariance/reduced_factor.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade::internal {

// S into the factor's storage, lower triangle, damping taken out.
void ReducedFactor::Scale(const SchurOperator& S, const NormalEquations& equations) {
  std::fill(factor_.begin(), factor_.end(), 0.0);
  const SchurLayout& layout = S.layout();
  // The one block of a dense S is all of it.
  const bool dense = equations.reduced_form() == SchurForm::kDense;
  const auto dim = [&](std::int32_t vertex) { return dense ? n_ : layout.Dim(vertex); };
  for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
    const BlockIndex at = layout.blocks[k];
    const BlockView block = S.Block(k);
    const std::int64_t row = layout.offsets[Index(at.row)], col = layout.offsets[Index(at.col)];
    const int rows = dim(at.row);
    for (int c = 0; c < dim(at.col); ++c) {
      const double* from = block.data + c * block.stride;
      double* to = factor_.data() + (col + c) * stride_ + row;
      const double by = inverse_scale_[Index(col + c)];
      for (int r = at.row == at.col ? c : 0; r < rows; ++r)
        to[r] = from[r] * by * inverse_scale_[Index(row + r)];
    }
  }
  for (int k = 0; k < n_; ++k) {
    double& pivot = factor_[Index(k) * Index(stride_) + Index(k)];
    const double by = inverse_scale_[Index(k)];
    if (held_[Index(k)] == 0) pivot -= equations.DampingAt(Index(k)) * by * by;
    // A coordinate that nothing sees.
    if (by == 0.0) pivot = 0.0;
  }
}

bool ReducedFactor::Factor(NormalEquations* equations, double min_pivot) {
  const SchurOperator& S = equations->reduced();
  n_ = static_cast<int>(S.layout().size());
  constexpr int kVector = 8;
  stride_ = (n_ + kVector - 1) / kVector * kVector;
  factor_.resize(Index(n_) * Index(stride_));
  inverse_scale_.resize(Index(n_));
  held_.assign(equations->held().begin(), equations->held().end());
  missing_.assign(Index(n_), 0);
  num_missing_ = 0;
  for (int k = 0; k < n_; ++k) {
    // Relative to H's own diagonal: what elimination leaves of it is then told from rounding.
    const double h = held_[Index(k)] != 0 ? 1.0 : equations->eliminated_diagonal()[Index(k)];
    inverse_scale_[Index(k)] = h > 0.0 ? 1.0 / std::sqrt(h) : 0.0;
  }
  Scale(S, *equations);
  bool good = kernels::Kernels().cholesky(n_, factor_.data(), stride_) == 0;
  for (int k = 0; good && k < n_; ++k) {
    const double pivot = factor_[Index(k) * Index(stride_) + Index(k)];
    good = pivot * pivot > min_pivot;
  }
  if (good) return true;

  // The slow way, once, to name all of them: pivots without information are skipped.
  Scale(S, *equations);
  for (int c = 0; c < n_; ++c) {
    double* column = factor_.data() + Index(c) * Index(stride_);
    if (!(column[c] > min_pivot)) {
      missing_[Index(c)] = 1;
      ++num_missing_;
      std::fill(column + c, column + n_, 0.0);
      continue;
    }
    const double pivot = std::sqrt(column[c]);
    for (int r = c; r < n_; ++r)
      column[r] /= pivot;
    for (int k = c + 1; k < n_; ++k) {
      double* other = factor_.data() + Index(k) * Index(stride_);
      for (int r = k; r < n_; ++r)
        other[r] -= column[r] * column[k];
    }
  }
  return false;
}

void ReducedFactor::SelectPose(const PoseBlock& pose, std::span<const FreeTangent> tangents,
                               double* Y) const {
  const auto at = [&](int row, int col) -> double& {
    return Y[Index(row) + Index(col) * Index(n_)];
  };
  if (pose.free_tangent < 0) {
    for (int k = 0; k < pose.dim; ++k)
      at(pose.offset + k, k) = 1.0;
    return;
  }
  // tangent = E d: row c of E in the free coordinates.
  const FreeTangent& tangent = tangents[Index(pose.free_tangent)];
  for (int c = 0; c < pose.dim; ++c) {
    for (int k = 0; k < tangent.free_dim; ++k)
      at(pose.offset + k, c) = tangent.basis[c * tangent.free_dim + k];
  }
}

void ReducedFactor::ForwardSolve(int m, double* Y) const {
  if (n_ == 0 || m == 0) return;
  for (int c = 0; c < m; ++c) {
    double* column = Y + Index(c) * Index(n_);
    for (int k = 0; k < n_; ++k)
      column[k] *= held_[Index(k)] != 0 ? 0.0 : inverse_scale_[Index(k)];
  }
  kernels::Kernels().forward_solve_many(n_, factor_.data(), stride_, m, Y, n_);
}

}  // namespace glissade::internal
