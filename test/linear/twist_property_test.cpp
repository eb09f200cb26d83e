// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the edges of one landmark may differ in, at random: whatever is taken for equal within a
// landmark, a run, a pair or a group must be equal, or the landmark must be eliminated alone.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "linear/both_paths.h"

namespace glissade {
namespace {

struct Variation {
  const char* name;
  bool uv_host = false;      ///< per edge, now and then by one bit
  bool extrinsic = false;    ///< per edge, now and then by one bit
  bool information = false;  ///< per edge: single, without one row, the identity
  bool loss = false;         ///< per edge: none, Huber of many widths, Cauchy
  bool hosts = false;        ///< several hosts for a landmark, also each other's targets
  bool duplicates = false;   ///< a pose observes a landmark twice
  bool others = false;       ///< edges of other types on the landmark
  bool fixes = false;
  bool kept = false;            ///< landmarks that are not eliminated
  bool weights_change = false;  ///< between the analysis and the comparison
};

// Each alone, then all together.
constexpr Variation kVariations[] = {
    {.name = "nothing"},
    {.name = "uv_host", .uv_host = true},
    {.name = "extrinsic", .extrinsic = true},
    {.name = "information", .information = true},
    {.name = "loss", .loss = true},
    {.name = "hosts", .hosts = true},
    {.name = "duplicates", .duplicates = true},
    {.name = "others", .others = true},
    {.name = "fixes", .fixes = true},
    {.name = "kept", .kept = true},
    {.name = "weights_change", .weights_change = true},
    {.name = "everything",
     .uv_host = true,
     .extrinsic = true,
     .information = true,
     .loss = true,
     .hosts = true,
     .duplicates = true,
     .others = true,
     .fixes = true,
     .kept = true,
     .weights_change = true},
};

class Builder {
 public:
  Builder(std::uint64_t seed, const Variation& variation) : random_(seed), vary_(variation) {}

  Graph Build() {
    for (int k = 0; k < kPoses; ++k) {
      const Vector3 p = Vector3(0.3 * k, 0.0, 0.0) + random_.Vec3(0.15);
      poses_.push_back(
          graph_.AddVertex(VertexPose{Pose(so3::ExpQuaternion(random_.Vec3(0.2)), p)}));
      EdgeOptions<EdgeSE3Prior> prior;
      prior.sqrt_information = SquareMatrix<6>(10.0 * SquareMatrix<6>::Identity());
      Pose mean = graph_.Get(poses_.back()).pose;
      mean.p() += random_.Vec3(0.05);
      EXPECT_TRUE(graph_.AddEdge(EdgeSE3Prior{mean}, {poses_.back()}, prior).ok());
    }
    for (int l = 0; l < kLandmarks; ++l)
      AddLandmark();
    if (vary_.fixes) Fix_();
    return std::move(graph_);
  }

  /// Weights and losses of some edges, after an analysis.
  void ChangeWeights(Graph* graph) {
    std::vector<EdgeHandle<EdgeReprojection>> edges;
    graph->ForEachEdge<EdgeReprojection>(
        [&](auto handle, const auto&) { edges.push_back(handle); });
    for (const EdgeHandle<EdgeReprojection> edge : edges) {
      if (Chance(0.3)) {
        EXPECT_TRUE(graph->SetSqrtInformation(edge, RandomSqrt()).ok());
      }
      if (Chance(0.3)) {
        EXPECT_TRUE(graph->SetLoss(edge, RandomLoss()).ok());
      }
    }
  }

 private:
  static constexpr int kPoses = 7, kLandmarks = 60;

  bool Chance(double p) { return random_.Uniform(0.0, 1.0) < p; }
  std::size_t Below(int n) { return static_cast<std::size_t>(random_.Uniform(0.0, n)); }
  /// Every third change is one of the last bit.
  double Changed(double x, double by) {
    return Chance(0.33) ? std::nextafter(x, 10.0) : x + random_.Uniform(-by, by);
  }
  Matrix2 RandomSqrt() {
    Matrix2 L;
    L << random_.Uniform(50, 300), random_.Uniform(-40, 40), random_.Uniform(-40, 40),
        random_.Uniform(50, 300);
    if (Chance(0.1)) L.row(1).setZero();
    if (Chance(0.1)) L.setIdentity();
    return L;
  }
  Loss RandomLoss() {
    if (Chance(0.2)) return Cauchy{random_.Uniform(1.0, 30.0)};
    if (Chance(0.3)) return {};
    return Huber{random_.Uniform(0.5, 30.0)};
  }

