// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a graph refuses, and that it is then as it was: same bits, same counts, same solve.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class GraphRefusals : public ::testing::Test {
 protected:
  GraphRefusals() { window_ = AddWindow(&problem_); }

  /// Runs `call` on the problem and expects it to fail with `code`, without a trace.
  void ExpectRefused(StatusCode code, const std::function<Status(Graph&)>& call) {
    Problem untouched = problem_.Clone();
    const GraphRecord before(problem_);
    const Status status = call(problem_);
    EXPECT_EQ(status.code(), code) << status.message();
    EXPECT_FALSE(status.message().empty());
    EXPECT_TRUE(GraphRecord(problem_) == before);
    // Also what cannot be seen from outside: both go the same way, to the last bit.
    Problem touched = problem_.Clone();
    touched.AcknowledgeRefusal();
    untouched.AcknowledgeRefusal();  // of what the test did before
    const SolveSummary expected = untouched.Solve({.max_iterations = 4});
    const SolveSummary& summary = touched.Solve({.max_iterations = 4});
    EXPECT_TRUE(SameIterations(summary, expected));
    EXPECT_TRUE(SameStates(touched.GetSnapshot(), untouched.GetSnapshot()));
  }

  template <VertexType V>
  void ExpectVertexRefused(StatusCode code, const V& value) {
    ExpectRefused(code, [&](Graph& g) { return g.AddVertex(value).status(); });
    const V values[] = {V(), V(), value};
    ExpectRefused(code,
                  [&](Graph& g) { return g.AddVertices(std::span<const V>(values)).status(); });
  }

  static VertexPose PoseWith(int index, double value) {
    VertexPose pose;
    pose.pose.data[index] = value;
    return pose;
  }

  Problem problem_;
  Window window_;
};

TEST_F(GraphRefusals, VerticesThatAreNotFinite) {
  for (int k = 0; k < 7; ++k)
    ExpectVertexRefused(StatusCode::kNotFinite, PoseWith(k, k % 2 == 0 ? kNan : -kInf));
  ExpectVertexRefused(StatusCode::kNotFinite, VertexInverseDepth{kInf});
  ExpectVertexRefused(StatusCode::kNotFinite, VertexVector<3>{{0.0, 0.0, kNan}});
  ExpectVertexRefused(StatusCode::kNotFinite, Spot{{kNan, 0.0}});  // has no Validate()
  EXPECT_EQ(problem_.Set(window_.landmarks[0], VertexInverseDepth{kNan}).code(),
            StatusCode::kNotFinite);
}

TEST_F(GraphRefusals, PosesWithoutAUnitQuaternion) {
  ExpectVertexRefused(StatusCode::kInvalidArgument, PoseWith(6, 0.0));
  ExpectVertexRefused(StatusCode::kInvalidArgument, PoseWith(6, 1.001));
  ExpectVertexRefused(StatusCode::kInvalidArgument, PoseWith(3, 0.1));
  EXPECT_TRUE(problem_.AddVertex(PoseWith(6, -1.0)).ok()) << "the other sign is a unit too";
  EXPECT_TRUE(problem_.AddVertex(PoseWith(6, 1.0 + 1e-7)).ok()) << "within rounding of a file";
}

TEST_F(GraphRefusals, SetRefusesWhatAddRefuses) {
  const auto pose = window_.poses[2];
  ExpectRefused(StatusCode::kNotFinite, [&](Graph& g) { return g.Set(pose, PoseWith(1, kNan)); });
  ExpectRefused(StatusCode::kInvalidArgument,
                [&](Graph& g) { return g.Set(pose, PoseWith(6, 0.5)); });
  const Status status = problem_.Set(pose, PoseWith(6, 0.5));
  EXPECT_EQ(status.vertex(), AnyVertex(pose)) << "it names the vertex";
}

TEST_F(GraphRefusals, EdgesOnDeadOrRepeatedVertices) {
  const auto [a, b, c] = std::tuple(window_.poses[0], window_.poses[1], window_.landmarks[0]);
  const auto add = [](auto... handles) {
    return [=](Graph& g) { return g.AddEdge(EdgeReprojection(), {handles...}).status(); };
  };
  ExpectRefused(StatusCode::kUnknownHandle, add(VertexHandle<VertexPose>(), b, c));
  ExpectRefused(StatusCode::kUnknownHandle, add(a, VertexHandle<VertexPose>{77, 0}, c));
  ExpectRefused(StatusCode::kUnknownHandle, add(a, b, VertexHandle<VertexInverseDepth>()));
  ExpectRefused(StatusCode::kRepeatedVertex, add(a, a, c));
  const Status repeated = problem_.AddEdge(EdgeReprojection(), {b, b, c}).status();
  EXPECT_EQ(repeated.vertex(), AnyVertex(b));
  EXPECT_NE(repeated.message().find(ToString(b)), std::string::npos) << repeated.message();
}

