// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/structure/block_index.h"

namespace glissade {

/// The reduced system S x = b over the vertices that are not eliminated: symmetric, one block row
/// per free vertex, damping already in S. A view: valid during LinearSolver::Solve only.
///
/// Coordinates of partly fixed vertices that are not free are present as unit rows (S_kk = 1,
/// b_k = 0), so that a block always has its vertex's full tangent dimension.
struct ReducedSystem {
  int size = 0;                           ///< number of scalar unknowns n
  std::span<const std::int32_t> offsets;  ///< first scalar of each block; offsets.back() == n
  const double* S = nullptr;              ///< lower triangle, column-major
  int stride = 0;                         ///< S(i, j) = S[i + j * stride], i >= j
  const double* b = nullptr;              ///< n numbers
  /// Blocks of the lower triangle that can be non-zero, row >= col; all others are zero. Empty: all
  /// can be.
  std::span<const BlockIndex> pattern;
  std::uint64_t pattern_version = 0;  ///< a new number where sizes or pattern are new

  [[nodiscard]] double operator()(int i, int j) const {
    return i >= j ? S[i + static_cast<std::ptrdiff_t>(j) * stride]
                  : S[j + static_cast<std::ptrdiff_t>(i) * stride];
  }
  /// y = S x.
  void Multiply(const double* x, double* y) const;
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
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Writes x (size numbers). May keep workspaces between calls; the structure rarely changes.
  virtual LinearSolverResult Solve(const ReducedSystem& system, double* x) = 0;
};

/// Dense Cholesky S = L L'.
class DenseCholeskySolver final : public LinearSolver {
 public:
  LinearSolverResult Solve(const ReducedSystem& system, double* x) override;

 private:
  std::vector<double> factor_;
};

enum class Preconditioner {
  kJacobi,       ///< scalar diagonal
  kBlockJacobi,  ///< inverse diagonal blocks, one per vertex
};

struct PcgOptions {
  Preconditioner preconditioner = Preconditioner::kBlockJacobi;
  double tolerance = 1e-10;  ///< stop at |r| <= tolerance |b|
  int max_iterations = 0;    ///< 0: 2 n
};

/// Preconditioned conjugate gradients on the explicit S.
class PcgSolver final : public LinearSolver {
 public:
  explicit PcgSolver(PcgOptions options = {}) : options_(options) {}
  void set_options(const PcgOptions& options) { options_ = options; }
  LinearSolverResult Solve(const ReducedSystem& system, double* x) override;

 private:
  /// The pivot that is not positive, or -1.
  int FactorPreconditioner(const ReducedSystem& system);
  void Precondition(const ReducedSystem& system, const double* r, double* z) const;

  PcgOptions options_;
  std::vector<double> inverse_;  // diagonal, or Cholesky factors of the diagonal blocks
  std::vector<std::int64_t> block_begin_;
  std::vector<double> r_, z_, p_, q_;
};

}  // namespace glissade