  void AddLandmark() {
    const double rho = Chance(0.05) ? 0.0 : random_.Uniform(0.05, 0.5);
    const VertexHandle<VertexInverseDepth> depth = graph_.AddVertex(VertexInverseDepth{rho});
    EdgeReprojection edge;
    edge.T_b_c = Chance(0.5) ? kCameras[0] : kCameras[1];
    const Vector2 uv = random_.Vec2(0.4);
    const std::size_t host = Below(kPoses);
    const int views = 2 + static_cast<int>(Below(4));
    for (int k = 0; k < views; ++k) {
      // A part of the landmarks stays as the groups path wants it.
      const auto varies = [&](bool kind) { return kind && Chance(0.15); };
      EdgeReprojection e = edge;
      e.uv_host = uv;
      if (varies(vary_.uv_host)) e.uv_host[0] = Changed(uv[0], 0.02);
      if (varies(vary_.uv_host)) e.uv_host[1] = Changed(uv[1], 0.02);
      if (varies(vary_.extrinsic)) e.T_b_c.data[0] = Changed(e.T_b_c.data[0], 0.02);
      const std::size_t from = varies(vary_.hosts) ? Below(kPoses) : host;
      std::size_t to = Below(kPoses);
      while (to == from)
        to = Below(kPoses);
      const int times = varies(vary_.duplicates) ? 2 : 1;
      for (int t = 0; t < times; ++t)
        AddObservation(e, from, to, depth);
    }
    if (vary_.others && Chance(0.2)) {
      EdgeReprojectionOf<CameraPinhole> other;
      other.uv_host = uv;
      other.T_b_c = edge.T_b_c;
      other.camera = CameraPinhole{100.0, 100.0, 0.0, 0.0};
      other.uv_target = 100.0 * uv;
      EXPECT_TRUE(graph_.AddEdge(other, {poses_[host], poses_[(host + 1) % kPoses], depth}).ok());
    }
    if (vary_.kept && Chance(0.1)) {
      EXPECT_TRUE(graph_.SetEliminated(depth, false).ok());
    }
    depths_.push_back(depth);
  }

  void AddObservation(EdgeReprojection e, std::size_t from, std::size_t to,
                      VertexHandle<VertexInverseDepth> depth) {
    // Without duplicates, a target sees a landmark once.
    for (const auto& [d, f, t] : seen_) {
      if (!vary_.duplicates && d == depth && f == from && t == to) return;
    }
    const VertexPose host = graph_.Get(poses_[from]), target = graph_.Get(poses_[to]);
    Vector2 predicted = Vector2::Zero();
    e.uv_target.setZero();
    if (!e.Evaluate(host, target, graph_.Get(depth), predicted, nullptr, nullptr, nullptr)) return;
    // No grazing points: what a moment loses there is rounding, not what is compared.
    if (!(e.Depth(host, target, graph_.Get(depth)) > 0.5)) return;
    e.uv_target = predicted + random_.Vec2(0.03);
    EdgeOptions<EdgeReprojection> options;
    options.sqrt_information =
        vary_.information ? RandomSqrt() : Matrix2(300 * Matrix2::Identity());
    if (vary_.loss) options.loss = Chance(0.5) ? RandomLoss() : Loss(Huber{3.0});
    EXPECT_TRUE(graph_.AddEdge(e, {poses_[from], poses_[to], depth}, options).ok());
    seen_.push_back({depth, from, to});
  }

  void Fix_() {
    EXPECT_TRUE(graph_.SetFixed(poses_[Below(3)]).ok());
    EXPECT_TRUE(graph_.SetFixed(poses_[3], Fix::kPositionAndYaw).ok());
    EXPECT_TRUE(graph_.SetFixed(poses_[4], Fix::kPosition).ok());
    for (const auto depth : depths_) {
      if (Chance(0.15)) {
        EXPECT_TRUE(graph_.SetFixed(depth).ok());
      }
    }
  }

