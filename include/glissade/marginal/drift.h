// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/graph.h"

namespace glissade {

/// How far a vertex of a marginal prior has moved since it was linearized.
struct VertexDrift {
  AnyVertex vertex;
  /// x boxminus x0, in the vertex's tangent (a pose: m in world axes, then rad in body axes).
  std::vector<double> delta;
};

/// The prior of a handle that Marginalize() gave; null for anything else. Valid until the graph is
/// changed.
const EdgeMarginalPrior* FindMarginalPrior(const Graph& graph, EdgeHandle<DynamicEdge> prior);

/// In the order of the prior's vertices. Refused: a handle that is dead or of no marginal prior.
Result<std::vector<VertexDrift>> Drift(const Graph& graph, EdgeHandle<DynamicEdge> prior);

}  // namespace glissade
