// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Far from the world's origin, and far from each other: twists are taken about one
// point and must not lose digits to the distance from it (LandmarkPlan::kMaxReach).

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/glissade.h"
#include "linear/both_paths.h"

namespace glissade {
namespace {

/// To 2^-12 m, so that 1e8 m and it make an exact sum.
Vector3 Rounded(const Vector3& p) {
  return {std::round(p[0] * 4096.0) / 4096.0, std::round(p[1] * 4096.0) / 4096.0,
          std::round(p[2] * 4096.0) / 4096.0};
}

/// Clusters of poses with landmarks of their own. The observations are the same to the bit wherever
/// the clusters are.
class Clusters {
 public:
  explicit Clusters(std::uint64_t seed) : random_(seed) {}

  struct Cluster {
    std::vector<VertexHandle<VertexPose>> poses;
    std::vector<VertexPose> local;  ///< as they are at the origin
  };

  Cluster AddPoses(const Vector3& shift, int count) {
    Cluster cluster;
    for (int k = 0; k < count; ++k) {
      const Vector3 p = Rounded(Vector3(0.4 * k, 0.0, 0.0) + random_.Vec3(0.1));
      const Quaternion q = so3::ExpQuaternion(random_.Vec3(0.1));
      cluster.local.push_back(VertexPose{Pose(q, p)});
      cluster.poses.push_back(AddPose(Pose(q, p + shift)));
    }
    return cluster;
  }
  void AddLandmarks(const Cluster& of, int count) {
    for (int l = 0; l < count; ++l) {
      const std::size_t host = static_cast<std::size_t>(l) % of.poses.size();
      const VertexHandle<VertexInverseDepth> depth =
          graph.AddVertex(VertexInverseDepth{random_.Uniform(0.1, 0.4)});
      const Vector2 uv = random_.Vec2(0.3);
      for (std::size_t target = 0; target < of.poses.size(); ++target) {
        if (target == host) continue;
        Observe(of.poses[host], of.local[host], of.poses[target], of.local[target], depth, uv);
      }
    }
  }

  /// A pose on its own that hosts landmarks which the cluster sees, and sees some of the cluster's.
  VertexHandle<VertexPose> AddWild(const Cluster& others, const Vector3& p) {
    const VertexHandle<VertexPose> wild = AddPose(Pose(Quaternion::Identity(), p));
    for (std::size_t l = 0; l < 8; ++l) {
      const bool hosts = l % 2 == 0;
      const VertexHandle<VertexPose> other = others.poses[l % others.poses.size()];
      const VertexHandle<VertexPose> third = others.poses[(l + 1) % others.poses.size()];
      const VertexHandle<VertexInverseDepth> depth = graph.AddVertex(VertexInverseDepth{0.2});
      const VertexHandle<VertexPose> host = hosts ? wild : other, target = hosts ? other : wild;
      const Vector2 uv = random_.Vec2(0.3);
      Observe(host, graph.Get(host), target, graph.Get(target), depth, uv);
      Observe(host, graph.Get(host), third, graph.Get(third), depth, uv);
    }
    return wild;
  }

  /// Everything a little off.
  void Shake() {
    for (const VertexHandle<VertexPose> pose : poses_) {
      Pose x = graph.Get(pose).pose;
      x.p() += Rounded(random_.Vec3(0.02));
      x.q() = Quaternion(x.q() * so3::ExpQuaternion(random_.Vec3(0.01)));
      x.Normalize();
      EXPECT_TRUE(graph.Set(pose, VertexPose{x}).ok());
    }
  }

  Graph graph;

