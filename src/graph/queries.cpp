// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"

namespace glissade {

namespace {

Status NoValue(const EdgePoolBase& pool, int edge) {
  const AnyEdge handle = pool.HandleAt(edge);
  return {StatusCode::kEvaluationFailed, "edge " + ToString(handle) + " has no finite value",
          handle};
}

Status Overflow(std::string_view what) {
  return {StatusCode::kNotFinite, std::string(what) + ": the sum over all edges is not finite"};
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

/// f(pool, edge, Chi2 of the edge).
template <class F>
Status ForEachChi2(const Graph::EdgePools& pools, F&& f) {
  for (const auto& pool : pools) {
    const std::vector<double> batched = pool->BatchedChi2();
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      double s = batched.empty() ? NAN : batched[static_cast<std::size_t>(edge)];
      if (std::isnan(s)) s = pool->Chi2(edge);
      if (Status status = f(*pool, edge, s); !status.ok()) return status;
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
  int count = 0;
  for (const auto& pool : edge_pools_)
    count += pool->slots().NumAlive();
  return count;
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

Result<std::vector<AnyVertex>> Graph::VerticesOf(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return UnknownHandle(edge);
  std::vector<AnyVertex> vertices;
  for (int i = 0; i < site.pool->arity(site.index); ++i)
    vertices.push_back(site.pool->VertexOf(site.index, i));
  return vertices;
}

Result<std::vector<AnyEdge>> Graph::EdgesOf(AnyVertex vertex) const {
  const Result<int> count = NumEdgesOf(vertex);
  if (!count.ok()) return count.status();
  const VertexPoolBase& vertices = *Locate(vertex).pool;
  std::vector<AnyEdge> edges(static_cast<std::size_t>(*count));
  auto end = edges.begin();
  for (const auto& pool : edge_pools_) {
    const auto begin = end;
    pool->ForEachEdgeAt(vertices, vertex.slot, [&](int edge) { *end++ = pool->HandleAt(edge); });
    std::reverse(begin, end);
  }
  return edges;
}

Result<int> Graph::NumEdgesOf(AnyVertex vertex) const {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return UnknownHandle(vertex);
  int count = 0;
  for (const auto& pool : edge_pools_)
    pool->ForEachEdgeAt(*site.pool, vertex.slot, [&](int) { ++count; });
  return count;
}

Result<double> Graph::Chi2(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return UnknownHandle(edge);
  const double s = site.pool->Chi2(site.index);
  if (!std::isfinite(s)) return NoValue(*site.pool, site.index);
  return s;
}

Result<double> Graph::Chi2() const {
  double sum = 0.0;
  const Status status = ForEachChi2(edge_pools_, [&](const EdgePoolBase& pool, int edge, double s) {
    sum += s;
    return std::isfinite(s) ? Status() : NoValue(pool, edge);
  });
  if (!status.ok()) return status;
  if (!std::isfinite(sum)) return Overflow("Chi2");
  return sum;
}

Result<double> Graph::Cost() const {
  double sum = 0.0;
  const Status status = ForEachChi2(edge_pools_, [&](const EdgePoolBase& pool, int edge, double s) {
    // An s that has overflowed still has a cost where the loss is bounded, as in a solve.
    const double cost = std::isnan(s) ? s : internal::RobustScale(pool.loss(edge), s).cost;
    sum += cost;
    return std::isfinite(cost) ? Status() : NoValue(pool, edge);
  });
  if (!status.ok()) return status;
  if (!std::isfinite(sum)) return Overflow("Cost");
  return sum;
}

Result<double> Graph::DepthOf(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return UnknownHandle(edge);
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

}  // namespace glissade
