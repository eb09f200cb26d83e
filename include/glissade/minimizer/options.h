// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/linear/preconditioner.h"
#include "glissade/minimizer/summary.h"

namespace glissade {

class LinearSolver;

/// How a step is found.
enum class Method {
  kLevenbergMarquardt,
  kDogleg,  ///< Powell's dogleg in the scaled space of diag(H) (Nocedal and Wright, Sec. 4.1)
};

/// What lambda multiplies in (H + lambda D) dx = b.
enum class Damping {
  kDiagonal,   ///< D = diag(H), clamped; all variables, landmarks included (Marquardt)
  kIdentity,   ///< D = I; all variables (Levenberg)
  kPoseBlock,  ///< lambda I added to the reduced system after elimination, landmarks undamped: the
               ///< variant of the course this library grew from; for comparison only
};

/// How the reduced system is solved.
enum class LinearSolverType {
  /// What has least to do (minimizer/solver_choice.h): dense or sparse Cholesky, or where
  /// factorizing would take much longer than all else, or more than memory_limit, conjugate
  /// gradients, with PcgOptions::forcing if that is 0 set to 0.1.
  kAuto,
  kDenseCholesky,
  kSparseCholesky,
  kPcg,          ///< conjugate gradients on the blocks of the reduced system
  kImplicitPcg,  ///< conjugate gradients without forming it: memory goes with the observations
};

/// Of kPcg and kImplicitPcg. tolerance and max_iterations are also what a solver of your own is
/// asked for (SolveRequest).
struct PcgOptions {
  Preconditioner preconditioner = Preconditioner::kBlockJacobi;
  double tolerance = 1e-10;  ///< stop at |r| <= tolerance |b|
  /// Inexact Newton steps: stop too where an iteration brings less than this part of what the model
  /// has decreased so far (SolveRequest::model_tolerance). The part becomes smaller as the solve
  /// converges: with the square root of the last relative decrease of the cost, down to a third.
  /// 0: tolerance alone.
  double forcing = 0.0;
  int max_iterations = 0;  ///< 0: 2 n
};

/// Returned by an iteration callback.
enum class CallbackAction { kContinue, kStop };

struct SolveOptions {
  // --- When to stop. A tolerance of 0 switches its rule off. ---------------------------------
  int max_iterations = 50;  ///< linear solves, rejected steps included
  double max_time_s = std::numeric_limits<double>::infinity();  ///< checked inside an iteration
  double cost_tolerance = 1e-9;  ///< |cost decrease| <= tolerance * cost
  /// max |g_i| / sqrt(H_ii) <= tolerance * the same at the start. 0: nobody asks, and the last step
  /// of max_iterations is not linearized (without a callback).
  double gradient_tolerance = 1e-12;
  /// sqrt(dx'(H + 2 lambda D)dx) <= tolerance * sqrt(2 cost), before the step is applied: the
  /// change of all residuals that it would make is that part of the residuals. Without damping this
  /// is the relative offset of Bates and Watts (Technometrics 1981), and no variable is further
  /// from where the model has its minimum than tolerance * sqrt(2 cost) of its own standard
  /// deviation sqrt((H^-1)_ii). Neither the world's origin, nor units, nor one wild variable
  /// matter. The left side squared is twice the decrease that the model promises. A step is none
  /// either where that is less than the rounding of the states' own numbers makes of cost.
  double step_tolerance = 1e-10;
  /// The course's absolute rules instead of the above: stop before an update with
  /// |dx|^2 <= 1e-6, or at sqrt(chi) <= 1e-6 chi_0. For comparison only.
  bool course_stop = false;

  Method method = Method::kLevenbergMarquardt;
  /// A step is accepted where the cost falls by more than this part of the predicted decrease.
  /// Ceres takes 1e-3.
  double min_relative_decrease = 0.0;

  // --- Levenberg-Marquardt (Nielsen's update; Madsen, Nielsen, Tingleff 2004, Alg. 3.16) -------
  Damping damping = Damping::kDiagonal;
  /// lambda_0; for kIdentity and kPoseBlock it is multiplied by max diag(H).
  double initial_lambda = 1e-4;
  double min_lambda = 1e-15;
  double max_lambda = 1e32;
  double min_diagonal = 1e-6;  ///< clamp of diag(H) in kDiagonal
  double max_diagonal = 1e32;

  // --- Dogleg -----------------------------------------------------------------------------------
  double initial_radius = 1e4;  ///< of the trust region, in the scaled space

  // --- Linear algebra -------------------------------------------------------------------------
  LinearSolverType linear_solver_type = LinearSolverType::kAuto;
  PcgOptions pcg = {};
  /// Your own solver of the reduced system (linear/linear_solver.h), used instead of
  /// linear_solver_type where not null. Not owned; must outlive the solve.
  LinearSolver* linear_solver = nullptr;
  /// Bytes that graph and solve may take together; 0: no limit. A solve that would need more fails
  /// with kOutOfMemory, before it takes them and with the states as they are; kAuto first looks for
  /// a solver that needs less. What will be needed: Problem::EstimateMemory().
  std::int64_t memory_limit = 0;
  /// Does not change a bit of the result. Where the system refuses threads, the solve goes on with
  /// those there are: SolveSummary::num_threads.
  int num_threads = 1;

  /// What holds the directions that nothing observes; the graph's own fixing is as before
  /// afterwards. Gauge::Free: only what is fixed and what priors say.
  Gauge gauge = {};

  // --- What else ------------------------------------------------------------------------------
  /// Solve refuses a graph that holds one observation twice (kDuplicate) unless this is set.
  bool allow_duplicate_observations = false;
  bool verbose = false;  ///< print a table line per iteration to stderr
  /// Called after the start (iteration 0) and after every iteration, on the thread that called
  /// Solve. The graph then holds the states with the cost it is told: those of the best point so
  /// far; after a rejected step the ones before it. It may read the graph (values, costs,
  /// snapshots), stop the solve, solve other problems, and throw (edges/concept.h says what then
  /// happens). It must not change, move or solve this graph: Solve then ends with kInvalidArgument
  /// and leaves what it finds. It must not destroy it.
  std::function<CallbackAction(const IterationSummary&)> callback = {};

  /// Refuses values that make no sense, naming the option.
  [[nodiscard]] Status Validate() const;
};

}  // namespace glissade
