// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/base/thread_pool.h"
#include "glissade/linear/edge_evaluation.h"
#include "glissade/linear/hessian.h"
#include "glissade/linear/linear_solver.h"
#include "glissade/linear/linearized_states.h"
#include "glissade/structure/structure.h"

namespace glissade {

/// What is added to the normal equations before solving.
struct DampingTerm {
  double lambda = 0.0;
  bool identity = false;      ///< D = I instead of the clamped diagonal of H
  bool reduced_only = false;  ///< lambda I on the reduced system only, landmarks undamped
  double min_diagonal = 1e-6;
  double max_diagonal = 1e32;
};

class LandmarkRuns;
class SchurStorage;
class TwistTerms;

/// Why a step or a trial cost does not exist: a Status without its message, because a step that is
/// rejected must not allocate. Converts to the Status when somebody is to be told.
struct [[nodiscard]] StepFailure {
  StatusCode code = StatusCode::kOk;
  const char* what = "";  ///< static text
  AnyVertex vertex;       ///< the culprit, where there is one
  AnyEdge edge;
  /// A landmark could not be eliminated: damping of the reduced system alone does not help.
  bool is_landmark = false;

  [[nodiscard]] bool ok() const { return code == StatusCode::kOk; }
  operator Status() const;  // NOLINT: implicit, it is one
};

/// The Gauss-Newton equations H dx = b of a graph by blocks, with landmarks apart:
///
///     [ H_pp  W    ] [dx_p]   [b_p]
///     [ W'    H_ll ] [dx_l] = [b_l]
///
/// H_pp block sparse, H_ll block diagonal, W by landmark. Linearize once; then eliminate and solve
/// for as many lambdas as are needed. All storage is kept between calls.
class NormalEquations {
 public:
  NormalEquations();
  ~NormalEquations();
  NormalEquations(NormalEquations&&) noexcept;
  NormalEquations& operator=(NormalEquations&&) noexcept;

  /// Sorts the edges into what they are evaluated in; Linearize() does it where it has not been
  /// done.
  void Plan(const Structure& structure, const Graph& graph);
  /// Whether that has been done since the analysis.
  [[nodiscard]] bool IsPlanned(const Structure& structure) const;
  /// Edge pools, after Plan(), of which no edge's record in the structure will be read any more.
  [[nodiscard]] std::vector<bool> PoolsInRuns(const Structure& structure) const;
  /// Memory that H and b will take, and S in a form (of kSomeBlocks: as kDiagonalBlocks), after
  /// Plan().
  [[nodiscard]] std::int64_t MemoryBytes(const Structure& structure) const;
  [[nodiscard]] std::int64_t ReducedMemoryBytes(const Structure& structure, SchurForm form,
                                                int num_threads);
  /// H, b and the cost at the graph's present values. On failure names the edge that has no value.
  Status Linearize(const Structure& structure, Graph* graph, ThreadPool* threads, double* cost);
  /// The cost alone, after Linearize. NaN-free: an edge without a value is a failure.
  StepFailure Cost(const Structure& structure, const Graph& graph, ThreadPool* threads,
                   double* cost);

  /// How the edges of the last linearization are evaluated, one entry for each type that has any.
  /// Redone packs are counted since ForgetRedonePacks().
  void ListEvaluations(const Structure& structure, const Graph& graph,
                       std::vector<EdgeEvaluation>* out) const;
  void ForgetRedonePacks();

  /// All blocks of the reduced system that can be non-zero: what LinearSolver::Form() is asked
  /// with.
  [[nodiscard]] const SchurLayout& ReducedLayout(const Structure& structure);
  /// Eliminates the landmarks: the reduced system S dx_p = b_s with the damping in it, in the form
  /// that its solver asks for; wanted: of kSomeBlocks (LinearSolver::WantedBlocks()). Fails on a
  /// landmark block that is not positive definite, and names it. structure and threads must stay
  /// until the last product with S.
  StepFailure Eliminate(const Structure& structure, const Graph& graph, const DampingTerm& damping,
                        SchurForm form, ThreadPool* threads,
                        std::span<const std::int32_t> wanted = {});
  /// S, after Eliminate().
  [[nodiscard]] const SchurOperator& reduced();
  [[nodiscard]] const std::vector<double>& reduced_rhs() const;
  [[nodiscard]] SchurForm reduced_form() const;
  /// What Eliminate() found on the diagonal of H (pose scalars; of those that are held it means
  /// nothing), and the damping that it made S with: later linearizations leave these, and S, alone.
  [[nodiscard]] const std::vector<double>& eliminated_diagonal() const {
    return eliminated_diagonal_;
  }
  [[nodiscard]] const DampingTerm& damping() const { return damping_; }
  /// What that added to the diagonal of S at a pose scalar that is not held.
  [[nodiscard]] double DampingAt(std::size_t scalar) const;
  /// Solves the reduced system and substitutes back; Step() then holds dx.
  StepFailure Solve(const Structure& structure, const Graph& graph, LinearSolver* solver,
                    const SolveRequest& request, ThreadPool* threads, LinearSolverResult* result);

