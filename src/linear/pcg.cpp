// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "glissade/linear/linear_solver.h"
#include "kernels/kernels.h"

namespace glissade {

int PcgSolver::FactorPreconditioner(const ReducedSystem& system) {
  const bool scalar = options_.preconditioner == Preconditioner::kJacobi;
  const std::size_t num_blocks = system.offsets.size() - 1;
  if (scalar) {
    inverse_.resize(static_cast<std::size_t>(system.size));
    for (int k = 0; k < system.size; ++k) {
      const double d = system(k, k);
      if (!(d > 0.0)) return k;
      inverse_[static_cast<std::size_t>(k)] = 1.0 / d;
    }
    return -1;
  }
  block_begin_.resize(num_blocks + 1);
  block_begin_[0] = 0;
  for (std::size_t k = 0; k < num_blocks; ++k) {
    const std::int64_t dim = system.offsets[k + 1] - system.offsets[k];
    block_begin_[k + 1] = block_begin_[k] + dim * dim;
  }
  inverse_.resize(static_cast<std::size_t>(block_begin_.back()));
  for (std::size_t k = 0; k < num_blocks; ++k) {
    const int offset = system.offsets[k];
    const int dim = system.offsets[k + 1] - offset;
    double* factor = inverse_.data() + block_begin_[k];
    for (int c = 0; c < dim; ++c) {
      for (int r = c; r < dim; ++r)
        factor[r + c * dim] = system(offset + r, offset + c);
    }
    const int info = kernels::Kernels().cholesky(dim, factor, dim);
    if (info != 0) return offset + info - 1;
  }
  return -1;
}

void PcgSolver::Precondition(const ReducedSystem& system, const double* r, double* z) const {
  if (options_.preconditioner == Preconditioner::kJacobi) {
    for (int k = 0; k < system.size; ++k)
      z[k] = inverse_[static_cast<std::size_t>(k)] * r[k];
    return;
  }
  std::copy_n(r, system.size, z);
  for (std::size_t k = 0; k + 1 < system.offsets.size(); ++k) {
    const int offset = system.offsets[k];
    const int dim = system.offsets[k + 1] - offset;
    kernels::Kernels().cholesky_solve(dim, inverse_.data() + block_begin_[k], dim, z + offset);
  }
}

LinearSolverResult PcgSolver::Solve(const ReducedSystem& system, double* x) {
  LinearSolverResult result;
  result.exact = false;
  result.failed_pivot = FactorPreconditioner(system);
  if (result.failed_pivot >= 0) return result;
  const kernels::KernelTable& kernel = kernels::Kernels();
  const int n = system.size;
  for (std::vector<double>* v : {&r_, &z_, &p_, &q_})
    v->resize(static_cast<std::size_t>(n));
  std::fill_n(x, n, 0.0);
  std::copy_n(system.b, n, r_.data());
  const double target = options_.tolerance * std::sqrt(kernel.dot(n, system.b, system.b));
  const int cap = options_.max_iterations > 0 ? options_.max_iterations : 2 * n;
  double rho = 0.0;
  result.ok = true;
  while (result.iterations < cap) {
    if (std::sqrt(kernel.dot(n, r_.data(), r_.data())) <= target) break;
    Precondition(system, r_.data(), z_.data());
    const double rho_next = kernel.dot(n, r_.data(), z_.data());
    if (result.iterations == 0) {
      p_ = z_;
    } else {
      const double beta = rho_next / rho;
      for (int k = 0; k < n; ++k) {
        const auto i = static_cast<std::size_t>(k);
        p_[i] = z_[i] + beta * p_[i];
      }
    }
    rho = rho_next;
    system.Multiply(p_.data(), q_.data());
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
