// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "api/model.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "api/nasty_values.h"
#include "glissade/graph/pools.h"

namespace glissade::test {

namespace {

bool SameBits(const double* a, const double* b, std::size_t n) {
  return n == 0 || std::memcmp(a, b, n * sizeof(double)) == 0;
}
bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && SameBits(a.data(), b.data(), a.size());
}

struct Place {
  const VertexPoolBase* pool;
  int index;
};
Place PlaceOf(const Graph& graph, AnyVertex vertex) {
  const VertexPoolBase* pool = graph.PoolOf(vertex.type);
  return {pool, pool->slots().IndexOf(vertex.slot)};
}

/// Lists by type: types may change places, what is of one type may not.
template <class Handle>
std::vector<Handle> ByType(std::vector<Handle> handles) {
  std::stable_sort(handles.begin(), handles.end(),
                   [](const Handle& a, const Handle& b) { return a.type->name < b.type->name; });
  return handles;
}

}  // namespace

Model::Vertex* Model::Find(AnyVertex handle) {
  for (Vertex& vertex : vertices) {
    if (vertex.handle == handle) return &vertex;
  }
  return nullptr;
}

Model::Edge* Model::Find(AnyEdge handle) {
  for (Edge& edge : edges) {
    if (edge.handle == handle) return &edge;
  }
  return nullptr;
}

bool Model::IsUnderPrior(AnyVertex handle) const {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    return edge.is_prior && std::count(edge.vertices.begin(), edge.vertices.end(), handle) > 0;
  });
}

bool Model::CanJoin(const std::vector<AnyVertex>& handles) {
  int eliminated = 0;
  for (const AnyVertex& handle : handles) {
    const Vertex* vertex = Find(handle);
    if (vertex == nullptr || std::count(handles.begin(), handles.end(), handle) > 1) return false;
    eliminated += vertex->eliminated ? 1 : 0;
  }
  return eliminated <= 1;
}

bool Model::HasEliminatedNeighbour(AnyVertex handle) {
  for (const Edge& edge : edges) {
    if (std::count(edge.vertices.begin(), edge.vertices.end(), handle) == 0) continue;
    for (const AnyVertex& other : edge.vertices) {
      if (other != handle && Find(other)->eliminated) return true;
    }
  }
  return false;
}

void Model::AddEdge(AnyEdge handle, std::vector<AnyVertex> on, bool is_prior) {
  for (const AnyVertex& vertex : on)
    Find(vertex)->has_x_lin |= is_prior;
  edges.push_back({handle, std::move(on), is_prior});
}

void Model::DropOrphans() {
  for (Vertex& vertex : vertices)
    vertex.has_x_lin = vertex.has_x_lin && IsUnderPrior(vertex.handle);
}

void Model::Remove(AnyVertex handle) {
  const bool under_prior = IsUnderPrior(handle);
  std::erase_if(edges, [&](const Edge& edge) {
    return std::count(edge.vertices.begin(), edge.vertices.end(), handle) > 0;
  });
  std::erase_if(vertices, [&](const Vertex& vertex) { return vertex.handle == handle; });
  if (under_prior) DropOrphans();
}

void Model::Remove(AnyEdge handle) {
  std::erase_if(edges, [&](const Edge& edge) { return edge.handle == handle; });
  if (handle.type == &kTypeInfo<DynamicEdge>) DropOrphans();
}

std::string Model::TakeStates(const Graph& graph, MayMove may_move) {
  for (Vertex& vertex : vertices) {
    if (!graph.Contains(vertex.handle)) return ToString(vertex.handle) + " has gone";
    const Place place = PlaceOf(graph, vertex.handle);
    const double* x = place.pool->Data(place.index);
    const auto touches = [&](const Edge& edge) {
      return std::count(edge.vertices.begin(), edge.vertices.end(), vertex.handle) > 0;
    };
    const bool lonely = std::none_of(edges.begin(), edges.end(), touches);
    const bool stays = may_move != MayMove::kAll &&
                       (vertex.fix == Fix::kWhole || (lonely && may_move == MayMove::kWhatIsFree));
    if (stays && !SameBits(x, vertex.state.data(), vertex.state.size())) {
      return ToString(vertex.handle) + " is held or free of edges, and has moved";
    }
    vertex.state.assign(x, x + vertex.state.size());
  }
  return {};
}

void Model::TakeElimination(const Graph& graph) {
  for (Vertex& vertex : vertices) {
    const Place place = PlaceOf(graph, vertex.handle);
    vertex.eliminated = vertex.eliminated && place.pool->eliminated(place.index);
  }
}

