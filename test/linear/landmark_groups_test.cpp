// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks in groups whatever their edges are: users' own in all forms, the library's, several
// types on one landmark, with first estimates away from the states.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "linear/both_paths.h"
#include "linear/pose_row.h"
#include "support/two_view_edges.h"

namespace glissade {
namespace {

using test::kLeftCamera;
using test::kRightCamera;
using test::ReprojectionInPacks;
using test::ReprojectionOneByOne;
using test::ReprojectionResidual;

enum class Kind { kOneByOne, kInPacks, kResidual, kBuiltIn, kPinhole, kStereo, kMixed };

std::string Name(Kind kind) {
  constexpr const char* kNames[] = {"OneByOne", "InPacks", "Residual", "BuiltIn",
                                    "Pinhole",  "Stereo",  "Mixed"};
  return kNames[static_cast<int>(kind)];
}

class Builder {
 public:
  explicit Builder(std::uint64_t seed) : random_(seed) {}

  /// Frames in a row; each landmark is seen by those after its host, in a random order.
  Graph Build(Kind kind, int num_poses, int num_landmarks, bool first_estimates) {
    poses_ = test::AddPoseRow(num_poses, Vector3::Zero(), &random_, &graph_);
    for (int l = 0; l < num_landmarks; ++l)
      AddLandmark(kind, static_cast<std::size_t>(l) % (poses_.size() - 1));
    if (first_estimates) test::MoveFirstEstimates(poses_, &random_, &graph_);
    return std::move(graph_);
  }

 private:
  template <class E>
  void Add(E edge, std::size_t host, std::size_t target, VertexHandle<VertexInverseDepth> depth,
           double scale = 1.0) {
    EdgeOptions<E> options;
    Matrix2 L = 200.0 / scale * Matrix2::Identity();
    if (random_.Uniform(0.0, 1.0) < 0.2) L(0, 1) = 20.0 / scale;
    options.sqrt_information = L;
    const double loss = random_.Uniform(0.0, 1.0);
    if (loss < 0.2) options.loss = Huber{1.0};
    if (loss > 0.9) options.loss = Cauchy{2.0};
    EXPECT_TRUE(graph_.AddEdge(edge, {poses_[host], poses_[target], depth}, options).ok());
  }

  void AddLandmark(Kind kind, std::size_t host) {
    const VertexHandle<VertexInverseDepth> depth =
        graph_.AddVertex(VertexInverseDepth{random_.Uniform(0.1, 0.4)});
    EdgeReprojection edge;
    edge.uv_host = random_.Vec2(0.3);
    edge.T_b_c = kLeftCamera;
    if (kind == Kind::kStereo || kind == Kind::kMixed) {
      // Also in the host itself: an edge on the landmark alone.
      EdgeReprojectionStereoSame same;
      same.uv_host = edge.uv_host;
      same.T_b_host = kLeftCamera;
      same.T_b_target = kRightCamera;
      same.uv_target = edge.uv_host + random_.Vec2(0.01);
      EdgeOptions<EdgeReprojectionStereoSame> options;
      options.sqrt_information = Matrix2(200.0 * Matrix2::Identity());
      EXPECT_TRUE(graph_.AddEdge(same, {depth}, options).ok());
    }
    for (std::size_t target = 0; target < poses_.size(); ++target) {
      if (target == host || random_.Uniform(0.0, 1.0) < 0.3) continue;
      Vector2 seen = Vector2::Zero();
      if (!edge.Evaluate(graph_.Get(poses_[host]), graph_.Get(poses_[target]), graph_.Get(depth),
                         seen, nullptr, nullptr, nullptr)) {
        continue;
      }
      edge.uv_target = seen + random_.Vec2(0.005);
      Kind one = kind;
      if (kind == Kind::kMixed) one = static_cast<Kind>(int(random_.Uniform(0.0, 6.0)));
      AddOne(one, edge, host, target, depth);
    }
  }
  void AddOne(Kind kind, const EdgeReprojection& edge, std::size_t host, std::size_t target,
              VertexHandle<VertexInverseDepth> depth) {
    switch (kind) {
      case Kind::kOneByOne:
        return Add(test::CopyOf<ReprojectionOneByOne>(edge), host, target, depth);
      case Kind::kInPacks:
        return Add(test::CopyOf<ReprojectionInPacks>(edge), host, target, depth);
      case Kind::kResidual:
        return Add(test::CopyOf<ReprojectionResidual>(edge), host, target, depth);
      case Kind::kPinhole: {
        EdgeReprojectionOf<CameraPinhole> pinhole;
        pinhole.camera = CameraPinhole{400.0, 410.0, 320.0, 240.0};
        pinhole.uv_host = edge.uv_host;
        pinhole.T_b_c = edge.T_b_c;
        pinhole.uv_target =
            Vector2(400.0 * edge.uv_target[0] + 320.0, 410.0 * edge.uv_target[1] + 240.0);
        return Add(pinhole, host, target, depth, 400.0);
      }
      case Kind::kStereo: {
        EdgeReprojectionStereo stereo;
        stereo.uv_host = edge.uv_host;
        stereo.uv_target = edge.uv_target;
        stereo.T_b_host = kLeftCamera;
        stereo.T_b_target = random_.Uniform(0.0, 1.0) < 0.5 ? kLeftCamera : kRightCamera;
        return Add(stereo, host, target, depth);
      }
      default:
        return Add(edge, host, target, depth);
    }
  }