  const Pose kCameras[2] = {
      Pose(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 0.05, -0.02)),
      Pose(so3::ExpQuaternion(Vector3(-0.3, 0.1, 0.2)), Vector3(-0.2, 0.0, 0.03))};
  struct Seen {
    VertexHandle<VertexInverseDepth> depth;
    std::size_t from, to;
  };
  test::Random random_;
  Variation vary_;
  Graph graph_;
  std::vector<VertexHandle<VertexPose>> poses_;
  std::vector<VertexHandle<VertexInverseDepth>> depths_;
  std::vector<Seen> seen_;
};

class TwistProperty : public testing::TestWithParam<Variation> {};

TEST_P(TwistProperty, GroupsAreOneByOne) {
  int in_groups = 0, one_by_one = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Builder builder(seed, GetParam());
    Graph graph = builder.Build();
    const DampingTerm damping{.lambda = 0.1};
    test::PathOutcome groups(&graph, true, damping), single(&graph, false, damping);
    if (GetParam().weights_change) {
      builder.ChangeWeights(&graph);
      for (test::PathOutcome* path : {&groups, &single}) {
        ASSERT_TRUE(path->structure
                        .Analyze(&graph, {.allow_duplicate_observations = true,
                                          .group_landmarks = path == &groups})
                        .ok());
        path->Run(damping);
      }
    }
    in_groups += groups.structure.groups().num_landmarks;
    one_by_one += static_cast<int>(groups.structure.landmarks().size());
    EXPECT_EQ(single.structure.groups().num_landmarks, 0);
    test::ExpectSame(&groups, single, 1e-10);
    if (HasFatalFailure()) return;

    // To the end: the cost is that of the graph.
    Problem by_lanes(graph.Clone());
    SolveOptions options;
    options.allow_duplicate_observations = true;
    options.max_iterations = 100;
    const SolveSummary a = by_lanes.Solve(options);
    EXPECT_TRUE(a.status.ok()) << a.status.message();
    EXPECT_NEAR(a.final_cost, by_lanes.Cost().value(), 1e-12 * a.final_cost);
  }
  // Landmarks with several hosts are in no group.
  EXPECT_GT(in_groups, 0);
  EXPECT_EQ(one_by_one > 0, GetParam().hosts);
}

INSTANTIATE_TEST_SUITE_P(Variations, TwistProperty, testing::ValuesIn(kVariations),
                         [](const auto& param) { return std::string(param.param.name); });

// The defect itself: one host, one landmark, two observations of it by the host.
TEST(TwistTerms, HostObservationsThatDifferWithinALandmark) {
  Problem problem;
  const VertexHandle<VertexPose> host = problem.AddVertex(VertexPose{});
  const VertexHandle<VertexInverseDepth> depth = problem.AddVertex(VertexInverseDepth{0.25});
  EXPECT_TRUE(problem.SetFixed(host).ok());
  int k = 0;
  for (const double u : {0.10, 0.12}) {
    const VertexHandle<VertexPose> target = problem.AddVertex(
        VertexPose{Pose(Quaternion::Identity(), Vector3(k == 0 ? 1.0 : -1.0, 0.5, 0.0))});
    EXPECT_TRUE(problem.SetFixed(target).ok());
    const Vector3 p = problem.Get(target).pose.p();
    EdgeReprojection edge;
    edge.uv_host = Vector2(u, 0.0);
    edge.uv_target = Vector2(u - 0.2 * p[0], -0.2 * p[1]);  // rho = 0.2
    EXPECT_TRUE(problem.AddEdge(edge, {host, target, depth}).ok());
    ++k;
  }
  const SolveSummary summary = problem.Solve();
  ASSERT_TRUE(summary.status.ok()) << summary.status.message();
  EXPECT_NEAR(problem.Get(depth).rho, 0.2, 1e-12);
  EXPECT_NEAR(summary.final_cost, problem.Cost().value(), 1e-20);
}

}  // namespace
}  // namespace glissade
