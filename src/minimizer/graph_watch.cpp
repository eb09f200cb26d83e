// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "minimizer/graph_watch.h"

#include <cstring>

#include "glissade/graph/pools.h"

namespace glissade {

namespace {

/// f(numbers of one state, how many) until it says false.
template <class F>
bool ForEachState(const Graph& graph, F&& f) {
  for (const auto& pool : graph.vertex_pools()) {
    const VertexPoolBase& vertices = *pool;
    const auto dim = static_cast<std::size_t>(vertices.ops().ambient_dim);
    for (int k = 0; k < vertices.size(); ++k) {
      if (!f(vertices.Data(k), dim)) return false;
    }
  }
  return true;
}

}  // namespace

void GraphWatch::Keep(const Graph& graph) {
  identity_ = graph.identity();
  structure_ = graph.structure_version();
  weights_ = graph.weights_version();
  states_.clear();
  ForEachState(graph, [&](const double* x, std::size_t dim) {
    states_.insert(states_.end(), x, x + dim);
    return true;
  });
}

const char* GraphWatch::FindChange(const Graph& graph) const {
  if (graph.identity() != identity_) return "the callback has moved the graph or solved it";
  if (graph.structure_version() != structure_) return "the callback has changed the graph";
  if (graph.weights_version() != weights_) return "the callback has changed weights of the graph";
  std::size_t at = 0;
  const bool same = ForEachState(graph, [&](const double* x, std::size_t dim) {
    at += dim;
    return at <= states_.size() &&
           std::memcmp(x, states_.data() + at - dim, dim * sizeof(double)) == 0;
  });
  return same ? nullptr : "the callback has changed values of the graph";
}

}  // namespace glissade
