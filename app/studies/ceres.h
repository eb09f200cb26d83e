// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/base/status.h"
#include "glissade/graph/graph.h"
#include "glissade/minimizer/options.h"

namespace glissade::app {

/// What Ceres made of the same graph.
struct CeresResult {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  double time_s = 0.0;
  std::string status;  ///< one line
  std::string linear_solver;
};

/// True where this program was built with Ceres.
bool HaveCeres();

/// Solves the graph with Ceres under the same limit of iterations, number of threads and stopping
/// rule on the cost: DENSE_SCHUR in place of dense Cholesky, SPARSE_SCHUR in place of the sparse
/// one, ITERATIVE_SCHUR with Schur-Jacobi in place of PCG; where the choice is left to the library,
/// dense up to 100 cameras and sparse beyond, as its manual advises. Refused without Ceres, or
/// where Ceres finds no usable solution.
Result<CeresResult> SolveWithCeres(Graph* graph, const SolveOptions& options);

}  // namespace glissade::app
