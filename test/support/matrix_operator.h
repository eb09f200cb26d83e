// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "glissade/linear/linear_solver.h"

namespace glissade::test {

/// A dense matrix as the reduced system, in any form: what solvers are tested on.
class MatrixOperator final : public SchurOperator {
 public:
  /// dims: of the blocks; pattern: those of the lower triangle, by column (empty: all of them).
  MatrixOperator(Eigen::MatrixXd S, const std::vector<int>& dims,
                 std::vector<BlockIndex> pattern = {}, std::uint64_t version = 1)
      : S_(std::move(S)), pattern_(std::move(pattern)) {
    offsets_.push_back(0);
    for (const int dim : dims)
      offsets_.push_back(offsets_.back() + dim);
    for (std::int32_t c = 0; pattern_.empty() && c < static_cast<std::int32_t>(dims.size()); ++c) {
      for (std::int32_t r = c; r < static_cast<std::int32_t>(dims.size()); ++r)
        all_.push_back({r, c});
    }
    if (pattern_.empty()) pattern_ = all_;
    layout_ = {offsets_, pattern_, version};
    SetForm(SchurForm::kBlocks);
  }
  MatrixOperator(const MatrixOperator&) = delete;
  MatrixOperator& operator=(const MatrixOperator&) = delete;

  [[nodiscard]] const SchurLayout& all_blocks() const { return layout_; }
  void SetForm(SchurForm form) {
    stored_.clear();
    if (form == SchurForm::kDense) stored_.push_back({0, 0});
    for (const BlockIndex& block : pattern_) {
      if (form == SchurForm::kBlocks ||
          (form == SchurForm::kDiagonalBlocks && block.row == block.col))
        stored_.push_back(block);
    }
    form_layout_ = layout_;
    form_layout_.blocks = stored_;
  }

  [[nodiscard]] const SchurLayout& layout() const override { return form_layout_; }
  [[nodiscard]] BlockView Block(std::size_t k) const override {
    const auto row = offsets_[static_cast<std::size_t>(stored_[k].row)];
    const auto col = offsets_[static_cast<std::size_t>(stored_[k].col)];
    return {S_.data() + row + col * S_.rows(), S_.rows()};
  }
  void Multiply(const double* x, double* y) const override {
    const Eigen::Index n = S_.rows();
    Eigen::Map<Eigen::VectorXd>(y, n) =
        S_.selfadjointView<Eigen::Lower>() * Eigen::Map<const Eigen::VectorXd>(x, n);
  }

 private:
  Eigen::MatrixXd S_;
  std::vector<std::int64_t> offsets_;
  std::vector<BlockIndex> pattern_, all_, stored_;
  SchurLayout layout_, form_layout_;
};

/// Form(), Prepare() and Solve().
inline LinearSolverResult SolveWith(LinearSolver& solver, MatrixOperator& S, const double* b,
                                    double* x, const SolveRequest& request = {}) {
  S.SetForm(solver.Form(S.all_blocks()));
  const LinearSolverResult prepared = solver.Prepare(S);
  return prepared.ok ? solver.Solve(S, b, x, request) : prepared;
}

}  // namespace glissade::test
