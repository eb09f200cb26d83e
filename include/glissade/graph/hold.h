// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "glissade/graph/fix.h"

namespace glissade {

/// Where the anchor of a gauge is held or pulled to: its pose when it was first named as one. Kept
/// by the graph through all solves: a rotation R0 taken anew at each solve would let the yaw drift
/// (the product of rotations without yaw has one).
struct GaugeReference {
  AnyVertex anchor;
  double pose[7] = {0, 0, 0, 0, 0, 0, 1};
  // Without IMU and with one camera: whose camera centre carries the scale, and in which
  // coordinate.
  AnyVertex second;
  int axis = 0;
  double coordinate = 0.0;
};

/// What Graph::BeginHold() changed, to be put back.
struct TemporaryHold {
  bool active = false;
  std::uint64_t identity = 0;  ///< of the graph while this is held
  std::vector<std::pair<AnyVertex, Fix>> held;
  std::vector<std::pair<AnyVertex, Fix>> before;  ///< the graph's own
  std::vector<std::pair<std::size_t, FreeTangent>> replaced;
  std::size_t num_own_tangents = 0;
  AnyEdge edge;                          ///< that is there while this is held; null: none
  std::vector<AnyVertex> edge_vertices;  ///< of the edge of this or the last hold
  int edge_rows = 0;
};

}  // namespace glissade
