// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/graph/graph.h"

namespace glissade {

/// A gauge in force, from Begin() to End() or destruction: what Solve and Covariance wrap around
/// their work: a temporary hold (Graph::BeginHold), of vertices or by an edge, which changes
/// neither the graph's structure nor its own fixing.
class GaugeGuard {
 public:
  GaugeGuard() = default;
  GaugeGuard(const GaugeGuard&) = delete;
  GaugeGuard& operator=(const GaugeGuard&) = delete;
  ~GaugeGuard() { End(); }

  /// Remembers the anchor's pose as reference if the graph does not know it as an anchor yet. On
  /// failure nothing is changed.
  Status Begin(const Gauge& gauge, Graph* graph);
  void End() noexcept;

 private:
  Status Hold(Graph* graph, Status status);

  Graph* graph_ = nullptr;
};

}  // namespace glissade
