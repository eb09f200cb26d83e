// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// How a dynamic edge comes into a graph.

#include <utility>

#include "glissade/graph/pools.h"

namespace glissade {

Status Graph::CheckEdgeVertices(std::span<const AnyVertex> vertices,
                                std::string_view edge_name) const {
  int eliminated = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const VertexSite site = Locate(vertices[i]);
    if (site.pool == nullptr) {
      return internal::About(UnknownHandle(vertices[i]), edge_name);
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (vertices[i] == vertices[j]) {
        return {StatusCode::kRepeatedVertex,
                std::string(edge_name) + ": " + ToString(vertices[i]) + " is given twice",
                vertices[i]};
      }
    }
    if (site.pool->eliminated(site.index) && ++eliminated == 2) {
      return {StatusCode::kEliminatedPair,
              std::string(edge_name) + ": joins two eliminated vertices; keep one of them with " +
                  "SetEliminated(" + ToString(vertices[i]) + ", false)",
              vertices[i]};
    }
  }
  return {};
}

Status Graph::CheckDynamicEdge(const DynamicEdge* edge, std::span<const AnyVertex> vertices,
                               const Loss& loss) {
  if (edge == nullptr) return {StatusCode::kInvalidArgument, "dynamic edge is null"};
  if (vertices.empty()) return {StatusCode::kInvalidArgument, "dynamic edge without vertices"};
  if (Status status = CheckEdgeVertices(vertices, "dynamic edge"); !status.ok()) return status;
  added_ops_.clear();
  added_vertices_.clear();
  for (const AnyVertex& vertex : vertices) {
    const VertexSite site = Locate(vertex);
    added_ops_.push_back(&site.pool->ops());
    added_vertices_.push_back({site.pool, vertex.slot});
  }
  if (Status status = edge->CheckVertices(added_ops_); !status.ok()) {
    return internal::About(status, "dynamic edge");
  }
  if (edge->ResidualDim() < 1) {
    return {StatusCode::kInvalidArgument, "dynamic edge without residuals"};
  }
  if (!loss.trivial() && edge->ConstantHessian() != nullptr) {
    return {StatusCode::kInvalidArgument,
            "a dynamic edge with a constant Hessian cannot have a robust loss"};
  }
  const double* x0 = edge->LinearizationPoint();
  for (std::size_t i = 0; x0 != nullptr && i < vertices.size(); ++i) {
    if (Status status = added_ops_[i]->validate(x0); !status.ok()) {
      return internal::About(status, "dynamic edge: linearization point");
    }
    x0 += added_ops_[i]->ambient_dim;
  }
  return loss.Validate();
}

Result<EdgeHandle<DynamicEdge>> Graph::AddEdge(std::unique_ptr<DynamicEdge> edge,
                                               std::span<const AnyVertex> vertices, Loss loss) {
  if (Status status = CheckDynamicEdge(edge.get(), vertices, loss); !status.ok()) {
    return Refused(std::move(status));
  }
  auto* pool = static_cast<DynamicEdgePool*>(EdgePoolOf(&kTypeInfo<DynamicEdge>));
  if (pool == nullptr) {
    edge_pools_.push_back(std::make_unique<DynamicEdgePool>());
    pool = static_cast<DynamicEdgePool*>(edge_pools_.back().get());
  }
  StructureChanged();
  const DynamicEdge& stays = *edge;
  const EdgeHandle<DynamicEdge> handle =
      pool->Add(std::move(edge), added_vertices_, loss, structure_version_, Id());
  try {
    EnterFirstEstimates(stays, vertices);
  } catch (...) {  // out of memory: all or nothing
    pool->TakeBack(handle);
    DropOrphanedFirstEstimates();
    throw;
  }
  return handle;
}

}  // namespace glissade