  /// dx of all free variables: pose blocks, then landmarks.
  [[nodiscard]] const std::vector<double>& step() const { return step_; }
  /// b = -gradient, same order. Zero in coordinates that are held.
  [[nodiscard]] double MaxGradient() const;
  [[nodiscard]] double StepNorm() const;
  [[nodiscard]] double MaxDiagonal() const;
  /// b'dx and dx'D dx, of which the gain ratio is made.
  [[nodiscard]] double GradientDotStep() const;
  [[nodiscard]] double StepDampingStep(const Structure& structure,
                                       const DampingTerm& damping) const;
  /// Decrease of the model 1/2 r'r when going by dx, exact also where the reduced system was
  /// solved only approximately: b'dx - 1/2 dx'H dx.
  [[nodiscard]] double ModelDecrease(const Structure& structure, const DampingTerm& damping,
                                     const LinearSolverResult& result);

  /// d'H d for any direction d in the order of step().
  [[nodiscard]] double QuadraticForm(const Structure& structure, const Graph& graph,
                                     const std::vector<double>& d);
  /// Decrease of the model 1/2 r'r when going by d: b'd - 1/2 d'H d.
  [[nodiscard]] double ModelDecrease(const Structure& structure, const Graph& graph,
                                     const std::vector<double>& d);
  /// diag(H), in the order of step(); 0 where a coordinate is held.
  [[nodiscard]] const std::vector<double>& diagonal() const { return diagonal_; }

  /// Whether H and b are those of a linearization with this structure.
  [[nodiscard]] bool IsLinearized(const Structure& structure) const {
    return linearized_ != 0 && linearized_ == structure.analysis();
  }
  /// Where the last Linearize() was.
  [[nodiscard]] const LinearizedStates& point() const { return point_; }
  /// H by its parts, for who wants to look at it: puts together what the solvers take piece by
  /// piece. Landmarks in groups (Structure::groups()) are not among them.
  [[nodiscard]] Hessian GetHessian(const Structure& structure);
  /// b = -gradient of all free variables, in the order of step().
  [[nodiscard]] const std::vector<double>& b() const { return b_; }
  /// 1 for pose scalars that partial fixing holds (unit rows in H_pp).
  [[nodiscard]] const std::vector<std::uint8_t>& held() const { return held_; }

 private:
  void Resize(const Structure& structure);
  void LinearizeChunk(const Structure& structure, const Graph& graph, int chunk);
  void SumChunks(int num_chunks, ThreadPool* threads);
  void ProjectFreeTangents(const Structure& structure, Graph* graph);
  void FindConstants(const Structure& structure, const Graph& graph);
  void FillDiagonal(const Structure& structure);
  void FillLandmarks(const Structure& structure, int chunk);
  static StepFailure CannotEliminate(const AnyVertex& landmark);
  void StartColumns(const Structure& structure, const DampingTerm& damping, std::int32_t begin,
                    std::int32_t end);
  struct Panel {
    std::vector<double> z, beta;
    int failed_landmark = -1;
  };
  void PlaceFactors(const Structure& structure);
  void FillPanel(const Structure& structure, const DampingTerm& damping, std::size_t batch,
                 Panel* panel);
  int ReduceLandmarks(const Structure& structure, const DampingTerm& damping, ThreadPool* threads);
  void MultiplyReduced(const double* x, double* y);
  bool PoseDiagonal(std::int32_t vertex, double* block);
  void MultiplyPoses(const Hessian& H, int chunk, int num_chunks, const double* x, double* y) const;

  StepFailure CheckCosts(const Structure& structure, const Graph& graph, double* cost) const;

  struct Chunk {
    double cost = 0.0;
    int failed_pool = -1;
    int failed_edge = -1;
    int failed_lane = -1;
    std::vector<double> product;  // part of S x
  };

  int num_poses_scalars_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<std::vector<double>> h_pp_;  // varying blocks per chunk; [0] holds the sum
  std::vector<double> h_whole_;            // with the constant blocks
  bool is_whole_ = false;
  std::vector<BlockView> constants_;  // by Structure::constant_blocks(), projected
  std::vector<double> projected_;
  std::vector<std::vector<double>> b_p_;
  std::vector<double> landmarks_;    // records, see edge_plan.h
  std::vector<double> h_ll_factor_;  // C of the damped H_ll^-1 = C'C, dim x dim per landmark
  std::vector<std::int64_t> factor_begin_;
  std::uint64_t factors_of_ = 0;  // the analysis that these belong to
  std::vector<Panel> panels_;     // batches of landmarks that are eliminated at the same time
  std::vector<std::int32_t> batch_cuts_;  // columns of S, of the threads that take them
  std::vector<double> diagonal_;          // diag(H), pose scalars then landmark scalars
  std::vector<double> b_;                 // the same order
  std::vector<double> step_;
  std::vector<double> residual_;
  std::vector<std::uint8_t> held_;
  LinearizedStates point_;
  std::unique_ptr<LandmarkRuns> runs_;
  std::unique_ptr<TwistTerms> twists_;
  std::unique_ptr<SchurStorage> schur_;
  // What products with an S that is not stored need.
  const Structure* eliminated_ = nullptr;
  ThreadPool* threads_ = nullptr;
  DampingTerm damping_;
  std::vector<double> eliminated_diagonal_;
  std::uint64_t linearized_ = 0;  // the analysis that H and b belong to
};

}  // namespace glissade
