// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/minimizer/options.h"

namespace glissade {

class Graph;
class NormalEquations;
class SparseCholeskySolver;
class Structure;

/// What a graph and its solve take, in bytes. Of the large parts, which grow with vertices, edges,
/// and blocks of S; a few megabytes may come on top. What is there only while the graph is analyzed
/// is less than what comes after it and not counted.
struct MemoryEstimate {
  std::int64_t graph = 0;      ///< vertices and edges, a second copy of the states
  std::int64_t structure = 0;  ///< which edge adds where, and in which order
  std::int64_t equations = 0;  ///< H and b: mostly W, 8 bytes a number
  std::int64_t reduced = 0;    ///< S as its solver wants it stored
  std::int64_t solver = 0;     ///< factor, fronts or vectors
  /// What was assumed, and what kAuto would take.
  LinearSolverType linear_solver = LinearSolverType::kAuto;

  [[nodiscard]] std::int64_t total() const {
    return graph + structure + equations + reduced + solver;
  }
};

/// For a solver whose symbolic analysis has been made (sparse, where it is kSparseCholesky).
MemoryEstimate EstimateMemory(const Graph& graph, const Structure& structure,
                              NormalEquations* equations, const SparseCholeskySolver& sparse,
                              LinearSolverType type, int num_threads);

}  // namespace glissade