std::string Model::CompareVertices(const Problem& problem) {
  std::vector<AnyVertex> handles;
  for (const Vertex& vertex : vertices) {
    const std::string name = ToString(vertex.handle);
    handles.push_back(vertex.handle);
    if (!problem.Contains(vertex.handle)) return name + " is missing";
    const Place place = PlaceOf(problem, vertex.handle);
    const double* x = place.pool->Data(place.index);
    if (!SameBits(x, vertex.state.data(), vertex.state.size())) return name + " has another state";
    if (!IsState(vertex.handle.type, x, vertex.state.size())) {
      std::string text = name + " is no state:";
      for (const double v : vertex.state)
        text.append(" ").append(std::to_string(v));
      return text;
    }
    if (problem.GetFixed(vertex.handle) != vertex.fix) return name + " is held otherwise";
    if (place.pool->eliminated(place.index) != vertex.eliminated) {
      return name + " is eliminated otherwise";
    }
    if (problem.HasFirstEstimate(vertex.handle) != vertex.has_x_lin) {
      return name + (vertex.has_x_lin ? " has lost its x_lin" : " has an x_lin");
    }
    const auto x_lin = problem.LinearizationPoint(vertex.handle);
    if (!IsState(vertex.handle.type, x_lin.data(), x_lin.size())) return name + ": x_lin is none";
  }
  if (ByType(problem.Vertices()) != ByType(handles)) return "other vertices, or another order";
  return {};
}

template <class E>
std::string Model::CompareTyped(const Problem& problem) {
  std::string what;
  int count = 0;
  problem.ForEachEdge<E>([&](EdgeHandle<E> handle, const E&, const EdgeVertexHandles<E>& vertices) {
    ++count;
    const auto on = std::apply(
        [](const auto&... v) { return std::vector<AnyVertex>{AnyVertex(v)...}; }, vertices);
    const Edge* edge = Find(AnyEdge(handle));
    if (edge == nullptr || edge->vertices != on) what = "ForEachEdge: " + ToString(handle);
  });
  if (count != problem.NumEdges<E>()) what = "number of edges of a type";
  return what;
}

std::string Model::CompareEdges(const Problem& problem) {
  std::vector<AnyEdge> handles;
  for (const Edge& edge : edges) {
    handles.push_back(edge.handle);
    const auto on = problem.VerticesOf(edge.handle);
    if (!on.ok()) return ToString(edge.handle) + " is missing";
    if (on.value() != edge.vertices) return ToString(edge.handle) + " has other vertices";
    const Result<double> chi2 = problem.Chi2(edge.handle);
    if (chi2.ok() && !(std::isfinite(*chi2) && *chi2 >= 0.0)) {
      return ToString(edge.handle) + ": Chi2 is " + std::to_string(*chi2);
    }
    const Result<double> depth = problem.DepthOf(edge.handle);
    if (depth.ok() && !std::isfinite(*depth)) return ToString(edge.handle) + ": depth not finite";
  }
  if (ByType(problem.Edges()) != ByType(handles)) return "other edges, or another order";
  for (const std::string& what :
       {CompareTyped<EdgeReprojection>(problem), CompareTyped<EdgeReprojectionXYZ>(problem),
        CompareTyped<EdgeRelativePose>(problem), CompareTyped<EdgeSpeedBiasPrior>(problem)}) {
    if (!what.empty()) return what;
  }
  for (const Vertex& vertex : vertices) {
    std::vector<AnyEdge> expected;
    for (const Edge& edge : edges) {
      if (std::count(edge.vertices.begin(), edge.vertices.end(), vertex.handle) > 0) {
        expected.push_back(edge.handle);
      }
    }
    const auto found = problem.EdgesOf(vertex.handle);
    if (!found.ok() || ByType(found.value()) != ByType(expected)) {
      return ToString(vertex.handle) + " has other edges";
    }
    if (problem.NumEdgesOf(vertex.handle).value() != static_cast<int>(expected.size())) {
      return ToString(vertex.handle) + " has another number of edges";
    }
  }
  return {};
}

std::string Model::Compare(const Problem& problem) {
  if (problem.NumVertices() != static_cast<int>(vertices.size())) return "number of vertices";
  if (problem.NumEdges() != static_cast<int>(edges.size())) return "number of edges";
  if (problem.first_refusal().ok() == refused) return "what was refused first";
  for (const Result<double>& sum : {problem.Chi2(), problem.Cost()}) {
    if (sum.ok() && !(std::isfinite(*sum) && *sum >= 0.0)) return "a sum is not finite";
  }
  if (std::string what = CompareVertices(problem); !what.empty()) return what;
  return CompareEdges(problem);
}

Record::Record(const Problem& problem)
    : snapshot(problem.GetSnapshot()),
      edges(problem.Edges()),
      structure_version(problem.structure_version()),
      weights_version(problem.weights_version()) {}

std::string Record::Compare(const Record& before) const {
  if (snapshot.vertices != before.snapshot.vertices) return "vertices";
  if (!SameBits(snapshot.states, before.snapshot.states)) return "states";
  if (snapshot.first_estimate_vertices != before.snapshot.first_estimate_vertices) return "x_lin";
  if (!SameBits(snapshot.first_estimates, before.snapshot.first_estimates)) return "x_lin";
  if (edges != before.edges) return "edges";
  if (structure_version != before.structure_version) return "structure_version";
  if (weights_version != before.weights_version) return "weights_version";
  const auto &a = snapshot.free_tangents, &b = before.snapshot.free_tangents;
  if (a.size() != b.size()) return "charts";
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].vertex != b[k].vertex || a[k].fix != b[k].fix || a[k].free_dim != b[k].free_dim ||
        !SameBits(a[k].q0, b[k].q0, 4) || !SameBits(a[k].dphi, b[k].dphi, 3)) {
      return "charts";
    }
  }
  return {};
}

}  // namespace glissade::test
