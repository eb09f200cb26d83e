// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include "glissade/covariance/covariance.h"
#include "glissade/gauge/move.h"
#include "glissade/gauge/nullspace.h"
#include "glissade/graph/graph.h"
#include "glissade/marginal/marginalize.h"
#include "glissade/minimizer/memory.h"
#include "glissade/minimizer/options.h"
#include "glissade/minimizer/summary.h"

namespace glissade {

class Workspace;

/// A Graph with everything needed to solve it. Keep it alive between solves: structure, factors
/// and storage are kept, so that a re-solve allocates nothing.
class Problem : public Graph {
 public:
  Problem();
  explicit Problem(Graph graph);
  ~Problem();
  Problem(Problem&&) noexcept;
  Problem& operator=(Problem&&) noexcept;

  /// Minimizes the cost from the present values and leaves the best state found. The summary is
  /// kept by the Problem until the next solve; copy it to keep it longer.
  ///
  /// Fails, with the values as they were, with the status of the first call that was refused since
  /// the last AcknowledgeRefusal(), and with kNothingToSolve where the problem has no edges (no
  /// vertices, or none that anything is known about). Where there are edges but nothing they touch
  /// is free, the present values are the best ones: kConvergedGradient, no iterations, their cost.
  const SolveSummary& Solve(const SolveOptions& options = {});

  /// What a Solve() with these options would take (minimizer/memory.h), and for kAuto which solver
  /// it would choose. Analyzes the graph, which Solve() then need not do; allocates for nothing
  /// else. options.memory_limit is not asked.
  [[nodiscard]] Result<MemoryEstimate> EstimateMemory(const SolveOptions& options = {});

  /// How far H is from having the null space that the measurements have (gauge/nullspace.h): from
  /// the linearization that the last solve or MakeHessian() left where it was of this structure and
  /// free of a gauge, else from a fresh one, for which analysis and storage are kept.
  Result<NullspaceReport> CheckNullspace(const NullspaceOptions& options = {});
  /// Slides the scene along its orbit until the gauge's anchor is at its reference (gauge/move.h).
  Status MoveToGauge(const Gauge& gauge, const MoveOptions& options = {});
  /// The joint covariance of some vertices (covariance/covariance.h; a Covariance object answers
  /// further questions without another factorization).
  [[nodiscard]] Result<JointCovariance> ComputeCovariance(std::span<const AnyVertex> vertices,
                                                          const CovarianceOptions& options = {});

  /// The same of vertices that are not eliminated, from the system that the last step of the last
  /// Solve() was computed from (covariance/last_solve.h): no linearization, no analysis, and also
  /// after the graph has changed.
  [[nodiscard]] Result<JointCovariance> CovarianceOfLastSolve(std::span<const AnyVertex> vertices);

  /// Takes vertices and the edges that touch them out of the graph and puts a marginal prior in
  /// their place; glissade::Marginalize (marginal/marginalize.h) with storage that is kept.
  Result<Marginalization> Marginalize(std::span<const AnyVertex> vertices,
                                      const MarginalizeOptions& options = {});
  Result<Marginalization> Marginalize(std::initializer_list<AnyVertex> vertices,
                                      const MarginalizeOptions& options = {});
  /// That prior alone; the graph is not changed.
  [[nodiscard]] Result<MarginalPrior> ComputeMarginalPrior(
      std::span<const AnyVertex> vertices, const MarginalizeOptions& options = {}) const;

  /// A deep copy of the graph; as Graph::Clone() otherwise.
  [[nodiscard]] Result<Problem> Clone() const;

  // --- The course's step API: for teaching and tests --------------------------------------------
  // Steps in the wrong order are refused, and so are steps after a change of structure, which makes
  // what was computed void.
  /// Linearizes at the present values: H = J'J, b = -J'r over all free variables.
  Status MakeHessian();
  /// Solves (H + lambda D) dx = b by eliminating landmarks; D as in options. kNotFinite where dx is
  /// beyond what a double holds.
  Status SolveLinearSystem(double lambda, const SolveOptions& options = {});
  /// x <- x boxplus dx, remembering x. A step that leads to what is no state (numbers that
  /// overflow) is refused, and names the vertex; the states are as before.
  Status UpdateStates();
  /// Back to x before the last UpdateStates().
  Status RollbackStates();
  /// H of the last MakeHessian() as a dense symmetric matrix; free variables in the order of
  /// FreeVertices(), partly fixed poses with their free coordinates only. Empty before.
  template <int = 0>
  [[nodiscard]] Eigen::MatrixXd Hessian() const {
    Eigen::MatrixXd H(DenseSize(), DenseSize());
    if (H.size() > 0) FillHessian(H.data());
    return H;
  }
  /// b of the last MakeHessian() = minus the gradient; same order.
  template <int = 0>
  [[nodiscard]] Eigen::VectorXd Rhs() const {
    Eigen::VectorXd b(DenseSize());
    if (b.size() > 0) FillRhs(b.data());
    return b;
  }
  /// dx of the last SolveLinearSystem(); same order. Zero where there is none.
  template <int = 0>
  [[nodiscard]] Eigen::VectorXd Step() const {
    Eigen::VectorXd dx(DenseSize());
    if (dx.size() > 0) FillStep(dx.data());
    return dx;
  }
  /// Order of Hessian(): kept vertices first, then eliminated ones, insertion order within types;
  /// of problems with many edges the eliminated ones are sorted by the vertices they are seen from.
  [[nodiscard]] std::vector<AnyVertex> FreeVertices() const;
  /// First row of each of FreeVertices() in Hessian(), and the number of rows at the end.
  [[nodiscard]] std::vector<int> FreeOffsets() const;

 private:
  // Eigen matrices are made here, in the consumer's translation unit, and filled by the library:
  // the two may have been built with different ideas of how Eigen allocates.
  int DenseSize() const;
  void FillHessian(double* H) const;  // DenseSize^2
  void FillRhs(double* b) const;
  void FillStep(double* dx) const;

  std::unique_ptr<Workspace> workspace_;
};

/// The three-variable chain of the course: H before variable 2 is moved last, after the move, and
/// after it is marginalized (Schur complement): variables 1 and 3 are then linked.
struct MarginalizeExample {
  Eigen::Matrix<double, 3, 3, Eigen::DontAlign> before, moved;
  Eigen::Matrix<double, 2, 2, Eigen::DontAlign> after;
};
MarginalizeExample TestMarginalize();

}  // namespace glissade
