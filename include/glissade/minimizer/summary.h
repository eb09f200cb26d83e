// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/linear/edge_evaluation.h"

namespace glissade {

/// Why a solve ended.
enum class Termination {
  kConvergedCost,      ///< relative cost decrease under tolerance
  kConvergedGradient,  ///< gradient under tolerance
  kConvergedStep,      ///< step under tolerance
  /// Step, or the decrease it promises, under tolerance after nothing but rejected ones, where
  /// first estimates are kept: their gradient is not that of the cost, and there is no way further
  /// down along it.
  kConvergedFirstEstimates,
  kMaxIterations,
  kMaxTime,
  kCancelled,   ///< the callback said so
  kNoProgress,  ///< lambda at its limit: no step decreases the cost
  kFailed,      ///< see SolveSummary::status
};

std::string_view ToString(Termination termination);

/// One line of the iteration table: iteration 0 is the start, later ones are linear solves.
struct IterationSummary {
  int iteration = 0;
  bool accepted = true;
  double cost = 0.0;         ///< after this iteration, 1/2 sum rho [-]
  double cost_change = 0.0;  ///< decrease that was tried; negative where rejected
  /// max |g_i| at the present linearization; 0 where the solve has failed because it is not finite.
  /// Of a last step that was not linearized (SolveOptions::gradient_tolerance 0) that before it.
  double gradient_max = 0.0;
  double step_norm =
      0.0;  ///< |dx| over all variables, of mixed units: only the course's rule looks at it
  double gain_ratio = 0.0;    ///< actual over predicted decrease
  double lambda = 0.0;        ///< damping to be used next
  int linear_iterations = 0;  ///< of PCG
  double time_s = 0.0;        ///< of this iteration
  double total_time_s = 0.0;  ///< since the start of the solve
};

/// Seconds, summed over the solve.
struct TimeSplit {
  double analyze_s = 0.0;    ///< structure, only when the graph changed
  double linearize_s = 0.0;  ///< residuals, Jacobians, H and b
  double eliminate_s = 0.0;  ///< landmarks: Schur complement and back-substitution
  double solve_s = 0.0;      ///< reduced system
  double cost_s = 0.0;       ///< updates and trial costs
  double total_s = 0.0;
};

/// How the reduced system of a solve was solved.
struct ReducedSolver {
  const char* name = "";          ///< "dense", "sparse", "pcg", "implicit-pcg" or "user's"
  const char* reason = "";        ///< why that one
  std::int64_t scalars = 0;       ///< n of the n x n system S
  double density = 0.0;           ///< part of its blocks that can be other than zero
  double factor_flops = 0.0;      ///< multiplications of a sparse factorization, where looked at
  std::int64_t memory_bytes = 0;  ///< that graph and solve take (minimizer/memory.h)
};

struct SolveSummary {
  Termination termination = Termination::kFailed;
  /// ok unless termination is kFailed; then what and who (vertex(), edge()).
  Status status;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int accepted_steps = 0;
  int rejected_steps = 0;
  int num_poses = 0;      ///< free vertices in the reduced system
  int num_landmarks = 0;  ///< free eliminated vertices
  int num_edges = 0;
  ReducedSolver reduced;
  int num_threads = 1;          ///< that worked
  int num_threads_refused = 0;  ///< that the system did not give (SolveOptions::num_threads)
  std::vector<IterationSummary> iterations;
  std::vector<EdgeEvaluation> edges;  ///< how each type was evaluated; empty where none was
  TimeSplit time;

  [[nodiscard]] bool ok() const { return termination != Termination::kFailed; }
  [[nodiscard]] bool converged() const {
    return termination == Termination::kConvergedCost ||
           termination == Termination::kConvergedGradient ||
           termination == Termination::kConvergedStep ||
           termination == Termination::kConvergedFirstEstimates;
  }
  /// "converged (cost), 7 iterations, cost 2.67550 -> 4.92854e-05, 0.4 ms"; with the number of
  /// threads where some were refused.
  [[nodiscard]] std::string BriefReport() const;
};

/// The table that verbose mode prints: a header and one line per iteration.
std::string IterationTableHeader();
std::string ToString(const IterationSummary& iteration);

}  // namespace glissade
