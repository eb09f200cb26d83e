// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/linear_solver.h"

#include <algorithm>
#include <cmath>

#include "kernels/kernels.h"

namespace glissade {

void ReducedSystem::Multiply(const double* x, double* y) const {
  kernels::Kernels().symv_lower(size, S, stride, x, y);
}

LinearSolverResult DenseCholeskySolver::Solve(const ReducedSystem& system, double* x) {
  const auto stride = static_cast<std::size_t>(system.stride);
  const int n = system.size;
  factor_.resize(stride * static_cast<std::size_t>(n));
  for (int col = 0; col < n; ++col) {
    const std::size_t begin = static_cast<std::size_t>(col) * stride;
    std::copy(system.S + begin + col, system.S + begin + n, factor_.data() + begin + col);
  }
  LinearSolverResult result;
  const kernels::KernelTable& kernel = kernels::Kernels();
  result.failed_pivot = kernel.cholesky(n, factor_.data(), system.stride) - 1;
  if (result.failed_pivot >= 0) return result;
  std::copy_n(system.b, n, x);
  kernel.cholesky_solve(n, factor_.data(), system.stride, x);
  result.ok = true;
  return result;
}

}  // namespace glissade
