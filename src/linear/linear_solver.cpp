// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/linear_solver.h"

#include <algorithm>

#include "kernels/kernels.h"
#include "linear/threaded_cholesky.h"

namespace glissade {

LinearSolverResult DenseCholeskySolver::Prepare(const SchurOperator& S) {
  const BlockView block = S.Block(0);
  const auto n = static_cast<std::size_t>(S.layout().size());
  const auto stride = static_cast<std::size_t>(block.stride);
  stride_ = static_cast<int>(stride);
  factor_.resize(stride * n);
  for (std::size_t col = 0; col < n; ++col) {
    const double* from = block.data + col * stride;
    std::copy(from + col, from + n, factor_.data() + col * stride + col);
  }
  LinearSolverResult result;
  const int size = static_cast<int>(n);
  result.failed_pivot =
      ThreadedCholesky(size, size, factor_.data(), stride_, threads_, &scratch_) - 1;
  result.ok = result.failed_pivot < 0;
  return result;
}

LinearSolverResult DenseCholeskySolver::Solve(const SchurOperator& S, const double* b, double* x,
                                              const SolveRequest&) {
  const auto n = static_cast<int>(S.layout().size());
  std::copy_n(b, n, x);
  kernels::Kernels().cholesky_solve(n, factor_.data(), stride_, x);
  LinearSolverResult result;
  result.ok = true;
  return result;
}

}  // namespace glissade