TEST_F(GraphRefusals, AResultThatFailedLeadsToAnEdgeThatFails) {
  // A vertex is refused, its Result goes straight into AddEdge.
  const auto bad = problem_.AddVertex(PoseWith(0, kNan));
  ASSERT_FALSE(bad.ok());
  ExpectRefused(StatusCode::kUnknownHandle, [&](Graph& g) {
    return g.AddEdge(EdgeReprojection(), {window_.poses[0], bad, window_.landmarks[0]}).status();
  });
}

/// Between two landmarks: never allowed while both are eliminated.
struct EdgeSpotSpot {
  using Vertices = VertexList<Spot, Spot>;
  static constexpr int kResidualDim = 2;
  bool Evaluate(const Spot& x, const Spot& y, Vector2& r, Jacobian<2, 2>* J_x,
                Jacobian<2, 2>* J_y) const {
    r = Vector2(x.xy) - Vector2(y.xy);
    if (J_x) J_x->setIdentity();
    if (J_y) *J_y = -Matrix2::Identity();
    return true;
  }
};

TEST_F(GraphRefusals, EdgesBetweenEliminatedVertices) {
  const VertexHandle<Spot> a = problem_.AddVertex(Spot{{1.0, 0.0}});
  const VertexHandle<Spot> b = problem_.AddVertex(Spot{{0.0, 1.0}});
  ExpectRefused(StatusCode::kEliminatedPair, [&](Graph& g) {
    return g.AddEdge(EdgeSpotSpot(), {a, b}).status();
  });
  // Fixing one does not help: it may be let go later.
  Must(problem_.SetFixed(a));
  ExpectRefused(StatusCode::kEliminatedPair, [&](Graph& g) {
    return g.AddEdge(EdgeSpotSpot(), {a, b}).status();
  });
  Must(problem_.SetEliminated(a, false));
  const auto edge = problem_.AddEdge(EdgeSpotSpot(), {a, b});
  ASSERT_TRUE(edge.ok()) << edge.status().message();
  ExpectRefused(StatusCode::kEliminatedPair, [&](Graph& g) { return g.SetEliminated(a, true); });
  EXPECT_EQ(problem_.SetEliminated(a, true).edge(), AnyEdge(edge.value())) << "it names the edge";
  Must(problem_.SetEliminated(b, false));
  Must(problem_.SetEliminated(a, true));
  ExpectRefused(StatusCode::kEliminatedPair, [&](Graph& g) { return g.SetEliminated(b, true); });
}

TEST_F(GraphRefusals, MeasurementsThatTheirTypeRefuses) {
  const auto expect = [&](StatusCode code, auto change) {
    EdgeReprojection edge;
    change(edge);
    ExpectRefused(code, [&](Graph& g) {
      return g.AddEdge(edge, {window_.poses[0], window_.poses[1], window_.landmarks[0]}).status();
    });
  };
  expect(StatusCode::kNotFinite, [](auto& e) { e.uv_host[1] = kNan; });
  expect(StatusCode::kNotFinite, [](auto& e) { e.uv_target[0] = kInf; });
  expect(StatusCode::kNotFinite, [](auto& e) { e.T_b_c.data[2] = kNan; });
  expect(StatusCode::kInvalidArgument, [](auto& e) { e.T_b_c.data[6] = 0.9; });
}

TEST_F(GraphRefusals, LossesThatMakeNoSense) {
  const auto pose = window_.poses[0];
  const auto edge = window_.edges[0];
  for (const Loss& loss :
       {Loss(Huber{0.0}), Loss(Huber{-1.0}), Loss(Cauchy{-0.5}), Loss(Tukey{0.0})}) {
    EdgeOptions<EdgeSE3Prior> options;
    options.loss = loss;
    ExpectRefused(StatusCode::kNotPositive,
                  [&](Graph& g) { return g.AddEdge(EdgeSE3Prior(), {pose}, options).status(); });
    ExpectRefused(StatusCode::kNotPositive, [&](Graph& g) { return g.SetLoss(edge, loss); });
  }
  ExpectRefused(StatusCode::kNotFinite, [&](Graph& g) { return g.SetLoss(edge, Huber{kNan}); });
  EXPECT_EQ(problem_.SetLoss(edge, Huber{kInf}).code(), StatusCode::kNotFinite);
  EXPECT_EQ(problem_.SetLoss(edge, Huber{kInf}).edge(), AnyEdge(edge));
}