 private:
  VertexHandle<VertexPose> AddPose(const Pose& pose) {
    const VertexHandle<VertexPose> handle = graph.AddVertex(VertexPose{pose});
    poses_.push_back(handle);
    EdgeOptions<EdgeSE3Prior> prior;
    prior.sqrt_information = SquareMatrix<6>(20.0 * SquareMatrix<6>::Identity());
    Pose mean = pose;
    mean.p() += Rounded(random_.Vec3(0.02));
    EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{mean}, {handle}, prior).ok());
    return handle;
  }
  /// The observation is predicted from the local poses.
  void Observe(VertexHandle<VertexPose> host, const VertexPose& host_at,
               VertexHandle<VertexPose> target, const VertexPose& target_at,
               VertexHandle<VertexInverseDepth> depth, const Vector2& uv) {
    EdgeReprojection edge;
    edge.uv_host = uv;
    edge.T_b_c = Pose(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 0.05, -0.02));
    Vector2 predicted = Vector2::Zero();
    EXPECT_TRUE(
        edge.Evaluate(host_at, target_at, graph.Get(depth), predicted, nullptr, nullptr, nullptr));
    edge.uv_target = predicted + random_.Vec2(0.003);
    EdgeOptions<EdgeReprojection> options;
    options.sqrt_information = Matrix2(460.0 * Matrix2::Identity());
    options.loss = Huber{3.0};
    EXPECT_TRUE(graph.AddEdge(edge, {host, target, depth}, options).ok());
  }

  test::Random random_;
  std::vector<VertexHandle<VertexPose>> poses_;
};

Graph TwoClusters(double distance, double from_origin, std::uint64_t seed) {
  Clusters clusters(seed);
  const Vector3 o(from_origin, -from_origin, from_origin);
  // The small one first: not even the first pose is where most landmarks are.
  clusters.AddLandmarks(clusters.AddPoses(o + Vector3(distance, distance, -distance), 3), 9);
  clusters.AddLandmarks(clusters.AddPoses(o, 5), 40);
  clusters.Shake();
  return std::move(clusters.graph);
}

SolveOptions ToTheEnd() {
  SolveOptions options;
  options.step_tolerance = 0.0;  // what is asked here is what the linear system is worth
  options.cost_tolerance = 1e-11;
  options.max_iterations = 40;
  return options;
}

void ExpectSameAsOneByOne(Graph* graph, double tolerance) {
  const DampingTerm damping{.lambda = 1e-3};
  test::PathOutcome groups(graph, true, damping), single(graph, false, damping);
  EXPECT_GT(groups.structure.groups().num_landmarks, 0);
  test::ExpectSame(&groups, single, tolerance);
}

/// The graph solved against the same scene at the origin.
void ExpectSameSolution(Graph graph, const Graph& at_origin, double tolerance) {
  Problem here(std::move(graph)), there(at_origin.Clone());
  const SolveSummary a = here.Solve(ToTheEnd());
  const SolveSummary b = there.Solve(ToTheEnd());
  ASSERT_TRUE(a.status.ok()) << a.status.message();
  ASSERT_TRUE(b.status.ok()) << b.status.message();
  EXPECT_NEAR(a.initial_cost, b.initial_cost, tolerance * b.initial_cost);
  EXPECT_NEAR(a.final_cost, b.final_cost, tolerance * b.final_cost);
  EXPECT_NEAR(a.final_cost, here.Cost().value(), 1e-12 * a.final_cost);
  // As good as Newton's steps are: no step more for the distance.
  EXPECT_LE(a.iterations.size(), b.iterations.size() + 2);
}

TEST(LandmarkReach, WorldFarFromTheOrigin) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Graph at_origin = TwoClusters(8.0, 0.0, seed);
    for (const double far : {0.0, 1e3, 1e6, 1e7, 1e8}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " at " + std::to_string(far));
      Graph graph = TwoClusters(8.0, far, seed);
      ExpectSameAsOneByOne(&graph, 1e-10);
      ExpectSameSolution(graph.Clone(), at_origin, 1e-10 + 1e-16 * far);
    }
  }
}

TEST(LandmarkReach, ClustersFarFromEachOther) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Graph at_origin = TwoClusters(8.0, 0.0, seed);
    for (const double distance : {0.0, 1e3, 1e6, 1e7, 1e8}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", distance " + std::to_string(distance));
      Graph graph = TwoClusters(distance, 0.0, seed);
      // At the rule's limit there are nine digits.
      ExpectSameAsOneByOne(&graph, distance == 1e3 ? 2e-9 : 1e-10);
      ExpectSameSolution(graph.Clone(), at_origin, 1e-10 + 1e-16 * distance);
      // Most landmarks do not pay for the few.
      Structure structure;
      ASSERT_TRUE(structure.Analyze(&graph).ok());
      EXPECT_EQ(structure.groups().num_landmarks, distance > 1e4 ? 40 : 49);
    }
  }
}

