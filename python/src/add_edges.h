// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "errors.h"
#include "handles.h"
#include "problem.h"
#include "weights.h"

/// \file
/// Many edges of one type at once.
namespace glissade::python {

/// Vertices that an argument gives, and its name.
struct NamedVertices {
  const VertexArray* vertices;
  const char* name;
};

/// Their number: that of the longest argument; arguments of one are for all edges. ValueError where
/// another number does not fit.
std::size_t NumEdges(std::span<const NamedVertices> arguments, std::size_t rows);
[[noreturn]] void WrongType(const NamedVertices& argument, std::string_view needed);

template <class V>
VertexHandle<V> TypedHandle(const NamedVertices& argument, std::size_t k) {
  const AnyVertex& vertex = argument.vertices->ForEach(k);
  const auto typed = vertex.As<V>();
  if (!typed) WrongType(argument, kTypeInfo<V>.name);
  return *typed;
}

template <class... V, std::size_t N>
std::tuple<VertexHandle<V>...> TypedHandles(VertexList<V...>,
                                            const std::array<NamedVertices, N>& arguments,
                                            std::size_t k) {
  static_assert(N == sizeof...(V));
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::tuple<VertexHandle<V>...>{TypedHandle<V>(arguments[I], k)...};
  }
  (std::make_index_sequence<N>());
}

inline Pose PoseFrom(const double* numbers) {
  Pose pose;
  std::memcpy(pose.data, numbers, sizeof(pose.data));
  return pose;
}
inline Vector2 Vector2From(const double* x) {
  return Vector2(x[0], x[1]);
}

/// Adds n edges make(k) with their vertices, all or nothing.
template <class E, std::size_t N, class Make>
EdgeArray AddEdges(PyProblem& p, std::size_t n, const std::array<NamedVertices, N>& arguments,
                   const Weights& weights, const Loss& loss, Make&& make) {
  std::vector<E> edges;
  std::vector<EdgeVertexHandles<E>> vertices;
  edges.reserve(n);
  vertices.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    edges.push_back(make(k));
    vertices.push_back(TypedHandles(typename E::Vertices(), arguments, k));
  }
  Problem& problem = p.write();
  EdgeOptions<E> options;
  options.loss = loss;
  const auto matrix = [&](std::size_t k) {
    SquareMatrix<E::kResidualDim> m;
    for (int i = 0; i < E::kResidualDim; ++i) {
      for (int j = 0; j < E::kResidualDim; ++j)
        m(i, j) = weights.Of(k)[i * E::kResidualDim + j];
    }
    return m;
  };
  if (!weights.is_identity() && weights.same_for_all()) {
    (weights.is_sqrt() ? options.sqrt_information : options.information) = matrix(0);
  }
  const auto added = p.Seen(problem.AddEdges<E>(
      std::span<const E>(edges), std::span<const EdgeVertexHandles<E>>(vertices), options));
  if (!weights.is_identity() && !weights.same_for_all()) {
    for (std::size_t k = 0; k < n; ++k) {
      const Status status = weights.is_sqrt() ? problem.SetSqrtInformation(added[k], matrix(k))
                                              : problem.SetInformation(added[k], matrix(k));
      if (status.ok()) continue;
      for (const auto& edge : added)
        (void)problem.RemoveEdge(edge);
      p.Seen(status);
    }
  }
  return ArrayOf<AnyEdge>(added);
}

}  // namespace glissade::python
