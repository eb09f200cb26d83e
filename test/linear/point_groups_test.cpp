// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points in groups against the same one by one: by edges of all forms, several types on one point,
// with first estimates away from the states, poses that are fixed in part, losses.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "linear/both_paths.h"
#include "linear/point_edges.h"
#include "linear/pose_row.h"

namespace glissade {
namespace {

using test::kLeftCamera, test::kRightCamera;
using test::PointExtrinsic, test::PointOffset, test::PointOneByOne, test::PointPrior;
using test::PointResidual;

enum class Kind { kOneByOne, kResidual, kBuiltIn, kTwoCameras, kPinhole, kOffset, kMixed };

std::string Name(Kind kind) {
  constexpr const char* kNames[] = {"OneByOne", "Residual", "BuiltIn", "TwoCameras",
                                    "Pinhole",  "Offset",   "Mixed"};
  return kNames[static_cast<int>(kind)];
}

struct Options {
  bool first_estimates = true;
  bool losses = true;       ///< of all kinds, on some edges
  bool information = true;  ///< not a multiple of the identity, on some edges
  bool fixes = false;
  bool depths = false;                  ///< landmarks of the other type too
  bool extrinsic = false;               ///< some points are seen by a camera that is estimated
  bool several_points_of_view = false;  ///< tracks that any pose may be in
};

class Builder {
 public:
  Builder(std::uint64_t seed, const Options& options) : random_(seed), options_(options) {}

  Graph Build(Kind kind, int num_poses, int num_points, double from_origin = 0.0) {
    const Vector3 o(from_origin, -from_origin, from_origin);
    poses_ = test::AddPoseRow(num_poses, o, &random_, &graph_);
    if (options_.extrinsic) {
      extrinsic_ = graph_.AddVertex(VertexPose{kLeftCamera});
      EXPECT_TRUE(graph_.AddEdge(EdgeSE3Prior{kLeftCamera}, {extrinsic_}).ok());
    }
    for (int l = 0; l < num_points; ++l)
      AddPoint(kind, o, l);
    if (options_.first_estimates) Move();
    if (options_.fixes) {
      EXPECT_TRUE(graph_.SetFixed(poses_[1]).ok());
      EXPECT_TRUE(graph_.SetFixed(poses_[2], Fix::kPositionAndYaw).ok());
      EXPECT_TRUE(graph_.SetFixed(poses_[3], Fix::kPosition).ok());
    }
    return std::move(graph_);
  }

 private:
  bool Chance(double p) { return random_.Uniform(0.0, 1.0) < p; }

  template <class E>
  void Add(const E& edge, std::size_t pose, VertexHandle<VertexPointXYZ> point, double scale) {
    constexpr int kRows = E::kResidualDim;
    EdgeOptions<E> options;
    SquareMatrix<kRows> L = scale * SquareMatrix<kRows>::Identity();
    if (options_.information && Chance(0.2)) L(0, 1) = 0.1 * scale;
    options.sqrt_information = L;
    const double loss = random_.Uniform(0.0, 1.0);
    if (options_.losses && loss < 0.2) options.loss = Huber{1.0};
    if (options_.losses && loss > 0.5) options.loss = Cauchy{2.0};
    if (options_.losses && loss > 0.9) options.loss = Tukey{200.0};
    EXPECT_TRUE(graph_.AddEdge(edge, {poses_[pose], point}, options).ok());
  }

  void AddPoint(Kind kind, const Vector3& o, int l) {
    const Vector3 x(random_.Uniform(-1.0, 3.0), random_.Uniform(-1.5, 1.5),
                    random_.Uniform(3.0, 9.0));
    const VertexHandle<VertexPointXYZ> point = graph_.AddVertex(VertexPointXYZ(o + x));
    const auto first = static_cast<std::size_t>(l) % (poses_.size() - 1);
    for (std::size_t k = options_.several_points_of_view ? 0 : first; k < poses_.size(); ++k) {
      if (k != first && Chance(0.3)) continue;
      Observe(kind, k, point, kLeftCamera);
      if (kind == Kind::kTwoCameras && Chance(0.8)) Observe(kind, k, point, kRightCamera);
    }
    if (kind == Kind::kMixed && Chance(0.5)) {
      const PointPrior prior{o + x + random_.Vec3(0.1)};
      EdgeOptions<PointPrior> options;
      if (options_.losses) options.loss = Huber{0.05};
      EXPECT_TRUE(graph_.AddEdge(prior, {point}, options).ok());
    }
    if (options_.extrinsic && l % 3 == 0) {
      EXPECT_TRUE(graph_.AddEdge(PointExtrinsic{}, {poses_[first], point, extrinsic_}).ok());
    }
    if (options_.depths) {
      EdgeReprojection edge;
      edge.uv_host = random_.Vec2(0.3);
      edge.T_b_c = kLeftCamera;
      const auto depth = graph_.AddVertex(VertexInverseDepth{random_.Uniform(0.1, 0.4)});
      const std::size_t host = (first + 1) % poses_.size();
      for (const std::size_t target : {(host + 1) % poses_.size(), (host + 2) % poses_.size()}) {
        Vector2 seen = Vector2::Zero();
        EXPECT_TRUE(edge.Evaluate(graph_.Get(poses_[host]), graph_.Get(poses_[target]),
                                  graph_.Get(depth), seen, nullptr, nullptr, nullptr));
        EdgeReprojection observed = edge;
        observed.uv_target = seen + random_.Vec2(0.01);
        EXPECT_TRUE(graph_.AddEdge(observed, {poses_[host], poses_[target], depth}).ok());
      }
    }
  }

