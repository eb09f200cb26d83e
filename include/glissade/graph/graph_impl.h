// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Templates of Graph. Included by graph.h only.

#include <array>
#include <string>

#include "glissade/base/validate.h"
#include "glissade/graph/graph.h"

namespace glissade {

namespace internal {

/// Prefixes a status with what it is about; ok stays ok.
Status About(const Status& status, std::string_view subject);

}  // namespace internal

template <VertexType V>
VertexPool<V>& Graph::MakePool() {
  if (VertexPool<V>* pool = Pool<V>()) return *pool;
  vertex_pools_.push_back(std::make_unique<VertexPool<V>>());
  vertex_pools_.back()->set_id(static_cast<int>(vertex_pools_.size()) - 1);
  return static_cast<VertexPool<V>&>(*vertex_pools_.back());
}

template <EdgeType E>
EdgePool<E>& Graph::MakeEdgePool() {
  if (EdgePool<E>* pool = Pool<E>()) return *pool;
  typename EdgePool<E>::Pools pools;
  ForEachIndex<EdgePool<E>::kArity>(
      [&](auto i) { std::get<i>(pools) = &MakePool<EdgeVertex<E, i>>(); });
  edge_pools_.push_back(std::make_unique<EdgePool<E>>(pools));
  return static_cast<EdgePool<E>&>(*edge_pools_.back());
}

template <VertexType V>
Status Graph::CheckVertex(const V& value) const {
  // Pools reach all states from the first one and sizeof(V): the state must lie in the value.
  const auto* begin = reinterpret_cast<const std::byte*>(&value);
  const auto* data = reinterpret_cast<const std::byte*>(value.Data());
  if (data < begin || data + sizeof(double) * V::kAmbientDim > begin + sizeof(V)) {
    return internal::About({StatusCode::kInvalidArgument, "Data() must point into the vertex"},
                           kTypeInfo<V>.name);
  }
  if (!internal::AllFinite(value.Data(), V::kAmbientDim)) {
    return internal::About({StatusCode::kNotFinite, "state is not finite"}, kTypeInfo<V>.name);
  }
  return internal::About(internal::ValidateIfPossible(value), kTypeInfo<V>.name);
}

template <class V>
Result<VertexHandle<V>> Graph::AddVertex(const V& value) {
  if constexpr (!VertexType<V>) {
    internal::ExplainVertex<V>();
    return Status();
  } else {
    if (Status status = CheckVertex(value); !status.ok()) return Refused(std::move(status));
    StructureChanged();
    VertexPool<V>& pool = MakePool<V>();
    pool.Reserve(1);
    return pool.Add(value, structure_version_, Id());
  }
}

template <VertexType V>
Result<std::vector<VertexHandle<V>>> Graph::AddVertices(std::span<const V> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (Status status = CheckVertex(values[k]); !status.ok()) {
      return Refused(internal::About(status, "value " + std::to_string(k)));
    }
  }
  std::vector<VertexHandle<V>> handles;
  handles.reserve(values.size());
  VertexPool<V>& pool = MakePool<V>();
  pool.Reserve(values.size());
  StructureChanged();
  for (const V& value : values)
    handles.push_back(pool.Add(value, structure_version_, Id()));
  return handles;
}

template <EdgeType E>
Status Graph::CheckEdge(const E& edge, const EdgeVertexHandles<E>& vertices) const {
  constexpr std::size_t kArity = E::Vertices::kSize;
  const auto handles = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<AnyVertex, kArity>{AnyVertex(std::get<I>(vertices))...};
  }
  (std::make_index_sequence<kArity>{});
  if (Status status = CheckEdgeVertices(handles, kTypeInfo<E>.name); !status.ok()) return status;
  return internal::About(internal::ValidateIfPossible(edge), kTypeInfo<E>.name);
}

template <class E, class Unit>
requires(!std::is_constructible_v<std::unique_ptr<DynamicEdge>, E>)
    Result<EdgeHandle<E>> Graph::AddEdge(const E& edge,
                                         const std::type_identity_t<EdgeVertices<E>>& vertices,
                                         const EdgeOptions<E>& options) {
  if constexpr (!EdgeType<E>) {
    internal::ExplainEdge<E>();
    return Status();
  } else {
    SquareMatrix<E::kResidualDim> sqrt;
    bool identity = true;
    Status status = CheckEdge(edge, vertices.handles());
    if (status.ok()) status = CheckOptions(options, &sqrt, &identity);
    if (!status.ok()) return Refused(std::move(status));
    StructureChanged();
    EdgePool<E>& pool = MakeEdgePool<E>();
    pool.set_evaluate_lanes(internal::UnitEvaluator<E, Unit>());
    pool.Reserve(std::span(&vertices.handles(), 1));
    return pool.Add(edge, vertices.handles(), sqrt.data(), identity, options.loss,
                    structure_version_, Id());
  }
}

template <EdgeType E>
Status Graph::CheckOptions(const EdgeOptions<E>& options, SquareMatrix<E::kResidualDim>* sqrt,
                           bool* identity) {
  Status status = internal::MakeSqrtInformation<E::kResidualDim>(
      options.sqrt_information, options.information, sqrt, identity);
  if (status.ok()) status = options.loss.Validate();
  return internal::About(status, kTypeInfo<E>.name);
}

