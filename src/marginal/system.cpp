// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/system.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "glissade/base/index.h"

namespace glissade::internal {

namespace {

using internal::Index;

using Kind = MarginalVariable::Kind;

/// Without allocating, as std::find_if on a std::function would be with.
bool IsListed(std::span<const AnyEdge> list, AnyEdge edge) {
  return std::find(list.begin(), list.end(), edge) != list.end();
}

}  // namespace

Status MarginalSystem::Build(const Graph& graph, std::span<const AnyVertex> vertices,
                             const MarginalizeOptions& options, MarginalReport* report) {
  graph_ = &graph;
  mode_ = graph.first_estimates();
  if (Status status = MarkGoing(graph, vertices); !status.ok()) return status;
  if (Status status = CollectEdges(graph, options, report); !status.ok()) return status;
  Classify(graph);
  SetPoints();
  OrderVariables();
  SortEdges();
  report->eliminated_landmarks = num_landmarks();
  report->marginalized_dim = going_dim_;
  for (const std::int32_t landmark : landmarks_)
    report->marginalized_dim += variable(landmark).dim;
  return {};
}

std::int32_t MarginalSystem::FindOrAdd(VertexPoolBase* pool, std::int32_t index) {
  std::int32_t& variable = variable_of_[Index(pool->id())][Index(index)];
  if (variable < 0) {
    variable = static_cast<std::int32_t>(variables_.size());
    variables_.emplace_back();
    variables_.back().pool = pool;
    variables_.back().index = index;
  }
  return variable;
}

Status MarginalSystem::MarkGoing(const Graph& graph, std::span<const AnyVertex> vertices) {
  variables_.clear();
  variable_of_.resize(graph.vertex_pools().size());
  for (const auto& pool : graph.vertex_pools())
    variable_of_[Index(pool->id())].assign(Index(pool->size()), -1);
  for (const AnyVertex& vertex : vertices) {
    if (!graph.Contains(vertex)) {
      return About(graph.UnknownHandle(vertex), "Marginalize");
    }
    VertexPoolBase* pool = graph.PoolOf(vertex.type);
    const auto before = variables_.size();
    const std::int32_t added = FindOrAdd(pool, pool->slots().IndexOf(vertex.slot));
    if (Index(added) != before) {
      return {StatusCode::kRepeatedVertex,
              "Marginalize: vertex " + ToString(vertex) + " is given twice", vertex};
    }
    variables_.back().kind = Kind::kGoes;
  }
  return {};
}

Status MarginalSystem::CollectEdges(const Graph& graph, const MarginalizeOptions& options,
                                    MarginalReport* report) {
  for (const AnyEdge& edge : options.drop) {
    if (graph.Contains(edge)) continue;
    return About(graph.UnknownHandle(edge), "Marginalize: to be dropped");
  }
  const auto num_going = static_cast<std::int32_t>(variables_.size());
  unsorted_.clear();
  of_edge_.clear();
  for (const auto& pool : graph.edge_pools()) {
    const int fixed_arity = pool->fixed_arity();
    std::size_t total = 0;
    for (int edge = 0; fixed_arity == 0 && edge < pool->size(); ++edge)
      total += Index(pool->arity(edge));
    if (fixed_arity > 0) total = Index(fixed_arity) * Index(pool->size());
    indices_.resize(total);
    pool->AllDenseIndices(indices_.data());
    const std::int32_t* index = indices_.data();
    // The pool of each slot is the same for all typed edges.
    VertexPoolBase* pools[kMaxTypedArity] = {};
    for (int i = 0; i < fixed_arity; ++i)
      pools[i] = pool->vertex_pool(0, i);
    for (int edge = 0; edge < pool->size(); ++edge) {
      const int arity = fixed_arity > 0 ? fixed_arity : pool->arity(edge);
      bool touched = false;
      for (int i = 0; i < arity && !touched; ++i) {
        const VertexPoolBase* vertices = fixed_arity > 0 ? pools[i] : pool->vertex_pool(edge, i);
        const auto& variable_of = variable_of_[Index(vertices->id())];
        // Edges that are not alive may hold an index of long ago.
        if (Index(index[i]) >= variable_of.size()) continue;
        const std::int32_t variable = variable_of[Index(index[i])];
        touched = variable >= 0 && variable < num_going;
      }
      const std::int32_t* const indices = index;
      index += arity;
      if (!touched || !pool->Alive(edge)) continue;
      if (!options.drop.empty() || options.drop_if) {
        const AnyEdge handle = pool->HandleAt(edge);
        if (IsListed(options.drop, handle) || (options.drop_if && options.drop_if(graph, handle))) {
          ++report->dropped_edges;
          continue;
        }
      }
      MarginalEdge folded;
      folded.pool = pool.get();
      folded.edge = edge;
      folded.begin = static_cast<std::int32_t>(of_edge_.size());
      folded.arity = arity;
      folded.rows = pool->residual_dim(edge);
      for (int i = 0; i < arity; ++i) {
        VertexPoolBase* vertices = fixed_arity > 0 ? pools[i] : pool->vertex_pool(edge, i);
        of_edge_.push_back(FindOrAdd(vertices, indices[i]));
      }
      unsorted_.push_back(folded);
      ++report->folded_edges;
      if (AsPrior(folded) != nullptr) ++report->folded_priors;
    }
  }
  return {};
}

// Which of the vertices that go are landmarks with a block of their own.
void MarginalSystem::Classify(const Graph& graph) {
  landmarks_.clear();
  for (MarginalVariable& v : variables_) {
    v.dim = v.pool->ops().tangent_dim;
    if (v.kind != Kind::kGoes) continue;
    const Fix fix = v.pool->fix(v.index);
    if (fix == Fix::kWhole) {
      v.kind = Kind::kHeld;
      v.dim = 0;
    } else if (fix != Fix::kFree) {
      const AnyVertex handle = v.pool->HandleAt(v.index);
      for (std::size_t t = 0; t < graph.free_tangents().size(); ++t) {
        if (graph.free_tangents()[t].vertex != handle) continue;
        v.tangent = static_cast<std::int32_t>(t);
        v.dim = graph.free_tangents()[t].free_dim;
      }
    } else if (v.pool->eliminated(v.index) && v.dim <= 4) {
      v.kind = Kind::kLandmark;
    }
  }
  // A dynamic edge may have any number of rows and vertices: what it touches goes with the rest.
  for (const MarginalEdge& edge : unsorted_) {
    if (edge.pool->fixed_arity() != 0) continue;
    for (int i = 0; i < edge.arity; ++i) {
      MarginalVariable& v = variables_[Index(of_edge_[Index(edge.begin + i)])];
      if (v.kind == Kind::kLandmark) v.kind = Kind::kGoes;
    }
  }
  for (std::size_t k = 0; k < variables_.size(); ++k) {
    if (variables_[k].kind != Kind::kLandmark) continue;
    variables_[k].column = static_cast<std::int32_t>(landmarks_.size());
    landmarks_.push_back(static_cast<std::int32_t>(k));
  }
}

void MarginalSystem::SetPoints() {
  deltas_.clear();
  for (MarginalVariable& v : variables_) {
    const VertexOps& ops = v.pool->ops();
    const VertexPoolBase& pool = *v.pool;
    v.x = v.x0 = pool.Data(v.index);
    v.delta = static_cast<std::int32_t>(deltas_.size());
    deltas_.resize(deltas_.size() + Index(ops.tangent_dim), 0.0);
    if (mode_ == FirstEstimates::kOff || v.kind == Kind::kHeld || v.tangent >= 0) continue;
    const double* x_lin = pool.first_estimates().At(v.index);
    if (x_lin == nullptr) continue;
    v.x0 = x_lin;
    v.moved = !std::equal(v.x, v.x + ops.ambient_dim, v.x0);
    if (v.moved) ops.minus(v.x, v.x0, deltas_.data() + v.delta);
  }
}

// Columns of one pose and what goes with it (speed and biases) side by side, oldest first: the
// vertices that will go next are then the first columns, and the triangle of this prior stays one.
void MarginalSystem::OrderVariables() {
  dense_order_.clear();
  for (std::size_t k = 0; k < variables_.size(); ++k) {
    if (variables_[k].kind == Kind::kGoes || variables_[k].kind == Kind::kStays) {
      dense_order_.push_back(static_cast<std::int32_t>(k));
    }
  }
  rank_.assign(variables_.size(), 0);
  const auto group = [&](std::int32_t k) {
    const MarginalVariable& v = variable(k);
    return std::pair(v.kind == Kind::kStays, v.pool->ops().eliminated);
  };
  std::sort(dense_order_.begin(), dense_order_.end(), [&](std::int32_t a, std::int32_t b) {
    return std::tuple(group(a), variable(a).pool->id(), variable(a).index) <
           std::tuple(group(b), variable(b).pool->id(), variable(b).index);
  });
  for (std::size_t k = 1; k < dense_order_.size(); ++k) {
    const std::int32_t a = dense_order_[k - 1], b = dense_order_[k];
    const bool same = group(a) == group(b) && variable(a).pool == variable(b).pool;
    rank_[Index(b)] = same ? rank_[Index(a)] + 1 : 0;
  }
  std::sort(dense_order_.begin(), dense_order_.end(), [&](std::int32_t a, std::int32_t b) {
    return std::tuple(group(a), rank_[Index(a)], variable(a).pool->id()) <
           std::tuple(group(b), rank_[Index(b)], variable(b).pool->id());
  });
  going_dim_ = staying_dim_ = 0;
  for (const std::int32_t k : dense_order_) {
    MarginalVariable& v = variables_[Index(k)];
    v.column = going_dim_ + staying_dim_;
    (v.kind == Kind::kGoes ? going_dim_ : staying_dim_) += v.dim;
  }
}

void MarginalSystem::SortEdges() {
  const std::size_t buckets = landmarks_.size() + 1;
  edges_begin_.assign(buckets + 1, 0);
  for (MarginalEdge& edge : unsorted_) {
    for (int i = 0; i < edge.arity; ++i) {
      const MarginalVariable& v = VertexOf(edge, i);
      if (v.kind == Kind::kLandmark) edge.landmark = v.column;
    }
    const std::size_t bucket = edge.landmark >= 0 ? Index(edge.landmark) : landmarks_.size();
    ++edges_begin_[bucket + 1];
  }
  for (std::size_t k = 0; k < buckets; ++k)
    edges_begin_[k + 1] += edges_begin_[k];
  fill_.assign(edges_begin_.begin(), edges_begin_.end() - 1);
  edges_.resize(unsorted_.size());
  for (const MarginalEdge& edge : unsorted_) {
    const std::size_t bucket = edge.landmark >= 0 ? Index(edge.landmark) : landmarks_.size();
    edges_[Index(fill_[bucket]++)] = edge;
  }
}

std::span<const MarginalEdge> MarginalSystem::EdgesOf(int landmark) const {
  const std::int32_t begin = edges_begin_[Index(landmark)], end = edges_begin_[Index(landmark) + 1];
  return {edges_.data() + begin, Index(end - begin)};
}

const EdgeMarginalPrior* MarginalSystem::AsPrior(const MarginalEdge& edge) {
  if (edge.pool->type() != &kTypeInfo<DynamicEdge>) return nullptr;
  return dynamic_cast<const EdgeMarginalPrior*>(
      &static_cast<const DynamicEdgePool*>(edge.pool)->At(edge.edge));
}

bool MarginalSystem::IsUnmoved(const MarginalEdge& edge) const {
  const EdgeMarginalPrior* prior = AsPrior(edge);
  const double* x0 = prior->x0().data();
  for (int i = 0; i < edge.arity; ++i) {
    const MarginalVariable& v = VertexOf(edge, i);
    const int dim = v.pool->ops().ambient_dim;
    if (v.kind == Kind::kHeld || v.tangent >= 0 || !std::equal(x0, x0 + dim, v.x0)) return false;
    x0 += dim;
  }
  return true;
}

}  // namespace glissade::internal
