// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covariance/linearized_graph.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {

using internal::Index;

}  // namespace

Status LinearizedGraph::Linearize(Graph* graph, const Gauge& gauge, int num_threads) {
  threads.Resize(num_threads);
  GaugeGuard guard;
  if (Status status = guard.Begin(gauge, graph); !status.ok()) return status;
  Status status =
      structure.Analyze(graph, {.allow_duplicate_observations = true, .group_landmarks = false});
  if (!status.ok()) return status;
  double cost = 0.0;
  status = equations.Linearize(structure, graph, &threads, &cost);
  if (!status.ok()) return status;
  hessian = equations.GetHessian(structure);
  tangents = graph->free_tangents();
  references = graph->gauge_references();
  ListPlaces(*graph);
  return {};
}

Status LinearizedGraph::Eliminate(const Graph& graph) {
  DampingTerm none;
  none.reduced_only = true;  // lambda is 0: no damping anywhere
  const StepFailure failure =
      equations.Eliminate(structure, graph, none, SchurForm::kDense, &threads);
  return failure;
}

void LinearizedGraph::ListPlaces(const Graph& graph) {
  handles_.clear();
  places_.clear();
  index_.clear();
  vertices.clear();
  for (const auto& pool : graph.vertex_pools()) {
    std::vector<AnyVertex>& handles = handles_.emplace_back();
    std::vector<Place>& places = places_.emplace_back();
    auto& index = index_[pool->ops().type];
    for (int k = 0; k < pool->size(); ++k) {
      handles.push_back(pool->HandleAt(k));
      vertices.push_back(handles.back());
      Place place;
      place.dim = pool->ops().tangent_dim;
      place.unconnected = pool->fix(k) != Fix::kWhole;
      place.state.assign(pool->Data(k), pool->Data(k) + pool->ops().ambient_dim);
      places.push_back(std::move(place));
      index[handles.back().slot] = Index(k);
    }
  }
  const auto place_of = [&](const auto& block) -> Place& {
    return places_[Index(block.pool)][Index(block.index)];
  };
  for (std::size_t k = 0; k < structure.poses().size(); ++k) {
    place_of(structure.poses()[k]).pose = static_cast<int>(k);
    place_of(structure.poses()[k]).unconnected = false;
  }
  for (std::size_t k = 0; k < structure.landmarks().size(); ++k) {
    place_of(structure.landmarks()[k]).landmark = static_cast<int>(k);
    place_of(structure.landmarks()[k]).unconnected = false;
  }
}

const LinearizedGraph::Place* LinearizedGraph::Find(AnyVertex vertex) const {
  const auto pool = index_.find(vertex.type);
  if (pool == index_.end()) return nullptr;
  const auto at = pool->second.find(vertex.slot);
  if (at == pool->second.end()) return nullptr;
  for (std::size_t p = 0; p < handles_.size(); ++p) {
    if (handles_[p].empty() || handles_[p].front().type != vertex.type) continue;
    return handles_[p][at->second] == vertex ? &places_[p][at->second] : nullptr;
  }
  return nullptr;
}

}  // namespace glissade