  test::Random random_;
  Graph graph_;
  std::vector<VertexHandle<VertexPose>> poses_;
};

class LandmarkGroups : public testing::TestWithParam<Kind> {};

TEST_P(LandmarkGroups, AreTheSameSystemAsOneByOne) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const FirstEstimates mode :
         {FirstEstimates::kFull, FirstEstimates::kPriorOnly, FirstEstimates::kOff}) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Graph graph = Builder(seed).Build(GetParam(), 7, 60, true);
      ASSERT_TRUE(graph.SetFirstEstimates(mode).ok());
      const DampingTerm damping{.lambda = 0.1};
      test::PathOutcome groups(&graph, true, damping), single(&graph, false, damping);
      EXPECT_EQ(groups.structure.groups().num_landmarks, 60);
      EXPECT_TRUE(groups.structure.landmarks().empty());
      test::ExpectSame(&groups, single, 1e-10);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(LandmarkGroups, ThreadsChangeNoBit) {
  const Graph graph = Builder(9).Build(GetParam(), 12, 600, true);
  test::ExpectThreadsChangeNoBit(graph);
}

INSTANTIATE_TEST_SUITE_P(Kinds, LandmarkGroups,
                         testing::Values(Kind::kOneByOne, Kind::kInPacks, Kind::kResidual,
                                         Kind::kBuiltIn, Kind::kPinhole, Kind::kStereo,
                                         Kind::kMixed),
                         [](const auto& param) { return Name(param.param); });

/// A stereo edge of a user's that says what the library's says of itself; with another camera in
/// each, and fewer of them than a block has lanes.
struct StereoOfAUser {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;
  EdgeReprojectionStereo edge;

  [[nodiscard]] TwoViewObservation TwoView() const { return edge.TwoView(); }
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_host, Jacobian<2, 6>* d_target,
                Jacobian<2, 1>* d_rho) const {
    return edge.Evaluate(host, target, depth, r, d_host, d_target, d_rho);
  }
};

TEST(LandmarkGroups, TwoViewsOfAUserAreEvaluatedByHisEdgeOnceEach) {
  Graph graph;
  const auto host = graph.AddVertex(VertexPose{});
  const auto target = graph.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(1, 0, 0))});
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{Pose()}, {host}).ok());
  for (int k = 0; k < 5; ++k) {
    StereoOfAUser own;
    own.edge.uv_host = Vector2(0.02 * k, -0.1);
    own.edge.uv_target = Vector2(-0.2 + 0.02 * k, -0.11);
    own.edge.T_b_target.p() = Vector3(0.1 * k, 0.0, 0.0);
    ASSERT_TRUE(graph.AddEdge(own, {host, target, graph.AddVertex(VertexInverseDepth{0.2})}).ok());
  }
  const DampingTerm damping{.lambda = 0.1};
  test::PathOutcome groups(&graph, true, damping), single(&graph, false, damping);
  EXPECT_EQ(groups.structure.groups().num_landmarks, 5);
  test::ExpectSame(&groups, single, 1e-10);
}

// Each edge has a sensor of its own: neither lanes nor time may grow with the square of them.
TEST(LandmarkGroups, SensorsWithoutEndTakeABlockEach) {
  Graph graph;
  const auto host = graph.AddVertex(VertexPose{});
  const auto target = graph.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(1, 0, 0))});
  constexpr int kCount = 2000;
  for (int k = 0; k < kCount; ++k) {
    EdgeReprojection edge;
    edge.T_b_c.p() = Vector3(1e-3 * k, 0.0, 0.0);
    edge.uv_target = Vector2(-0.2, 0.0);
    ASSERT_TRUE(graph.AddEdge(edge, {host, target, graph.AddVertex(VertexInverseDepth{0.2})}).ok());
  }
  Structure structure;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.groups().num_landmarks, kCount);
  EXPECT_EQ(structure.groups().edge_of_slot.size(), std::size_t{kCount * 8});
}

// A solve that fails before it evaluates anything says nothing of edges, least of all those of the
// solve before.
TEST(SolveSummaryEdges, AreThoseOfThisSolve) {
  Problem problem;
  const auto host = problem.AddVertex(VertexPose{});
  const auto target = problem.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(1, 0, 0))});
  const auto depth = problem.AddVertex(VertexInverseDepth{0.2});
  const EdgeReprojection edge{{0.0, 0.0}, {-0.2, 0.0}, Pose()};
  const auto added = problem.AddEdge(edge, {host, target, depth});
  ASSERT_EQ(problem.Solve().edges.size(), 1u);
  EXPECT_EQ(problem.Solve().edges[0].as_twists, 1);
  SolveOptions bad;
  bad.max_iterations = -5;
  EXPECT_TRUE(problem.Solve(bad).edges.empty());
  // Another type and an observation that is there twice: the analysis ends early.
  ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior{Pose()}, {host}).ok());
  ASSERT_TRUE(problem.AddEdge(edge, {host, target, depth}).ok());
  const SolveSummary& failed = problem.Solve();
  EXPECT_EQ(failed.status.code(), StatusCode::kDuplicate);
  EXPECT_TRUE(failed.edges.empty());
  static_cast<void>(added);
}

}  // namespace
}  // namespace glissade
