// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/graph/graph.h"
#include "glissade/graph/robust.h"

namespace glissade {

namespace {

Status NoValue(const EdgePoolBase& pool, int edge) {
  const AnyEdge handle = pool.HandleAt(edge);
  return {StatusCode::kEvaluationFailed, "edge " + ToString(handle) + " has no finite value",
          handle};
}

template <class F>
Status ForEachLiveEdge(const Graph::EdgePools& pools, F&& f) {
  for (const auto& pool : pools) {
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      if (Status status = f(*pool, edge); !status.ok()) return status;
    }
  }
  return {};
}

}  // namespace

int Graph::NumVertices() const {
  int count = 0;
  for (const auto& pool : vertex_pools_)
    count += pool->slots().NumAlive();
  return count;
}

int Graph::NumEdges() const {
  return static_cast<int>(Edges().size());
}

std::vector<AnyVertex> Graph::Vertices() const {
  std::vector<AnyVertex> vertices;
  for (const auto& pool : vertex_pools_) {
    for (int k = 0; k < pool->size(); ++k) {
      if (pool->slots().AliveAt(k)) vertices.push_back(pool->HandleAt(k));
    }
  }
  return vertices;
}

std::vector<AnyEdge> Graph::Edges() const {
  std::vector<AnyEdge> edges;
  (void)ForEachLiveEdge(edge_pools_, [&](const EdgePoolBase& pool, int edge) {
    edges.push_back(pool.HandleAt(edge));
    return Status();
  });
  return edges;
}

std::vector<AnyVertex> Graph::VerticesOf(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  std::vector<AnyVertex> vertices;
  for (int i = 0; site.pool != nullptr && i < site.pool->arity(site.index); ++i) {
    vertices.push_back(site.pool->VertexOf(site.index, i));
  }
  return vertices;
}

std::vector<AnyEdge> Graph::EdgesOf(AnyVertex vertex) const {
  std::vector<AnyEdge> edges;
  (void)ForEachLiveEdge(edge_pools_, [&](const EdgePoolBase& pool, int edge) {
    for (int i = 0; i < pool.arity(edge); ++i) {
      if (pool.VertexOf(edge, i) == vertex) {
        edges.push_back(pool.HandleAt(edge));
        break;
      }
    }
    return Status();
  });
  return edges;
}

Result<double> Graph::Chi2(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) {
    return Status(StatusCode::kUnknownHandle, "edge " + ToString(edge) + " is not in this graph",
                  edge);
  }
  const double s = site.pool->Chi2(site.index);
  if (!std::isfinite(s)) return NoValue(*site.pool, site.index);
  return s;
}

Result<double> Graph::Chi2() const {
  double sum = 0.0;
  const Status status = ForEachLiveEdge(edge_pools_, [&](const EdgePoolBase& pool, int edge) {
    const double s = pool.Chi2(edge);
    sum += s;
    return std::isfinite(s) ? Status() : NoValue(pool, edge);
  });
  if (!status.ok()) return status;
  return sum;
}

Result<double> Graph::Cost() const {
  double sum = 0.0;
  const Status status = ForEachLiveEdge(edge_pools_, [&](const EdgePoolBase& pool, int edge) {
    const double s = pool.Chi2(edge);
    const double cost = std::isfinite(s) ? internal::RobustScale(pool.loss(edge), s).cost : s;
    sum += cost;
    return std::isfinite(cost) ? Status() : NoValue(pool, edge);
  });
  if (!status.ok()) return status;
  return sum;
}

Result<double> Graph::DepthOf(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) {
    return Status(StatusCode::kUnknownHandle, "edge " + ToString(edge) + " is not in this graph",
                  edge);
  }
  double depth = 0.0;
  if (!site.pool->Depth(site.index, &depth)) {
    return Status(StatusCode::kInvalidArgument, "edge " + ToString(edge) + " observes no depth",
                  edge);
  }
  if (!std::isfinite(depth)) return NoValue(*site.pool, site.index);
  return depth;
}

std::vector<AnyEdge> Graph::GetOutlierEdges(const OutlierOptions& options) const {
  std::vector<AnyEdge> outliers;
  (void)ForEachLiveEdge(edge_pools_, [&](const EdgePoolBase& pool, int edge) {
    if (!pool.IsObservation()) return Status();
    const double s = pool.Chi2(edge);
    double depth = 0.0;
    const bool too_near = pool.Depth(edge, &depth) && !(depth > options.min_depth);
    if (!(s <= options.max_chi2) || too_near) outliers.push_back(pool.HandleAt(edge));
    return Status();
  });
  return outliers;
}

Snapshot Graph::GetSnapshot() const {
  Snapshot snapshot;
  snapshot.vertices = Vertices();
  for (const AnyVertex& vertex : snapshot.vertices) {
    const VertexSite site = Locate(vertex);
    const double* data = site.pool->Data(site.index);
    snapshot.states.insert(snapshot.states.end(), data, data + site.pool->ops().ambient_dim);
  }
  snapshot.free_tangents = free_tangents_;
  AddFirstEstimatesTo(&snapshot);
  return snapshot;
}

Status Graph::RestoreSnapshot(const Snapshot& snapshot) {
  // A snapshot is plain numbers that may come from anywhere: check before touching anything.
  std::size_t size = 0;
  bool fits = static_cast<int>(snapshot.vertices.size()) == NumVertices();
  for (std::size_t k = 0; fits && k < snapshot.vertices.size(); ++k) {
    const VertexSite site = Locate(snapshot.vertices[k]);
    fits = site.pool != nullptr;
    if (fits) size += static_cast<std::size_t>(site.pool->ops().ambient_dim);
  }
  if (!fits) {
    return {StatusCode::kInvalidArgument,
            "RestoreSnapshot: vertices were added or removed since it was taken"};
  }
  if (snapshot.states.size() != size) {
    return {StatusCode::kInvalidArgument,
            "RestoreSnapshot: " + std::to_string(snapshot.states.size()) + " numbers instead of " +
                std::to_string(size)};
  }
  if (Status status = ValidateFinite(snapshot.states.data(), static_cast<int>(size), "snapshot");
      !status.ok()) {
    return status;
  }
  for (const FreeTangent& tangent : snapshot.free_tangents) {
    if (internal::AllFinite(tangent.q0, 4) && internal::AllFinite(tangent.dphi, 3)) continue;
    return {StatusCode::kNotFinite, "RestoreSnapshot: the chart of a pose is not finite",
            tangent.vertex};
  }
  if (Status status = CheckFirstEstimates(snapshot); !status.ok()) return status;
  RestoreFirstEstimates(snapshot);
  const double* from = snapshot.states.data();
  for (const AnyVertex& vertex : snapshot.vertices) {
    const VertexSite site = Locate(vertex);
    const int dim = site.pool->ops().ambient_dim;
    std::copy_n(from, dim, site.pool->Data(site.index));
    from += dim;
  }
  // Charts: those of the snapshot for vertices that are still held alike, fresh ones for the rest.
  for (FreeTangent& tangent : free_tangents_) {
    Reanchor(tangent.vertex);
    for (const FreeTangent& old : snapshot.free_tangents) {
      if (old.vertex == tangent.vertex && old.fix == tangent.fix) tangent = old;
    }
  }
  return {};
}

}  // namespace glissade
