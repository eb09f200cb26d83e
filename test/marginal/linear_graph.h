// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "common/random_states.h"
#include "glissade/edges/concept.h"
#include "glissade/graph/graph.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/vector.h"

/// \file
/// Graphs in which everything is linear: marginalization is then exact, whatever the values are.
namespace glissade::test {

/// r = sum A_i x_i - z, with three rows.
template <class... V>
struct LinearEdge {
  using Vertices = VertexList<V...>;
  static constexpr int kResidualDim = 3;

  std::tuple<Jacobian<3, V::kTangentDim>...> A;
  Vector<3> z;

  bool Evaluate(const V&... x, Vector<3>& r, Jacobian<3, V::kTangentDim>*... J) const {
    r = -z;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((r += std::get<I>(A) * Eigen::Map<const Vector<V::kTangentDim>>(x.Data())), ...);
      ((J != nullptr ? void(*J = std::get<I>(A)) : void()), ...);
    }
    (std::index_sequence_for<V...>{});
    return true;
  }

  static LinearEdge Random(test::Random* random) {
    LinearEdge edge;
    const auto fill = [&](auto& matrix) {
      for (int k = 0; k < matrix.size(); ++k)
        matrix.data()[k] = random->Uniform(-1, 1);
    };
    std::apply([&](auto&... a) { (fill(a), ...); }, edge.A);
    fill(edge.z);
    return edge;
  }
};

using State = VertexVector<3>;
using Small = VertexVector<2>;

/// A chain of states with a small vertex each, loops, and landmarks of dimension 3 and 1.
struct LinearGraph {
  explicit LinearGraph(std::uint64_t seed) : random(seed) {
    constexpr int kStates = 6;
    for (int k = 0; k < kStates; ++k) {
      states.push_back(graph.AddVertex(State{}).value());
      smalls.push_back(graph.AddVertex(Small{}).value());
    }
    Add<State>(states[0]);
    for (std::size_t k = 0; k < kStates; ++k) {
      Add<State, Small>(states[k], smalls[k]);
      Add<Small>(smalls[k]);
      if (k > 0) Add<State, State>(states[k - 1], states[k]);
      if (k > 1) Add<State, Small, State>(states[k - 2], smalls[k - 1], states[k]);
    }
    for (std::size_t k = 0; k + 2 < kStates; ++k) {
      points.push_back(graph.AddVertex(VertexPointXYZ{}).value());
      depths.push_back(graph.AddVertex(VertexInverseDepth{}).value());
      for (std::size_t i = 0; i < 3; ++i) {
        Add<State, VertexPointXYZ>(states[k + i], points.back());
        if (i > 0) Add<State, State, VertexInverseDepth>(states[k], states[k + i], depths.back());
      }
    }
    Scatter();
  }

  /// Other values for everything: nothing may depend on them.
  void Scatter() {
    const auto scatter = [&](auto vertex) {
      auto value = graph.Get(vertex);
      for (int k = 0; k < value.kAmbientDim; ++k)
        value.Data()[k] = random.Uniform(-2, 2);
      EXPECT_TRUE(graph.Set(vertex, value).ok());
    };
    for (const auto& list : {states})
      for (const auto v : list)
        if (graph.Contains(v)) scatter(v);
    for (const auto v : smalls)
      if (graph.Contains(v)) scatter(v);
    for (const auto v : points)
      if (graph.Contains(v)) scatter(v);
    for (const auto v : depths)
      if (graph.Contains(v)) scatter(v);
  }

  template <class... V>
  void Add(VertexHandle<V>... vertices) {
    const auto added =
        graph.AddEdge(LinearEdge<V...>::Random(&random), std::make_tuple(vertices...));
    EXPECT_TRUE(added.ok()) << added.status().message();
  }

  test::Random random;
  Graph graph;
  std::vector<VertexHandle<State>> states;
  std::vector<VertexHandle<Small>> smalls;
  std::vector<VertexHandle<VertexPointXYZ>> points;
  std::vector<VertexHandle<VertexInverseDepth>> depths;
};

}  // namespace glissade::test