  void Observe(Kind kind, std::size_t pose, VertexHandle<VertexPointXYZ> point,
               const Pose& camera) {
    EdgeReprojectionXYZ edge;
    edge.T_b_c = camera;
    Vector2 seen = Vector2::Zero();
    EXPECT_TRUE(edge.Evaluate(graph_.Get(poses_[pose]), graph_.Get(point), seen, nullptr, nullptr));
    edge.uv = seen + random_.Vec2(0.005);
    if (kind == Kind::kMixed) kind = static_cast<Kind>(int(random_.Uniform(0.0, 6.0)));
    switch (kind) {
      case Kind::kOneByOne: {
        PointOneByOne own;
        own.uv = edge.uv;
        own.T_b_c = camera;
        return Add(own, pose, point, 200.0);
      }
      case Kind::kResidual: {
        PointResidual own;
        own.uv = edge.uv;
        own.T_b_c = camera;
        return Add(own, pose, point, 200.0);
      }
      case Kind::kPinhole: {
        EdgeReprojectionXYZOf<CameraPinhole> pinhole;
        pinhole.camera = CameraPinhole{400.0, 410.0, 320.0, 240.0};
        pinhole.T_b_c = camera;
        pinhole.uv = Vector2(400.0 * edge.uv[0] + 320.0, 410.0 * edge.uv[1] + 240.0);
        return Add(pinhole, pose, point, 0.5);
      }
      case Kind::kOffset: {
        const Pose x = graph_.Get(poses_[pose]).pose;
        const Vector3 offset = x.R().transpose() * (graph_.Get(point).p() - x.p());
        return Add(PointOffset{offset + random_.Vec3(0.02)}, pose, point, 50.0);
      }
      default:
        return Add(edge, pose, point, 200.0);
    }
  }

  /// Every other pose and every third point were linearized elsewhere.
  void Move() {
    test::MoveFirstEstimates(poses_, &random_, &graph_);
    int l = 0;
    std::vector<VertexHandle<VertexPointXYZ>> points;
    graph_.ForEachVertex<VertexPointXYZ>([&](auto handle, const auto&) {
      if (l++ % 3 == 0) points.push_back(handle);
    });
    for (const auto point : points) {
      const Vector3 x = graph_.Get(point).p() + random_.Vec3(0.05);
      EXPECT_TRUE(graph_.SetFirstEstimate(point, {x.data(), 3}).ok());
    }
  }

