// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/graph/fix.h"

namespace glissade {

/// The values of all vertices of a graph at one moment. Plain numbers: copy it, keep it, compare
/// it.
struct Snapshot {
  std::vector<AnyVertex> vertices;
  /// Ambient states, in the order of vertices, without gaps.
  std::vector<double> states;
  /// Gauge charts of partly fixed poses. Of these, q0 and dphi count; the rest is recomputed.
  std::vector<FreeTangent> free_tangents;
  /// Vertices that have a linearization point, and those points as states are given.
  std::vector<AnyVertex> first_estimate_vertices;
  std::vector<double> first_estimates;
};

}  // namespace glissade
