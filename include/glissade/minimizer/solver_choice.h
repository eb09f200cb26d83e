// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/minimizer/memory.h"
#include "glissade/minimizer/options.h"
#include "glissade/minimizer/summary.h"

namespace glissade {

struct SolverWorkspace;

/// Whether the options leave the choice to the library.
inline bool ChoosesSolver(const SolveOptions& options) {
  return options.linear_solver == nullptr && options.linear_solver_type == LinearSolverType::kAuto;
}

/// Which solver of the reduced system serves options and memory_limit, and what all will take;
/// after the structure's analysis and NormalEquations::Plan().
///
/// kAuto takes, in this order: dense Cholesky for up to 128 scalars or where most blocks of S are
/// there; sparse Cholesky, as long as a factorization is not expected to take more than three times
/// what linearizing and eliminating does; conjugate gradients on S where its blocks take less than
/// the landmarks' part of H; implicit conjugate gradients. What would exceed memory_limit is passed
/// over.
///
/// Fails with kOutOfMemory where what was asked for, or the least that there is, exceeds the limit.
struct SolverChoice {
  LinearSolverType type = LinearSolverType::kDenseCholesky;
  ReducedSolver description;
  MemoryEstimate memory;
};
Status ChooseSolver(const Graph& graph, SolverWorkspace* workspace, const SolveOptions& options,
                    SolverChoice* choice);

/// What comes before the first linearization: the structure's analysis, what is evaluated together,
/// and the choice, which is left in the workspace. Of a large problem the analysis' own memory is
/// given back.
Status AnalyzeForSolve(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options);

}  // namespace glissade