TEST_F(GraphRefusals, SpansAreAllOrNothing) {
  const std::vector<EdgeSE3Prior> good(3);
  std::vector<EdgeVertexHandles<EdgeSE3Prior>> on;
  for (int k = 2; k < 5; ++k)
    on.emplace_back(window_.poses[std::size_t(k)]);
  const auto add = [](const std::vector<EdgeSE3Prior>& edges,
                      const std::vector<EdgeVertexHandles<EdgeSE3Prior>>& vertices,
                      const EdgeOptions<EdgeSE3Prior>& options = {}) {
    return [&edges, &vertices, options](Graph& g) {
      return g
          .AddEdges(std::span<const EdgeSE3Prior>(edges),
                    std::span<const EdgeVertexHandles<EdgeSE3Prior>>(vertices), options)
          .status();
    };
  };
  std::vector<EdgeSE3Prior> last_bad = good;
  last_bad[2].T_w_b.data[0] = kNan;
  ExpectRefused(StatusCode::kNotFinite, add(last_bad, on));
  EXPECT_NE(add(last_bad, on)(problem_).message().find("edge 2"), std::string::npos);
  auto last_dead = on;
  last_dead[2] = {VertexHandle<VertexPose>()};
  ExpectRefused(StatusCode::kUnknownHandle, add(good, last_dead));
  auto too_few = on;
  too_few.pop_back();
  ExpectRefused(StatusCode::kInvalidArgument, add(good, too_few));
  EdgeOptions<EdgeSE3Prior> bad_options;
  bad_options.information = -Matrix6::Identity();
  ExpectRefused(StatusCode::kNotPositive, add(good, on, bad_options));

  const int before = problem_.NumEdges();
  const auto handles = problem_.AddEdges(std::span<const EdgeSE3Prior>(good),
                                         std::span<const EdgeVertexHandles<EdgeSE3Prior>>(on));
  ASSERT_TRUE(handles.ok());
  ASSERT_EQ(handles->size(), 3u);
  EXPECT_EQ(problem_.NumEdges(), before + 3);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(problem_.VerticesOf((*handles)[k]).value(),
              std::vector<AnyVertex>{AnyVertex(window_.poses[k + 2])});
  }
  const std::vector<VertexInverseDepth> depths = {{0.1}, {0.2}};
  const auto added = problem_.AddVertices(std::span<const VertexInverseDepth>(depths));
  ASSERT_TRUE(added.ok());
  EXPECT_EQ(problem_.Get((*added)[0]).rho, 0.1);
  EXPECT_EQ(problem_.Get((*added)[1]).rho, 0.2);
}

TEST_F(GraphRefusals, PartialFixingOfWhatIsNoPose) {
  const auto landmark = window_.landmarks[0];
  for (const Fix fix : {Fix::kPosition, Fix::kPositionAndYaw}) {
    ExpectRefused(StatusCode::kInvalidArgument,
                  [&](Graph& g) { return g.SetFixed(landmark, fix); });
  }
  const auto pose = window_.poses[1];
  ExpectRefused(StatusCode::kInvalidArgument,
                [&](Graph& g) { return g.SetEliminated(pose, true); });
}

TEST_F(GraphRefusals, SnapshotsThatDoNotFit) {
  const Snapshot snapshot = problem_.GetSnapshot();
  Snapshot cut = snapshot;
  cut.states.pop_back();
  ExpectRefused(StatusCode::kInvalidArgument, [&](Graph& g) { return g.RestoreSnapshot(cut); });
  Snapshot poisoned = snapshot;
  poisoned.states[9] = kNan;
  ExpectRefused(StatusCode::kNotFinite, [&](Graph& g) { return g.RestoreSnapshot(poisoned); });
  Snapshot fewer = snapshot;
  fewer.vertices.pop_back();
  ExpectRefused(StatusCode::kInvalidArgument, [&](Graph& g) { return g.RestoreSnapshot(fewer); });
  Must(problem_.AddVertex(VertexInverseDepth{0.5}));
  ExpectRefused(StatusCode::kInvalidArgument,
                [&](Graph& g) { return g.RestoreSnapshot(snapshot); });
}

}  // namespace
}  // namespace glissade::test
