// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Templates of Graph. Included by graph.h only.

#include <tuple>

#include "glissade/graph/graph.h"

namespace glissade {

namespace internal {

/// Prefixes a status with what it is about; ok stays ok.
Status About(const Status& status, std::string_view subject);

}  // namespace internal

template <class V>
Graph::NewVertices Graph::NewVerticesOf(std::span<const V> values, VertexHandle<V>* handles) {
  return {&kVertexOps<V>, values.data(), values.size(), handles,
          [](void* all, std::size_t k, const AnyVertex& handle) {
            static_cast<VertexHandle<V>*>(all)[k] = {handle.slot, handle.generation, handle.graph};
          }};
}

template <class V>
Result<VertexHandle<V>> Graph::AddVertex(const V& value) {
  if constexpr (!VertexType<V>) {
    internal::ExplainVertex<V>();
    return Status();
  } else {
    VertexHandle<V> handle;
    Status status = AddNewVertex(NewVerticesOf<V>({&value, 1}, &handle));
    if (!status.ok()) return status;
    return handle;
  }
}

template <VertexType V>
Result<std::vector<VertexHandle<V>>> Graph::AddVertices(std::span<const V> values) {
  std::vector<VertexHandle<V>> handles(values.size());
  Status status = AddNewVertices(NewVerticesOf<V>(values, handles.data()));
  if (!status.ok()) return status;
  return handles;
}

template <EdgeType E, class Unit, class Handles>
Graph::NewEdges Graph::NewEdgesOf(const EdgeOptions<E>& options, const Handles* vertices,
                                  EdgeHandle<E>* handles) {
  NewEdges edges;
  edges.ops = &internal::EdgeOpsOf<E>::kOps;
  edges.evaluate_lanes = internal::UnitEvaluator<E, Unit>();
  edges.weight = internal::WeightOf(options);
  edges.loss = &options.loss;
  edges.vertices = vertices;
  edges.vertices_of = [](const void* all, std::size_t k, AnyVertex* out) {
    std::apply([&](const auto&... handle) { ((*out++ = AnyVertex(handle)), ...); },
               static_cast<const Handles*>(all)[k]);
  };
  edges.handles = handles;
  edges.put_handle = [](void* all, std::size_t k, const AnyEdge& handle) {
    static_cast<EdgeHandle<E>*>(all)[k] = {handle.slot, handle.generation, handle.graph};
  };
  return edges;
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
    EdgeHandle<E> handle;
    NewEdges edges = NewEdgesOf<E, Unit>(options, &vertices.handles(), &handle);
    edges.edges = &edge;
    edges.count = 1;
    if (Status status = AddNewEdge(edges); !status.ok()) return status;
    return handle;
  }
}

template <EdgeType E, class Unit>
Result<std::vector<EdgeHandle<E>>> Graph::AddEdges(std::span<const E> edges,
                                                   std::span<const EdgeVertexHandles<E>> vertices,
                                                   const EdgeOptions<E>& options) {
  if (edges.size() != vertices.size()) {
    return Refused({StatusCode::kInvalidArgument, "as many vertex tuples as edges are needed"});
  }
  std::vector<EdgeHandle<E>> handles(edges.size());
  NewEdges added = NewEdgesOf<E, Unit>(options, vertices.data(), handles.data());
  added.edges = edges.data();
  added.count = edges.size();
  if (Status status = AddNewEdges(added); !status.ok()) return status;
  return handles;
}

template <VertexType V>
const V* Graph::Find(VertexHandle<V> vertex) const {
  return static_cast<const V*>(FindValue(AnyVertex(vertex)));
}

template <EdgeType E>
const E* Graph::Find(EdgeHandle<E> edge) const {
  return static_cast<const E*>(FindValue(AnyEdge(edge)));
}

template <VertexType V>
const V& Graph::Get(VertexHandle<V> vertex) const {
  static const V kDead{};
  const V* value = Find(vertex);
  return value != nullptr ? *value : kDead;
}

template <VertexType V>
Status Graph::Set(VertexHandle<V> vertex, const V& value) {
  return SetValue(AnyVertex(vertex), &value);
}

template <EdgeType E>
Status Graph::SetSqrtInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& sqrt) {
  return SetWeight(edge, {.sqrt_information = sqrt.data()});
}

template <EdgeType E>
Status Graph::SetInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& information) {
  return SetWeight(edge, {.information = information.data()});
}

template <VertexType V>
int Graph::NumVertices() const {
  return NumVerticesOf(&kTypeInfo<V>);
}

template <EdgeType E>
int Graph::NumEdges() const {
  return NumEdgesOf(&kTypeInfo<E>);
}

template <VertexType V, class F>
void Graph::ForEachVertex(F&& f) const {
  int index = 0;
  AnyVertex handle;
  while (const void* value = NextVertex(&kTypeInfo<V>, &index, &handle)) {
    f(VertexHandle<V>{handle.slot, handle.generation, handle.graph}, *static_cast<const V*>(value));
  }
}

template <EdgeType E, class F>
void Graph::ForEachEdge(F&& f) const {
  constexpr bool kWithVertices =
      std::is_invocable_v<F&, EdgeHandle<E>, const E&, const EdgeVertexHandles<E>&>;
  int index = 0;
  AnyEdge any;
  AnyVertex vertices[E::Vertices::kSize];
  while (const void* value =
             NextEdge(&kTypeInfo<E>, &index, &any, kWithVertices ? vertices : nullptr)) {
    const EdgeHandle<E> handle{any.slot, any.generation, any.graph};
    const E& edge = *static_cast<const E*>(value);
    if constexpr (kWithVertices) {
      EdgeVertexHandles<E> handles;
      ForEachIndex<E::Vertices::kSize>([&](auto i) {
        std::get<i>(handles) = {vertices[i].slot, vertices[i].generation, vertices[i].graph};
      });
      f(handle, edge, handles);
    } else {
      f(handle, edge);
    }
  }
}

}  // namespace glissade
