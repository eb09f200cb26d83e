// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What AddEdge, AddEdges and the weights of typed edges do, whatever the type.

#include <string>
#include <utility>

#include "glissade/graph/pools.h"

namespace glissade {

EdgePool& Graph::MakeEdgePool(const EdgeOps& ops) {
  if (EdgePoolBase* pool = EdgePoolOf(ops.type)) return static_cast<EdgePool&>(*pool);
  edge_pools_.push_back(std::make_unique<EdgePool>(ops, vertex_pools_));
  return static_cast<EdgePool&>(*edge_pools_.back());
}

Status Graph::CheckEdge(const EdgeOps& ops, const void* edge, const AnyVertex* vertices) const {
  const std::span<const AnyVertex> all(vertices, static_cast<std::size_t>(ops.arity));
  if (Status status = CheckEdgeVertices(all, ops.type->name); !status.ok()) return status;
  return ops.validate == nullptr ? Status() : internal::About(ops.validate(edge), ops.type->name);
}

Status Graph::AddNewEdge(const NewEdges& edge) {
  const EdgeOps& ops = *edge.ops;
  AnyVertex vertices[kMaxTypedArity];
  edge.vertices_of(edge.vertices, 0, vertices);
  added_weight_.resize(static_cast<std::size_t>(ops.rows * ops.rows));
  bool identity = true;
  Status status = CheckEdge(ops, edge.edges, vertices);
  if (status.ok()) {
    status = internal::MakeSqrtInformation(ops.rows, edge.weight, added_weight_.data(), &identity);
    if (status.ok()) status = edge.loss->Validate();
    if (!status.ok()) status = internal::About(status, ops.type->name);
  }
  if (!status.ok()) return Refused(std::move(status));
  StructureChanged();
  EdgePool& pool = MakeEdgePool(ops);
  pool.set_evaluate_lanes(edge.evaluate_lanes);
  pool.Reserve(1, identity);
  pool.RoomAt(vertices);
  edge.put_handle(edge.handles, 0,
                  pool.Add(edge.edges, vertices, added_weight_.data(), identity, *edge.loss,
                           structure_version_, Id()));
  return {};
}

Status Graph::AddNewEdges(const NewEdges& edges) {
  if (edges.count == 0) return {};
  const EdgeOps& ops = *edges.ops;
  AnyVertex vertices[kMaxTypedArity];
  const auto edge = [&](std::size_t k) {
    return static_cast<const std::byte*>(edges.edges) + k * ops.value.size;
  };
  const auto check = [&](std::size_t k) {
    Status status = CheckEdge(ops, edge(k), vertices);
    return status.ok() ? status : internal::About(status, "edge " + std::to_string(k));
  };
  edges.vertices_of(edges.vertices, 0, vertices);
  added_weight_.resize(static_cast<std::size_t>(ops.rows * ops.rows));
  bool identity = true;
  Status status = check(0);
  if (status.ok()) {
    status = internal::MakeSqrtInformation(ops.rows, edges.weight, added_weight_.data(), &identity);
    if (status.ok()) status = edges.loss->Validate();
    if (!status.ok()) status = internal::About(status, ops.type->name);
  }
  if (!status.ok()) return Refused(std::move(status));
  EdgePool& pool = MakeEdgePool(ops);
  for (std::size_t k = 1; k < edges.count; ++k) {
    edges.vertices_of(edges.vertices, k, vertices);
    // The whole check has the words; most edges need none.
    if (pool.CanJoin(vertices) && (ops.validate == nullptr || ops.validate(edge(k)).ok())) continue;
    if (status = check(k); !status.ok()) return Refused(std::move(status));
  }
  pool.set_evaluate_lanes(edges.evaluate_lanes);
  pool.Reserve(edges.count, identity);
  for (std::size_t k = 0; k < edges.count; ++k) {
    edges.vertices_of(edges.vertices, k, vertices);
    pool.RoomAt(vertices);
  }
  for (std::size_t k = 0; k < edges.count; ++k) {
    StructureChanged();
    edges.vertices_of(edges.vertices, k, vertices);
    edges.put_handle(edges.handles, k,
                     pool.Add(edge(k), vertices, added_weight_.data(), identity, *edges.loss,
                              structure_version_, Id()));
  }
  return {};
}

Status Graph::SetWeight(AnyEdge edge, const internal::EdgeWeight& weight) {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return Refused(UnknownHandle(edge));
  const int rows = site.pool->residual_dim(site.index);
  added_weight_.resize(static_cast<std::size_t>(rows * rows));
  bool identity = true;
  const Status status =
      internal::MakeSqrtInformation(rows, weight, added_weight_.data(), &identity);
  if (!status.ok()) return Refused({status.code(), status.message(), edge});
  static_cast<EdgePool*>(site.pool)->set_sqrt_information(site.index, added_weight_.data(),
                                                          identity);
  ++weights_version_;
  return {};
}

}  // namespace glissade