template <EdgeType E, class Unit>
Result<std::vector<EdgeHandle<E>>> Graph::AddEdges(std::span<const E> edges,
                                                   std::span<const EdgeVertexHandles<E>> vertices,
                                                   const EdgeOptions<E>& options) {
  if (edges.size() != vertices.size()) {
    return Refused({StatusCode::kInvalidArgument, "as many vertex tuples as edges are needed"});
  }
  std::vector<EdgeHandle<E>> handles;
  if (edges.empty()) return handles;
  const auto check = [&](std::size_t k) {
    Status status = CheckEdge(edges[k], vertices[k]);
    return status.ok() ? status : internal::About(status, "edge " + std::to_string(k));
  };
  SquareMatrix<E::kResidualDim> sqrt;
  bool identity = true;
  Status status = check(0);
  if (status.ok()) status = CheckOptions(options, &sqrt, &identity);
  if (!status.ok()) return Refused(std::move(status));
  EdgePool<E>& pool = MakeEdgePool<E>();
  for (std::size_t k = 1; k < edges.size(); ++k) {
    // The whole check has the words; most edges need none.
    if (pool.CanJoin(vertices[k]) && internal::ValidateIfPossible(edges[k]).ok()) continue;
    if (status = check(k); !status.ok()) return Refused(std::move(status));
  }
  handles.reserve(edges.size());
  pool.set_evaluate_lanes(internal::UnitEvaluator<E, Unit>());
  pool.Reserve(vertices);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    StructureChanged();
    handles.push_back(pool.Add(edges[k], vertices[k], sqrt.data(), identity, options.loss,
                               structure_version_, Id()));
  }
  return handles;
}

template <VertexType V>
const V* Graph::Find(VertexHandle<V> vertex) const {
  const VertexPool<V>* pool = Pool<V>();
  if (pool == nullptr || !pool->slots().Contains(vertex)) return nullptr;
  return &pool->At(pool->slots().IndexOf(vertex.slot));
}

template <EdgeType E>
const E* Graph::Find(EdgeHandle<E> edge) const {
  if (!Contains(AnyEdge(edge))) return nullptr;
  const EdgePool<E>* pool = Pool<E>();
  return &pool->At(pool->slots().IndexOf(edge.slot));
}

template <VertexType V>
const V& Graph::Get(VertexHandle<V> vertex) const {
  static const V kDead{};
  const V* value = Find(vertex);
  return value != nullptr ? *value : kDead;
}

template <VertexType V>
Status Graph::Set(VertexHandle<V> vertex, const V& value) {
  VertexPool<V>* pool = Pool<V>();
  if (pool == nullptr || !pool->slots().Contains(vertex)) {
    return Refused(internal::About(UnknownHandle(AnyVertex(vertex)), "Set"));
  }
  if (Status status = CheckVertex(value); !status.ok()) {
    return Refused({status.code(), status.message(), AnyVertex(vertex)});
  }
  pool->At(pool->slots().IndexOf(vertex.slot)) = value;
  Reanchor(vertex);
  return {};
}

template <EdgeType E>
Status Graph::SetSqrtInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& sqrt) {
  if (!Contains(AnyEdge(edge))) return Refused(UnknownHandle(AnyEdge(edge)));
  SquareMatrix<E::kResidualDim> checked;
  bool identity = true;
  const Status status = internal::MakeSqrtInformation<E::kResidualDim>(
      std::optional(sqrt), std::nullopt, &checked, &identity);
  if (!status.ok()) return Refused({status.code(), status.message(), AnyEdge(edge)});
  EdgePool<E>* pool = Pool<E>();
  pool->set_sqrt_information(pool->slots().IndexOf(edge.slot), checked.data(), identity);
  ++weights_version_;
  return {};
}

template <EdgeType E>
Status Graph::SetInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& information) {
  if (!Contains(AnyEdge(edge))) return Refused(UnknownHandle(AnyEdge(edge)));
  SquareMatrix<E::kResidualDim> sqrt;
  bool identity = true;
  const Status status = internal::MakeSqrtInformation<E::kResidualDim>(
      std::nullopt, std::optional(information), &sqrt, &identity);
  if (!status.ok()) return Refused({status.code(), status.message(), AnyEdge(edge)});
  return SetSqrtInformation(edge, sqrt);
}

template <VertexType V>
int Graph::NumVertices() const {
  const VertexPool<V>* pool = Pool<V>();
  return pool == nullptr ? 0 : pool->slots().NumAlive();
}

template <EdgeType E>
int Graph::NumEdges() const {
  const EdgePool<E>* pool = Pool<E>();
  return pool == nullptr ? 0 : pool->slots().NumAlive();
}

template <VertexType V, class F>
void Graph::ForEachVertex(F&& f) const {
  const VertexPool<V>* pool = Pool<V>();
  for (int k = 0; pool != nullptr && k < pool->size(); ++k) {
    if (!pool->slots().AliveAt(k)) continue;
    f(*pool->HandleAt(k).template As<V>(), pool->At(k));
  }
}

template <EdgeType E, class F>
void Graph::ForEachEdge(F&& f) const {
  const EdgePool<E>* pool = Pool<E>();
  for (int k = 0; pool != nullptr && k < pool->size(); ++k) {
    if (!pool->Alive(k)) continue;
    const EdgeHandle<E> handle = *pool->HandleAt(k).template As<E>();
    if constexpr (std::is_invocable_v<F&, EdgeHandle<E>, const E&, const EdgeVertexHandles<E>&>) {
      f(handle, pool->At(k), pool->HandlesOf(k));
    } else {
      f(handle, pool->At(k));
    }
  }
}

}  // namespace glissade