  test::Random random_;
  Options options_;
  Graph graph_;
  std::vector<VertexHandle<VertexPose>> poses_;
  VertexHandle<VertexPose> extrinsic_;
};

constexpr FirstEstimates kModes[] = {FirstEstimates::kFull, FirstEstimates::kPriorOnly,
                                     FirstEstimates::kOff};

/// In all modes. grouped: how many points are to be in groups, negative: not known.
void ExpectSameAsOneByOne(Graph* graph, int grouped, double tolerance = 1e-10) {
  for (const FirstEstimates mode : kModes) {
    ASSERT_TRUE(graph->SetFirstEstimates(mode).ok());
    for (const bool identity : {false, true}) {
      const DampingTerm damping{.lambda = identity ? 1e2 : 0.1, .identity = identity};
      test::PathOutcome groups(graph, true, damping), single(graph, false, damping);
      EXPECT_GT(groups.structure.groups().num_landmarks, 0);
      if (grouped >= 0) {
        EXPECT_EQ(groups.structure.groups().num_landmarks, grouped);
      }
      EXPECT_EQ(single.structure.groups().num_landmarks, 0);
      test::ExpectSame(&groups, single, tolerance);
      if (testing::Test::HasFatalFailure()) return;
      // d'H d, and products with an S that is not stored.
      const std::vector<double>& d = groups.equations.step();
      const double form =
          single.equations.QuadraticForm(single.structure, *graph, single.equations.step());
      EXPECT_NEAR(groups.equations.QuadraticForm(groups.structure, *graph, d), form, 1e-9 * form);
      const auto n = static_cast<std::size_t>(single.structure.num_pose_scalars());
      std::vector<double> x(n), y(n), expected(n);
      for (std::size_t k = 0; k < n; ++k)
        x[k] = single.equations.step()[k];
      for (test::PathOutcome* path : {&groups, &single}) {
        ASSERT_TRUE(path->equations
                        .Eliminate(path->structure, *graph, damping, SchurForm::kDiagonalBlocks,
                                   &path->threads)
                        .ok());
        path->equations.reduced().Multiply(x.data(), path == &groups ? y.data() : expected.data());
      }
      double largest = 0.0;
      for (const double value : expected)
        largest = std::max(largest, std::abs(value));
      for (std::size_t k = 0; k < n; ++k)
        ASSERT_NEAR(y[k], expected[k], 1e-8 * largest) << k;
    }
  }
}

class PointGroups : public testing::TestWithParam<Kind> {};

TEST_P(PointGroups, AreTheSameSystemAsOneByOne) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Graph graph = Builder(seed, {}).Build(GetParam(), 7, 60);
    ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, 60));
  }
}

TEST_P(PointGroups, WithFixesAndOtherLandmarks) {
  Graph graph = Builder(5, {.fixes = true, .depths = true, .several_points_of_view = true})
                    .Build(GetParam(), 8, 50);
  ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, 100));
}

TEST_P(PointGroups, BesidePointsOfAnEstimatedCamera) {
  Graph graph = Builder(6, {.extrinsic = true}).Build(GetParam(), 6, 45);
  ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, 30));
}

TEST_P(PointGroups, ThreadsChangeNoBit) {
  const Graph graph = Builder(9, {.depths = true}).Build(GetParam(), 12, 500);
  test::ExpectThreadsChangeNoBit(graph);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PointGroups,
                         testing::Values(Kind::kOneByOne, Kind::kResidual, Kind::kBuiltIn,
                                         Kind::kTwoCameras, Kind::kPinhole, Kind::kOffset,
                                         Kind::kMixed),
                         [](const auto& param) { return Name(param.param); });

TEST(PointGroups, ManySizes) {
  for (const int poses : {2, 3, 10, 20, 35}) {
    for (const int points : {4, 7, 8, 9, 64, 300}) {
      SCOPED_TRACE(std::to_string(poses) + " poses, " + std::to_string(points));
      Graph graph = Builder(2, {.information = false}).Build(Kind::kTwoCameras, poses, points);
      ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, points));
    }
  }
}

TEST(PointGroups, FarFromTheOrigin) {
  for (const double far : {1e3, 1e6}) {
    SCOPED_TRACE(std::to_string(far));
    Graph graph = Builder(3, {}).Build(Kind::kTwoCameras, 7, 60, far);
    ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, 60));
  }
}

// A pose far away from the others: its points are too near to it for moments about another one.
TEST(PointGroups, LeaveOutPointsOfAPoseFarAway) {
  Graph graph = Builder(4, {.first_estimates = false}).Build(Kind::kBuiltIn, 5, 40);
  const Vector3 far(1e6, 0.0, -2e6);
  const auto wild = graph.AddVertex(VertexPose{Pose(Quaternion::Identity(), far)});
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{graph.Get(wild).pose}, {wild}).ok());
  VertexHandle<VertexPointXYZ> last;
  for (int k = 0; k < 3; ++k) {
    last = graph.AddVertex(VertexPointXYZ(far + Vector3(k, 0.0, 4.0)));
    EXPECT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {wild, last}).ok());
    EXPECT_TRUE(graph.AddEdge(PointPrior{far}, {last}).ok());
  }
  ASSERT_NO_FATAL_FAILURE(ExpectSameAsOneByOne(&graph, 40));
  // Points that get there after the analysis.
  Structure structure;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  const std::uint64_t analysis = structure.analysis();
  Pose near = graph.Get(wild).pose;
  near.p() = Vector3(0.0, 0.0, -1.0);
  ASSERT_TRUE(graph.Set(wild, VertexPose{near}).ok());
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.analysis(), analysis);  // out of a group is always right
  Structure other;
  ASSERT_TRUE(other.Analyze(&graph).ok());
  EXPECT_EQ(other.groups().num_landmarks, 43);
  ASSERT_TRUE(graph.Set(wild, VertexPose{Pose(Quaternion::Identity(), far)}).ok());
  ASSERT_TRUE(other.Analyze(&graph).ok());
  EXPECT_EQ(other.groups().num_landmarks, 40);
}

