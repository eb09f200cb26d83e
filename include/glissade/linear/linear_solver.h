// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/linear/schur_operator.h"

namespace glissade {

class ThreadPool;

/// How well one right-hand side is to be solved for. Exact solvers need none of it.
struct SolveRequest {
  double tolerance = 1e-10;  ///< of an iterative solver: stop at |b - S x| <= tolerance |b|
  /// Of an iterative solver: stop too where the i-th iteration has brought less than this, divided
  /// by i, of the decrease of x'S x / 2 - b'x so far (Nash and Sofer, Operations Research Letters
  /// 1990). 0: never.
  double model_tolerance = 0.0;
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
/// The calls come in this order: UseThreads(), Form(), Prepare(), Solve() for each right-hand side.
/// May keep workspaces between calls; the layout rarely changes.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// The threads that may be used until the next call, at the latest the end of the solve; null:
  /// none. What is computed must not depend on how many there are.
  virtual void UseThreads(ThreadPool* threads) { static_cast<void>(threads); }
  /// What Prepare() and Solve() need to find stored, given all blocks that can be non-zero. Asked
  /// before every elimination: what takes time should be kept by all_blocks.version.
  [[nodiscard]] virtual SchurForm Form(const SchurLayout& all_blocks) = 0;
  /// Of kSomeBlocks: which of all_blocks.blocks, all diagonal ones among them, ascending. Asked
  /// after Form(), valid until its next call.
  [[nodiscard]] virtual std::span<const std::int32_t> WantedBlocks() const { return {}; }
  /// Factors S or makes a preconditioner of it.
  virtual LinearSolverResult Prepare(const SchurOperator& S) = 0;
  /// S x = b, after Prepare() with the same S. Writes x; b and x must not overlap.
  virtual LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                                   const SolveRequest& request) = 0;
};

/// Dense Cholesky S = L L'.
class DenseCholeskySolver final : public LinearSolver {
 public:
  void UseThreads(ThreadPool* threads) override { threads_ = threads; }
  [[nodiscard]] SchurForm Form(const SchurLayout&) override { return SchurForm::kDense; }
  LinearSolverResult Prepare(const SchurOperator& S) override;
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override;

 private:
  ThreadPool* threads_ = nullptr;
  std::vector<double> factor_, scratch_;
  int stride_ = 0;
};

}  // namespace glissade
