// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/linear/preconditioner.h"
#include "glissade/linear/schur_operator.h"

namespace glissade {

/// How well one right-hand side is to be solved for. Exact solvers need none of it.
struct SolveRequest {
  double tolerance = 1e-10;       ///< of an iterative solver: stop at |b - S x| <= tolerance |b|
  int max_iterations = 0;         ///< of an iterative solver; 0: it decides
  const double* guess = nullptr;  ///< n numbers to start from; null: zero. Must not be x.
  /// Asked now and then by solvers that take long; true: give up and return what there is.
  bool (*stop)(void*) = nullptr;
  void* stop_data = nullptr;

  [[nodiscard]] bool Stop() const { return stop != nullptr && stop(stop_data); }
};

struct LinearSolverResult {
  bool ok = false;     ///< false: no solution (not positive definite, break-down)
  int iterations = 0;  ///< of an iterative solver
  /// True where S x = b holds to rounding; otherwise the minimizer accounts for the residual in
  /// the gain ratio.
  bool exact = true;
  /// Scalar index of the pivot that failed; -1 if unknown.
  int failed_pivot = -1;
};

/// Solves the reduced system. Implement it to bring your own solver: SolveOptions::linear_solver.
/// The calls come in this order: Form(), Prepare(), Solve() for each right-hand side. May keep
/// workspaces between calls; the layout rarely changes.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// What Prepare() and Solve() need to find stored, given all blocks that can be non-zero. Asked
  /// before every elimination: what takes time should be kept by all_blocks.version.
  [[nodiscard]] virtual SchurForm Form(const SchurLayout& all_blocks) = 0;
  /// Factors S or makes a preconditioner of it.
  virtual LinearSolverResult Prepare(const SchurOperator& S) = 0;
  /// S x = b, after Prepare() with the same S. Writes x; b and x must not overlap.
  virtual LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                                   const SolveRequest& request) = 0;
};

/// Dense Cholesky S = L L'.
class DenseCholeskySolver final : public LinearSolver {
 public:
  [[nodiscard]] SchurForm Form(const SchurLayout&) override { return SchurForm::kDense; }
  LinearSolverResult Prepare(const SchurOperator& S) override;
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override;

 private:
  std::vector<double> factor_;
  int stride_ = 0;
};

/// Preconditioned conjugate gradients: on the stored blocks of S, or (kDiagonalBlocks) without any
/// but those of the preconditioner, S being applied through H_pp, W and H_ll^-1.
class PcgSolver final : public LinearSolver {
 public:
  explicit PcgSolver(SchurForm form = SchurForm::kBlocks,
                     Preconditioner preconditioner = Preconditioner::kBlockJacobi)
      : form_(form), preconditioner_(preconditioner) {}
  void set_preconditioner(Preconditioner preconditioner) { preconditioner_ = preconditioner; }

  [[nodiscard]] SchurForm Form(const SchurLayout&) override { return form_; }
  LinearSolverResult Prepare(const SchurOperator& S) override;
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override;

 private:
  /// The pivot that is not positive, or -1.
  int FactorDiagonalBlock(std::int64_t offset, int dim, BlockView block);
  void Precondition(const SchurLayout& layout, const double* r, double* z) const;

  SchurForm form_;
  Preconditioner preconditioner_;
  std::vector<double> inverse_;  // diagonal, or Cholesky factors of the diagonal blocks
  std::vector<std::int64_t> factor_begin_;
  std::vector<double> r_, z_, p_, q_;
};

}  // namespace glissade
