// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glissade/linear/linear_solver.h"
#include "glissade/linear/preconditioner.h"

namespace glissade {

class SchurPreconditioner;

/// Preconditioned conjugate gradients (Hestenes and Stiefel 1952) on the reduced system: explicit,
/// on the stored blocks of S; or implicit, without any but those of the preconditioner, S being
/// applied through H_pp, W and H_ll^-1 (S. Agarwal et al., "Bundle Adjustment in the Large", ECCV
/// 2010, Sec. 4).
class PcgSolver final : public LinearSolver {
 public:
  enum class Schur : std::uint8_t { kExplicit, kImplicit };

  explicit PcgSolver(Schur schur = Schur::kExplicit,
                     Preconditioner preconditioner = Preconditioner::kBlockJacobi);
  ~PcgSolver() override;
  PcgSolver(PcgSolver&&) noexcept;
  PcgSolver& operator=(PcgSolver&&) noexcept;

  void set_preconditioner(Preconditioner preconditioner) { wanted_ = preconditioner; }
  /// What the last Prepare() made: kBlockJacobi instead of kPowerSeries where H_pp is not block
  /// diagonal, for which the series need not converge.
  [[nodiscard]] Preconditioner preconditioner() const;

  void UseThreads(ThreadPool* threads) override;
  [[nodiscard]] SchurForm Form(const SchurLayout& all_blocks) override;
  [[nodiscard]] std::span<const std::int32_t> WantedBlocks() const override;
  LinearSolverResult Prepare(const SchurOperator& S) override;
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override;

 private:
  Schur schur_;
  Preconditioner wanted_;
  std::unique_ptr<SchurPreconditioner> preconditioner_;
  std::vector<double> r_, z_, p_, q_;
};

}  // namespace glissade