TEST(LandmarkReach, OnePoseFarAway) {
  for (const double distance : {1e3, 1e6, 1e8, 1e10}) {
    SCOPED_TRACE("distance " + std::to_string(distance));
    Clusters clusters(7);
    const Clusters::Cluster cluster = clusters.AddPoses(Vector3::Zero(), 5);
    clusters.AddWild(cluster, Vector3(0.3 * distance, -0.2 * distance, -distance));
    clusters.AddLandmarks(cluster, 40);
    clusters.Shake();
    ExpectSameAsOneByOne(&clusters.graph, 1e-9);
    Problem problem(clusters.graph.Clone());
    const SolveSummary a = problem.Solve(ToTheEnd());
    ASSERT_TRUE(a.status.ok()) << a.status.message();
    EXPECT_NEAR(a.final_cost, problem.Cost().value(), 1e-12 * a.final_cost);
  }
}

TEST(LandmarkReach, PosesThatGoFarAfterTheAnalysis) {
  Clusters clusters(3);
  const Clusters::Cluster cluster = clusters.AddPoses(Vector3::Zero(), 5);
  const VertexHandle<VertexPose> wild = clusters.AddWild(cluster, Vector3(1.0, 0.0, -2.0));
  clusters.AddLandmarks(cluster, 40);
  Structure structure;
  ASSERT_TRUE(structure.Analyze(&clusters.graph).ok());
  const int landmarks = structure.groups().num_landmarks;
  const std::uint64_t analysis = structure.analysis();
  // Not far: the analysis holds.
  ASSERT_TRUE(
      clusters.graph.Set(wild, VertexPose{Pose(Quaternion::Identity(), Vector3(1, 0, -2.5))}).ok());
  ASSERT_TRUE(structure.Analyze(&clusters.graph).ok());
  EXPECT_EQ(structure.analysis(), analysis);
  // Far: landmarks that it hosts or sees leave the groups, with no edge or vertex added.
  const Vector3 far(3e7, 0.0, -1e8);
  ASSERT_TRUE(clusters.graph.Set(wild, VertexPose{Pose(Quaternion::Identity(), far)}).ok());
  ASSERT_TRUE(structure.Analyze(&clusters.graph).ok());
  EXPECT_NE(structure.analysis(), analysis);
  EXPECT_EQ(landmarks, 48);
  EXPECT_EQ(structure.groups().num_landmarks, 40);
}

// A ratio of 0 stayed one that the analysis had seen when the depth had become an ordinary one.
TEST(LandmarkReach, DepthsThatBecomeOrdinaryAfterTheAnalysis) {
  Clusters clusters(5);
  clusters.AddLandmarks(clusters.AddPoses(Vector3(1e5, 1e5, -1e5), 3), 9);
  clusters.AddLandmarks(clusters.AddPoses(Vector3::Zero(), 5), 40);
  clusters.Shake();
  Graph& graph = clusters.graph;
  std::vector<std::pair<VertexHandle<VertexInverseDepth>, VertexInverseDepth>> depths;
  graph.ForEachVertex<VertexInverseDepth>(
      [&](VertexHandle<VertexInverseDepth> handle, const VertexInverseDepth& depth) {
        depths.emplace_back(handle, depth);
      });
  ASSERT_EQ(depths.size(), 49u);
  for (std::size_t l = 0; l < 9; ++l)
    ASSERT_TRUE(graph.Set(depths[l].first, VertexInverseDepth{0.0}).ok());
  Structure structure;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.groups().num_landmarks, 49);
  for (std::size_t l = 0; l < 9; ++l)
    ASSERT_TRUE(graph.Set(depths[l].first, depths[l].second).ok());
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.groups().num_landmarks, 40);
  ExpectSameAsOneByOne(&graph, 1e-10);
}

}  // namespace
}  // namespace glissade
