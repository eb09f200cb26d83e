// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/linear/linear_solver.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

int PcgSolver::FactorDiagonalBlock(std::int64_t offset, int dim, BlockView block) {
  if (preconditioner_ == Preconditioner::kJacobi) {
    for (int k = 0; k < dim; ++k) {
      const double d = block.data[k + k * block.stride];
      if (!(d > 0.0)) return static_cast<int>(offset) + k;
      inverse_[Index(offset + k)] = 1.0 / d;
    }
    return -1;
  }
  factor_begin_.push_back(static_cast<std::int64_t>(inverse_.size()));
  inverse_.resize(inverse_.size() + Index(dim) * Index(dim));
  double* factor = inverse_.data() + factor_begin_.back();
  for (int c = 0; c < dim; ++c) {
    for (int r = c; r < dim; ++r)
      factor[r + c * dim] = block.data[r + c * block.stride];
  }
  const int info = kernels::Kernels().cholesky(dim, factor, dim);
  return info == 0 ? -1 : static_cast<int>(offset) + info - 1;
}

LinearSolverResult PcgSolver::Prepare(const SchurOperator& S) {
  const SchurLayout& layout = S.layout();
  factor_begin_.clear();
  inverse_.clear();
  if (preconditioner_ == Preconditioner::kJacobi) inverse_.resize(Index(layout.size()));
  LinearSolverResult result;
  // Blocks are by column, so diagonal ones come in the order of the vertices.
  for (std::size_t k = 0; k < layout.blocks.size() && result.failed_pivot < 0; ++k) {
    const BlockIndex block = layout.blocks[k];
    if (block.row != block.col) continue;
    result.failed_pivot =
        FactorDiagonalBlock(layout.offsets[Index(block.row)], layout.Dim(block.row), S.Block(k));
  }
  result.ok = result.failed_pivot < 0;
  return result;
}

void PcgSolver::Precondition(const SchurLayout& layout, const double* r, double* z) const {
  if (preconditioner_ == Preconditioner::kJacobi) {
    for (std::size_t k = 0; k < inverse_.size(); ++k)
      z[k] = inverse_[k] * r[k];
    return;
  }
  std::copy_n(r, layout.size(), z);
  for (std::size_t v = 0; v < factor_begin_.size(); ++v) {
    const int dim = layout.Dim(static_cast<std::int32_t>(v));
    kernels::Kernels().cholesky_solve(dim, inverse_.data() + factor_begin_[v], dim,
                                      z + layout.offsets[v]);
  }
}

LinearSolverResult PcgSolver::Solve(const SchurOperator& S, const double* b, double* x,
                                    const SolveRequest& request) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const SchurLayout& layout = S.layout();
  const int n = static_cast<int>(layout.size());
  for (std::vector<double>* v : {&r_, &z_, &p_, &q_})
    v->resize(Index(n));
  std::copy_n(b, n, r_.data());
  if (request.guess != nullptr) {
    std::copy_n(request.guess, n, x);
    S.Multiply(x, q_.data());
    kernel.axpy(n, -1.0, q_.data(), r_.data());
  } else {
    std::fill_n(x, n, 0.0);
  }
  const double target = request.tolerance * std::sqrt(kernel.dot(n, b, b));
  const int cap = request.max_iterations > 0 ? request.max_iterations : 2 * n;
  double rho = 0.0;
  LinearSolverResult result;
  result.exact = false;
  result.ok = true;
  while (result.iterations < cap && !request.Stop()) {
    if (std::sqrt(kernel.dot(n, r_.data(), r_.data())) <= target) break;
    Precondition(layout, r_.data(), z_.data());
    const double rho_next = kernel.dot(n, r_.data(), z_.data());
    if (result.iterations == 0) {
      p_ = z_;
    } else {
      const double beta = rho_next / rho;
      for (std::size_t k = 0; k < p_.size(); ++k)
        p_[k] = z_[k] + beta * p_[k];
    }
    rho = rho_next;
    S.Multiply(p_.data(), q_.data());
    const double curvature = kernel.dot(n, p_.data(), q_.data());
    if (!(curvature > 0.0)) {
      // Rounding has eaten what was left of the residual, or S is not positive definite.
      result.ok = result.iterations > 0 && std::isfinite(curvature);
      break;
    }
    const double alpha = rho / curvature;
    kernel.axpy(n, alpha, p_.data(), x);
    kernel.axpy(n, -alpha, q_.data(), r_.data());
    ++result.iterations;
  }
  return result;
}

}  // namespace glissade
