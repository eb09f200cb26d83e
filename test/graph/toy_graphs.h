// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/glissade.h"

/// \file
/// Small graphs that tests build themselves, where every number is in the test's hands.
namespace glissade::test {

/// The value of a Result that must be there.
template <class T>
T Must(const Result<T>& result) {
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.value();
}
inline void Must(const Status& status) {
  EXPECT_TRUE(status.ok()) << status.message();
}

/// A user's landmark: two plain numbers that are eliminated.
struct Spot {
  static constexpr int kAmbientDim = 2;
  static constexpr int kTangentDim = 2;
  static constexpr bool kEliminated = true;
  double xy[2] = {0.0, 0.0};
  double* Data() { return xy; }
  const double* Data() const { return xy; }
  void Plus(const double* delta) {
    xy[0] += delta[0];
    xy[1] += delta[1];
  }
  void Minus(const Spot& x0, double* delta) const {
    delta[0] = xy[0] - x0.xy[0];
    delta[1] = xy[1] - x0.xy[1];
  }
};

/// r = A x + B y - c: linear, between a kept vertex and a landmark.
struct EdgeLinearSpot {
  using Vertices = VertexList<VertexVector<3>, Spot>;
  static constexpr int kResidualDim = 4;
  Matrix<4, 3> A = Matrix<4, 3>::Zero();
  Matrix<4, 2> B = Matrix<4, 2>::Zero();
  Vector<4> c = Vector<4>::Zero();

  bool Evaluate(const VertexVector<3>& x, const Spot& y, Vector<4>& r, Jacobian<4, 3>* d_r_d_x,
                Jacobian<4, 2>* d_r_d_y) const {
    r = A * Vector3(x.value.data()) + B * Vector2(y.xy) - c;
    if (d_r_d_x) *d_r_d_x = A;
    if (d_r_d_y) *d_r_d_y = B;
    return true;
  }
};

/// r = A x + B y - c between two kept vertices.
struct EdgeLinearPair {
  using Vertices = VertexList<VertexVector<3>, VertexVector<3>>;
  static constexpr int kResidualDim = 3;
  Matrix3 A = Matrix3::Identity();
  Matrix3 B = Matrix3::Zero();
  Vector3 c = Vector3::Zero();

  bool Evaluate(const VertexVector<3>& x, const VertexVector<3>& y, Vector3& r,
                Jacobian<3, 3>* d_r_d_x, Jacobian<3, 3>* d_r_d_y) const {
    r = A * Vector3(x.value.data()) + B * Vector3(y.value.data()) - c;
    if (d_r_d_x) *d_r_d_x = A;
    if (d_r_d_y) *d_r_d_y = B;
    return true;
  }
};

/// A linear graph without free directions: `kept` vertices in a chain with an edge to each of
/// `spots` landmarks.
inline Graph MakeLinearGraph(int kept, int spots, std::uint64_t seed) {
  Random random(seed);
  Graph graph;
  const auto fill = [&](auto&& matrix) {
    for (int k = 0; k < matrix.size(); ++k)
      matrix.data()[k] = random.Uniform(-1.0, 1.0);
  };
  std::vector<VertexHandle<VertexVector<3>>> x;
  for (int k = 0; k < kept; ++k) {
    VertexVector<3> value;
    for (double& v : value.value)
      v = random.Uniform(-1.0, 1.0);
    x.push_back(graph.AddVertex(value));
  }
  for (int k = 0; k < kept; ++k) {
    EdgeLinearPair edge;
    fill(edge.B);
    fill(edge.c);
    if (kept > 1) Must(graph.AddEdge(edge, {x[std::size_t(k)], x[std::size_t((k + 1) % kept)]}));
  }
  for (int s = 0; s < spots; ++s) {
    const VertexHandle<Spot> y =
        graph.AddVertex(Spot{{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0)}});
    for (int k = 0; k < kept; ++k) {
      EdgeLinearSpot edge;
      fill(edge.A);
      fill(edge.B);
      fill(edge.c);
      Must(graph.AddEdge(edge, {x[std::size_t(k)], y}));
    }
  }
  return graph;
}

struct WindowOptions {
  int frames = 5;
  int landmarks = 30;
  int track = 3;  ///< observations of a landmark beside its host's
  std::uint64_t seed = 1;
  double start_noise = 0.02;
  double pixel_noise = 1e-3;
  Loss loss = {};
  bool prior = true;  ///< on the first two poses
};

struct Window {
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexInverseDepth>> landmarks;
  std::vector<EdgeHandle<EdgeReprojection>> edges;
  std::vector<EdgeHandle<EdgeSE3Prior>> priors;
};

