// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/pcg.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "kernels/kernels.h"
#include "linear/schur_preconditioner.h"

namespace glissade {

PcgSolver::PcgSolver(Schur schur, Preconditioner preconditioner)
    : schur_(schur),
      wanted_(preconditioner),
      preconditioner_(std::make_unique<SchurPreconditioner>()) {}
PcgSolver::~PcgSolver() = default;
PcgSolver::PcgSolver(PcgSolver&&) noexcept = default;
PcgSolver& PcgSolver::operator=(PcgSolver&&) noexcept = default;

Preconditioner PcgSolver::preconditioner() const {
  return preconditioner_->kind();
}

void PcgSolver::UseThreads(ThreadPool* threads) {
  preconditioner_->UseThreads(threads);
}

SchurForm PcgSolver::Form(const SchurLayout& all_blocks) {
  preconditioner_->Plan(all_blocks, wanted_);
  if (schur_ == Schur::kExplicit) return SchurForm::kBlocks;
  return wanted_ == Preconditioner::kClusterJacobi ? SchurForm::kSomeBlocks
                                                   : SchurForm::kDiagonalBlocks;
}

std::span<const std::int32_t> PcgSolver::WantedBlocks() const {
  return preconditioner_->wanted();
}

LinearSolverResult PcgSolver::Prepare(const SchurOperator& S) {
  LinearSolverResult result;
  result.failed_pivot = preconditioner_->Prepare(S);
  result.ok = result.failed_pivot < 0;
  return result;
}

LinearSolverResult PcgSolver::Solve(const SchurOperator& S, const double* b, double* x,
                                    const SolveRequest& request) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const int n = static_cast<int>(S.layout().size());
  for (std::vector<double>* v : {&r_, &z_, &p_, &q_})
    v->resize(internal::Index(n));
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
  // With r = b - S x the model x'S x / 2 - b'x is -x'(b + r) / 2.
  const auto decrease = [&] { return 0.5 * (kernel.dot(n, x, b) + kernel.dot(n, x, r_.data())); };
  double rho = 0.0, decrease_before = request.model_tolerance > 0.0 ? decrease() : 0.0;
  LinearSolverResult result;
  result.exact = false;
  result.ok = true;
  while (result.iterations < cap && !request.Stop()) {
    if (std::sqrt(kernel.dot(n, r_.data(), r_.data())) <= target) break;
    preconditioner_->Apply(S, r_.data(), z_.data());
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
    if (request.model_tolerance > 0.0) {
      const double now = decrease();
      if (result.iterations * (now - decrease_before) <= request.model_tolerance * now) break;
      decrease_before = now;
    }
  }
  return result;
}

}  // namespace glissade
