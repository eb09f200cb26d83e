// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/graph/graph.h"

namespace glissade {

/// A gauge in force, from Begin() to End() or destruction: what Solve and Covariance wrap around
/// their work. Fixing is a temporary hold (Graph::BeginHold), which changes neither the graph's
/// structure nor its own fixing; a prior is an edge that comes and goes, and so costs an analysis
/// of the structure.
class GaugeGuard {
 public:
  GaugeGuard() = default;
  GaugeGuard(const GaugeGuard&) = delete;
  GaugeGuard& operator=(const GaugeGuard&) = delete;
  ~GaugeGuard() { End(); }

  /// Remembers the anchor's pose as reference if the graph does not know it as an anchor yet. On
  /// failure nothing is changed.
  Status Begin(const Gauge& gauge, Graph* graph);
  void End();

 private:
  Graph* graph_ = nullptr;
  EdgeHandle<DynamicEdge> prior_;
};

}  // namespace glissade
