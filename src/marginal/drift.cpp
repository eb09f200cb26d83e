// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/drift.h"
#include "glissade/graph/pools.h"

namespace glissade {

const EdgeMarginalPrior* FindMarginalPrior(const Graph& graph, EdgeHandle<DynamicEdge> prior) {
  if (!graph.Contains(AnyEdge(prior))) return nullptr;
  const auto* pool = static_cast<const DynamicEdgePool*>(graph.EdgePoolOf(&kTypeInfo<DynamicEdge>));
  return dynamic_cast<const EdgeMarginalPrior*>(&pool->At(pool->slots().IndexOf(prior.slot)));
}

Result<std::vector<VertexDrift>> Drift(const Graph& graph, EdgeHandle<DynamicEdge> prior) {
  const EdgeMarginalPrior* edge = FindMarginalPrior(graph, prior);
  if (edge == nullptr) {
    return Status(StatusCode::kUnknownHandle, "Drift: no marginal prior of this graph",
                  AnyEdge(prior));
  }
  std::vector<VertexDrift> drift;
  const double* x0 = edge->x0().data();
  const Result<std::vector<AnyVertex>> vertices = graph.VerticesOf(prior);
  for (const AnyVertex& vertex : vertices.value()) {
    const VertexPoolBase& pool = *graph.PoolOf(vertex.type);
    drift.push_back(
        {vertex, std::vector<double>(static_cast<std::size_t>(pool.ops().tangent_dim))});
    pool.ops().minus(pool.Data(pool.slots().IndexOf(vertex.slot)), x0, drift.back().delta.data());
    x0 += pool.ops().ambient_dim;
  }
  return drift;
}

}  // namespace glissade
