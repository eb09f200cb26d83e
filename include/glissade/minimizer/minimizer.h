// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/thread_pool.h"
#include "glissade/graph/graph.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/linear/pcg.h"
#include "glissade/linear/sparse_cholesky.h"
#include "glissade/minimizer/options.h"
#include "glissade/minimizer/solver_choice.h"
#include "glissade/minimizer/summary.h"
#include "glissade/structure/structure.h"

namespace glissade {

/// Who is who in the system that the last step of a solve was solved from: what that step knew of
/// covariances (covariance/last_solve.h) can be asked for after the graph has gone on.
struct SolvedSystem {
  bool is_there = false;                   ///< S is what it was when the step was computed
  std::vector<AnyVertex> vertices;         ///< of Structure::poses()
  std::vector<std::size_t> state_offsets;  ///< of each in states, and their number at the end
  std::vector<double> states;              ///< where S was linearized
  std::vector<FreeTangent> tangents;
  std::vector<GaugeReference> references;
  Gauge gauge;

  /// Before the first step: all storage, and what does not change from step to step.
  void Begin(const Structure& structure, const Graph& graph, const Gauge& in_force);
  /// A step has been computed; allocates nothing.
  void Keep(const Structure& structure, const Graph& graph);
};

/// Everything a solve needs besides the graph. Keep it with its graph: structure and storage are
/// reused, and a re-solve allocates nothing.
struct SolverWorkspace {
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;
  DenseCholeskySolver dense_cholesky;
  SparseCholeskySolver sparse_cholesky;
  PcgSolver pcg;
  PcgSolver implicit_pcg{PcgSolver::Schur::kImplicit};
  SolverChoice choice;  ///< of the last solve
  SolveSummary summary;
  SolvedSystem solved;
  std::vector<double> dogleg_scale, dogleg_gradient, dogleg_step;
  std::vector<double> watched_states;  ///< while a callback runs
  bool discarded = false;

  /// The user's own solver, or that of a type (ChooseSolver()).
  LinearSolver* Solver(const SolveOptions& options, LinearSolverType type);
  /// What of S a solver wants to be stored.
  struct Wish {
    SchurForm form = SchurForm::kDense;
    std::span<const std::int32_t> blocks;  ///< of kSomeBlocks
  };
  Wish AskWhatToStore(LinearSolver* solver);
  /// After an exception: gives back all memory but the summary's, so that nothing half done is
  /// used again. Restore(), which may throw std::bad_alloc, comes before the next use.
  void Discard() noexcept;
  void Restore();
};

/// Lends a solver threads, for its scope: a user's solver may live longer than they do.
class LentThreads {
 public:
  LentThreads(LinearSolver* solver, ThreadPool* threads) : solver_(solver) {
    solver_->UseThreads(threads);
  }
  ~LentThreads() { solver_->UseThreads(nullptr); }
  LentThreads(const LentThreads&) = delete;
  LentThreads& operator=(const LentThreads&) = delete;

 private:
  LinearSolver* solver_;
};

/// Minimizes from the graph's present values, by the method in the options. Leaves the best state
/// found in the graph, also when it fails; the summary is in the workspace. What it refuses, and
/// what it says of a graph in which nothing is free: Problem::Solve (problem/problem.h). Throws
/// what user code throws (edges/concept.h); where memory runs out it fails with kOutOfMemory.
const SolveSummary& Solve(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options);

/// x <- x boxplus step for all free vertices (partly fixed poses in their charts).
void ApplyStep(const Structure& structure, const std::vector<double>& step, Graph* graph);

/// The damping term that the options and lambda mean.
DampingTerm MakeDamping(const SolveOptions& options, double lambda);
/// How well the options want the reduced system to be solved; progress: the last relative decrease
/// of the cost, by which inexact steps become more exact.
SolveRequest MakeRequest(const SolveOptions& options, double forcing, double progress);

}  // namespace glissade