/// Adds a monocular window: cameras along a line, inverse-depth landmarks seen from the frames
/// that follow their host.
inline Window AddWindow(Graph* graph, const WindowOptions& options = {}) {
  Random random(options.seed);
  Window window;
  std::vector<Pose> truth;
  for (int k = 0; k < options.frames; ++k) {
    const Pose T_w_b(random.Rotation(0.05), Vector3(0.4 * k, 0.0, 0.0) + random.Vec3(0.05));
    truth.push_back(T_w_b);
    VertexPose start{T_w_b};
    if (k > 0) start.pose = T_w_b * random.RandomPose(options.start_noise, options.start_noise);
    start.pose.Normalize();
    window.poses.push_back(graph->AddVertex(start));
  }
  for (int l = 0; l < options.landmarks; ++l) {
    const auto host = std::size_t(l % options.frames);
    const Vector2 uv = random.Vec2(0.4);
    const double rho = 1.0 / random.Uniform(3.0, 8.0);
    const auto landmark = graph->AddVertex(
        VertexInverseDepth{rho * (1.0 + random.Uniform(-5.0, 5.0) * options.start_noise)});
    window.landmarks.push_back(landmark);
    for (int t = 1; t <= options.track && t < options.frames; ++t) {
      const auto target = (host + std::size_t(t)) % std::size_t(options.frames);
      const Vector3 p =
          truth[target].Inverse() * (truth[host] * Vector3(uv[0] / rho, uv[1] / rho, 1.0 / rho));
      EdgeReprojection edge;
      edge.uv_host = uv;
      edge.uv_target = Vector2(p[0] / p[2], p[1] / p[2]) + random.Vec2(options.pixel_noise);
      EdgeOptions<EdgeReprojection> weight;
      weight.sqrt_information = 460.0 * Matrix2::Identity();
      weight.loss = options.loss;
      window.edges.push_back(
          graph->AddEdge(edge, {window.poses[host], window.poses[target], landmark}, weight));
    }
  }
  for (std::size_t k = 0; options.prior && k < 2 && k < truth.size(); ++k) {
    EdgeOptions<EdgeSE3Prior> weight;
    weight.sqrt_information = 100.0 * Matrix6::Identity();
    window.priors.push_back(graph->AddEdge(EdgeSE3Prior{truth[k]}, {window.poses[k]}, weight));
  }
  return window;
}

/// All states as bits: what "unchanged" and "the same" mean here.
inline bool SameStates(const Snapshot& a, const Snapshot& b) {
  // memcmp must not be given the null of an empty vector.
  return a.states.size() == b.states.size() &&
         (a.states.empty() ||
          std::memcmp(a.states.data(), b.states.data(), a.states.size() * sizeof(double)) == 0);
}
inline bool SameBits(const Snapshot& a, const Snapshot& b) {
  return a.vertices == b.vertices && SameStates(a, b);
}

/// Costs, gradients, steps and lambdas of every iteration: equal to the last bit?
inline ::testing::AssertionResult SameIterations(const SolveSummary& a, const SolveSummary& b) {
  if (a.iterations.size() != b.iterations.size()) {
    return ::testing::AssertionFailure()
           << a.iterations.size() << " and " << b.iterations.size() << " iterations";
  }
  for (std::size_t k = 0; k < a.iterations.size(); ++k) {
    const IterationSummary &x = a.iterations[k], &y = b.iterations[k];
    const double u[] = {x.cost, x.cost_change, x.gradient_max, x.step_norm, x.gain_ratio, x.lambda};
    const double v[] = {y.cost, y.cost_change, y.gradient_max, y.step_norm, y.gain_ratio, y.lambda};
    if (x.accepted != y.accepted || std::memcmp(u, v, sizeof(u)) != 0) {
      return ::testing::AssertionFailure() << "iteration " << k << " differs:\n"
                                           << ToString(x) << "\n"
                                           << ToString(y);
    }
  }
  return ::testing::AssertionSuccess();
}

/// Everything observable of a graph from outside, to show that a refused call changed nothing.
struct GraphRecord {
  explicit GraphRecord(const Graph& graph)
      : snapshot(graph.GetSnapshot()),
        edges(graph.Edges()),
        chi2(graph.Chi2().value()),
        cost(graph.Cost().value()),
        version(graph.structure_version()) {
    for (const AnyVertex& vertex : snapshot.vertices)
      fixes.push_back(graph.GetFixed(vertex));
  }
  friend bool operator==(const GraphRecord& a, const GraphRecord& b) {
    return SameBits(a.snapshot, b.snapshot) && a.edges == b.edges && a.chi2 == b.chi2 &&
           a.cost == b.cost && a.version == b.version && a.fixes == b.fixes;
  }

  Snapshot snapshot;
  std::vector<AnyEdge> edges;
  double chi2, cost;
  std::uint64_t version;
  std::vector<Fix> fixes;
};

}  // namespace glissade::test
