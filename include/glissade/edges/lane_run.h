// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade {

/// Edges of one pool on the same vertices but for one, the landmark. A lane is an edge.
struct LaneRun {
  int count = 0;                        ///< edges
  int lanes = 0;                        ///< from one array of values to the next; a multiple of 8
  const std::int32_t* edges = nullptr;  ///< `lanes` dense indices; padding repeats the last edge
  int landmark = 0;                     ///< which of the vertices differs
  const double* const* states =
      nullptr;  ///< of each vertex; what stands for the landmark is unused
  const double* const* points = nullptr;  ///< x_lin of these, null where there is none
  /// Of each edge: of the padding lanes there are none.
  const double* const* landmark_states = nullptr;
  const double* const* landmark_points = nullptr;
  /// Scratch: residual and Jacobians of one edge, or the Jacobian of a pose in lanes.
  double* work = nullptr;
};

/// Raw values of a run: row k, column c of a matrix of `cols` columns is the array of `lanes`
/// numbers at (k * cols + c) * lanes.
struct LaneValues {
  double* r = nullptr;
  double* const* J = nullptr;          ///< per vertex; null: not wanted
  std::int64_t* one_by_one = nullptr;  ///< counts packs whose lanes disagreed about a condition
};

/// Evaluates a run in packs; `edges` is the pool's array of edges. Returns the first lane without a
/// value, or -1. What is not finite is for the caller to find.
using EvaluateLanes = int (*)(const void* edges, const LaneRun& run, const LaneValues& values);

}  // namespace glissade