// Points that two poses of very many see: as one group they would be nearly all zeros.
TEST(PointGroups, SparseOnesAreEliminatedOneByOne) {
  Graph graph;
  std::vector<VertexHandle<VertexPose>> poses;
  for (int k = 0; k < 80; ++k) {
    poses.push_back(
        graph.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(0.1 * k, 0.0, 0.0))}));
    EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{graph.Get(poses.back()).pose}, {poses.back()}).ok());
  }
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const auto point = graph.AddVertex(VertexPointXYZ(0.01 * static_cast<double>(k), 0.1, 5.0));
    EXPECT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {poses[0], point}).ok());
    EXPECT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {poses[k], point}).ok());
  }
  Structure structure;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.groups().num_landmarks, 0);
  EXPECT_EQ(structure.landmarks().size(), 79u);
}

TEST(PointGroups, EdgeWithoutAValueIsNamed) {
  Graph graph = Builder(3, {.losses = false, .information = false}).Build(Kind::kBuiltIn, 6, 40);
  const auto pose = graph.AddVertex(VertexPose{});
  const auto point = graph.AddVertex(VertexPointXYZ(1.0, 0.5, 0.0));
  const auto edge = graph.AddEdge(EdgeReprojectionXYZ{}, {pose, point});
  ASSERT_TRUE(edge.ok());
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;
  double cost = 0.0;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  EXPECT_EQ(structure.groups().num_landmarks, 41);
  const Status status = equations.Linearize(structure, &graph, &threads, &cost);
  EXPECT_EQ(status.code(), StatusCode::kEvaluationFailed);
  EXPECT_EQ(status.edge(), AnyEdge(*edge));
}

// No pose is free: each point has its own least squares, and S is empty.
TEST(PointGroups, AmongFixedPosesAloneAreTriangulated) {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  for (int k = 0; k < 4; ++k) {
    poses.push_back(
        problem.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(0.4 * k, 0.0, 0.0))}));
    ASSERT_TRUE(problem.SetFixed(poses.back()).ok());
  }
  std::vector<VertexHandle<VertexPointXYZ>> points;
  for (int l = 0; l < 11; ++l) {
    const Vector3 truth(0.1 * l, 0.05 * l - 0.2, 4.0 + 0.1 * l);
    points.push_back(problem.AddVertex(VertexPointXYZ(truth + Vector3(0.1, -0.1, 0.3))));
    for (const auto pose : poses) {
      const Vector3 x = truth - problem.Get(pose).pose.p();
      EdgeReprojectionXYZ edge;
      edge.uv = Vector2(x[0] / x[2], x[1] / x[2]);
      ASSERT_TRUE(problem.AddEdge(edge, {pose, points.back()}).ok());
    }
  }
  const SolveSummary& summary = problem.Solve();
  ASSERT_TRUE(summary.ok()) << summary.status.message();
  ASSERT_EQ(summary.edges.size(), 1u);
  EXPECT_EQ(summary.edges[0].as_twists, 44);
  for (int l = 0; l < 11; ++l) {
    const Vector3 truth(0.1 * l, 0.05 * l - 0.2, 4.0 + 0.1 * l);
    EXPECT_LT((problem.Get(points[static_cast<std::size_t>(l)]).p() - truth).norm(), 1e-8);
  }
}

// Seen once: without damping the ray leaves one direction open.
TEST(PointGroups, PointWithTooLittleInformationIsNamed) {
  Graph graph = Builder(3, {}).Build(Kind::kOffset, 6, 40);
  const auto pose = graph.AddVertex(VertexPose{});
  const auto point = graph.AddVertex(VertexPointXYZ(0.0, 0.0, 2.0));
  ASSERT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {pose, point}).ok());
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;
  double cost = 0.0;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  ASSERT_TRUE(equations.Linearize(structure, &graph, &threads, &cost).ok());
  const Status status =
      equations.Eliminate(structure, graph, {.lambda = 0.0}, SchurForm::kDense, &threads);
  EXPECT_EQ(status.code(), StatusCode::kSingular);
  EXPECT_EQ(status.vertex(), AnyVertex(point));
}

}  // namespace
}  // namespace glissade
