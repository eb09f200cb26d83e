// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/move.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/data_dir.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/gauge/nullspace.h"
#include "glissade/graph/pools.h"
#include "glissade/io/viowin.h"
#include "support/gauge_scene.h"
#include "support/graph_random.h"

// Sliding a scene along its orbit leaves every residual as it is.

namespace glissade::test {
namespace {

GaugeSceneOptions Options(GaugeGroup group, bool inverse_depth) {
  GaugeSceneOptions options;
  options.imu = group == GaugeGroup::kVisualInertial;
  options.relative_poses = group == GaugeGroup::kStereo;
  options.inverse_depth = inverse_depth;
  return options;
}

constexpr GaugeGroup kGroups[] = {GaugeGroup::kVisualInertial, GaugeGroup::kStereo,
                                  GaugeGroup::kMono};

/// A pose far away: 2 rad of yaw, tens of metres.
Pose Elsewhere(std::uint64_t seed) {
  GraphRandom random(seed);
  return Pose(so3::ExpQuaternion(Vector3(0.3, -0.2, random.Uniform(-2.5, 2.5))),
              random.NormalVector<3>(20.0));
}

std::vector<double> Chi2OfEdges(const Graph& graph) {
  std::vector<double> chi2;
  for (const AnyEdge& edge : graph.Edges())
    chi2.push_back(graph.Chi2(edge).value());
  return chi2;
}

void ExpectSameResiduals(const std::vector<double>& before, const Graph& graph, double cost) {
  const std::vector<double> after = Chi2OfEdges(graph);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t k = 0; k < before.size(); ++k)
    EXPECT_NEAR(after[k], before[k], 1e-9 * (before[k] + 1e-3)) << "edge " << k;
  EXPECT_NEAR(graph.Cost().value(), cost, 1e-12 * cost);
}

/// A prior on some vertices, at x0 off from the present state: numbers without meaning.
EdgeHandle<DynamicEdge> AddPrior(Problem* problem, const std::vector<AnyVertex>& vertices,
                                 std::uint64_t seed) {
  GraphRandom random(seed);
  std::vector<const VertexOps*> ops;
  std::vector<double> x0, J, r0;
  int dim = 0;
  for (const AnyVertex& vertex : vertices) {
    const VertexPoolBase& pool = *problem->PoolOf(vertex.type);
    ops.push_back(&pool.ops());
    dim += pool.ops().tangent_dim;
    std::vector<double> delta, state(static_cast<std::size_t>(pool.ops().ambient_dim));
    for (int k = 0; k < pool.ops().tangent_dim; ++k)
      delta.push_back(0.02 * random.Normal());
    pool.ops().plus(pool.Data(pool.slots().IndexOf(vertex.slot)), delta.data(), state.data());
    x0.insert(x0.end(), state.begin(), state.end());
  }
  for (int k = 0; k < dim * dim; ++k)
    J.push_back(30.0 * random.Normal());
  for (int k = 0; k < dim; ++k)
    r0.push_back(random.Normal());
  return problem->AddEdge(EdgeMarginalPrior::Create(ops, x0, r0, J).value(), vertices).value();
}

TEST(MoveToGauge, LeavesEveryResidual) {
  for (const GaugeGroup group : kGroups) {
    for (const bool inverse_depth : {true, false}) {
      for (const std::size_t anchor : {0u, 5u}) {
        GaugeScene scene(1, Options(group, inverse_depth));
        Problem& problem = scene.problem;
        const std::vector<double> before = Chi2OfEdges(problem);
        const double cost = problem.Cost().value();
        const Pose there = Elsewhere(anchor);
        const Status status = MoveToGauge(&problem, Gauge::Fixed{scene.poses[anchor], there});
        ASSERT_TRUE(status.ok()) << status.message();
        ExpectSameResiduals(before, problem, cost);
        const Pose now = problem.Get(scene.poses[anchor]).pose;
        EXPECT_LT((now.p() - there.p()).norm(), 1e-12);
        EXPECT_LT(std::abs(YawBetween(there, now)), 1e-14);
        if (group != GaugeGroup::kVisualInertial) {
          EXPECT_LT(so3::Log(Quaternion(there.q().conjugate() * now.q())).norm(), 1e-12);
        }
      }
    }
  }
}

TEST(MoveToGauge, ScaleToo) {
  for (const bool inverse_depth : {true, false}) {
    GaugeScene scene(2, Options(GaugeGroup::kMono, inverse_depth));
    Problem& problem = scene.problem;
    const std::vector<double> before = Chi2OfEdges(problem);
    const double cost = problem.Cost().value();
    OrbitMotion g;
    g.scale = 3.7;
    g.t[1] = -4.0;
    const double depth = inverse_depth ? problem.Pool<VertexInverseDepth>()->At(0).rho
                                       : problem.Pool<VertexPointXYZ>()->At(0).data[0];
    ASSERT_TRUE(MoveAlongOrbit(&problem, g).ok());
    ExpectSameResiduals(before, problem, cost);
    if (inverse_depth) {
      EXPECT_NEAR(problem.Pool<VertexInverseDepth>()->At(0).rho, depth / 3.7, 1e-15);
    } else {
      EXPECT_NEAR(problem.Pool<VertexPointXYZ>()->At(0).data[0], depth * 3.7, 1e-12);
    }
  }
}

// A linearization has views of the priors' Hessians, which are others after a move.
TEST(MoveToGauge, MakesALinearizationVoidThatLooksAtPriors) {
  GaugeScene scene(3, Options(GaugeGroup::kVisualInertial, true));
  Problem& problem = scene.problem;
  const std::vector<AnyVertex> vertices{scene.poses[0], scene.speeds[0], scene.poses[1]};
  static_cast<void>(AddPrior(&problem, vertices, 4));
  ASSERT_TRUE(problem.MakeHessian().ok());
  ASSERT_TRUE(MoveToGauge(&problem, Gauge::Fixed{scene.poses[1], Elsewhere(5)}).ok());
  EXPECT_FALSE(problem.SolveLinearSystem(1e-3).ok());
  EXPECT_TRUE(problem.CheckNullspace().ok());
  EXPECT_TRUE(problem.Solve().ok());
}

TEST(MoveToGauge, MarginalPriorsAndFirstEstimatesGoAlong) {
  for (const bool inverse_depth : {true, false}) {
    GaugeScene scene(3, Options(GaugeGroup::kVisualInertial, inverse_depth));
    Problem& problem = scene.problem;
    const std::vector<AnyVertex> vertices{scene.poses[0], scene.speeds[0], scene.poses[1],
                                          scene.points[3]};
    const auto handle = AddPrior(&problem, vertices, 4);
    problem.SetFirstEstimates(FirstEstimates::kFull);
    const auto* prior = dynamic_cast<const EdgeMarginalPrior*>(
        &static_cast<DynamicEdgePool*>(problem.EdgePoolOf(&kTypeInfo<DynamicEdge>))->At(0));
    static_cast<void>(handle);
    ASSERT_NE(prior, nullptr);
    const std::vector<double> J(prior->jacobian().begin(), prior->jacobian().end());
    const std::vector<double> before = Chi2OfEdges(problem);
    const double cost = problem.Cost().value();
    // H in the moved frame is D^-T H D^-1: the same information, seen from there.
    const Pose there = Elsewhere(5);
    const Status status = MoveToGauge(&problem, Gauge::Fixed{scene.poses[1], there});
    ASSERT_TRUE(status.ok()) << status.message();
    ExpectSameResiduals(before, problem, cost);
    prior = dynamic_cast<const EdgeMarginalPrior*>(
        &static_cast<DynamicEdgePool*>(problem.EdgePoolOf(&kTypeInfo<DynamicEdge>))->At(0));
    const int dim = prior->TangentDim();
    for (int r = 0; r < prior->ResidualDim(); ++r) {
      for (const int c : {3, 4, 5, 9, 10, 11, 12, 13, 14, 18, 19, 20}) {
        EXPECT_EQ(prior->jacobian()[static_cast<std::size_t>(r * dim + c)],
                  J[static_cast<std::size_t>(r * dim + c)])
            << "rotations and biases";
      }
    }
    for (std::size_t k = 0, at = 0; k < vertices.size(); ++k) {
      const std::span<const double> x_lin = problem.LinearizationPoint(vertices[k]);
      for (const double x : x_lin)
        EXPECT_NEAR(x, prior->x0()[at++], 1e-13) << "vertex " << k;
    }
    // A solve from there makes the same steps.
    ASSERT_TRUE(problem.Solve({.max_iterations = 3}).ok());
    GaugeScene other(3, Options(GaugeGroup::kVisualInertial, inverse_depth));
    AddPrior(&other.problem, {other.poses[0], other.speeds[0], other.poses[1], other.points[3]}, 4);
    other.problem.SetFirstEstimates(FirstEstimates::kFull);
    ASSERT_TRUE(other.problem.Solve({.max_iterations = 3}).ok());
    EXPECT_NEAR(problem.Cost().value(), other.problem.Cost().value(), 1e-6 * cost);
  }
}

TEST(MoveToGauge, NamesAbsolutePriorsAndMovesThemWhenTold) {
  GaugeScene scene(6);
  Problem& problem = scene.problem;
  GraphRandom random(7);
  EdgeOptions<EdgeSE3Prior> se3;
  se3.information = 100.0 * random.Spd<6>();
  EdgeOptions<EdgePosePriorVec> vec;
  vec.information = 100.0 * random.Spd<6>();
  EdgeOptions<EdgeSpeedBiasPrior> speed;
  speed.information = 100.0 * random.Spd<9>();
  const auto at = [&](std::size_t k) {
    return random.Perturb(problem.Get(scene.poses[k]).pose, 0.1, 0.05);
  };
  const AnyEdge priors[] = {
      problem.AddEdge(EdgeSE3Prior{at(2)}, {scene.poses[2]}, se3).value(),
      problem.AddEdge(EdgePosePriorVec{at(3)}, {scene.poses[3]}, vec).value(),
      problem
          .AddEdge(EdgeSpeedBiasPrior{VertexSpeedBias(Vector3(2.1, 0.3, 0.1), Vector3(0.1, 0, 0),
                                                      Vector3(0, 0.01, 0))},
                   {scene.speeds[3]}, speed)
          .value()};
  const std::vector<double> before = Chi2OfEdges(problem);
  const Snapshot states = problem.GetSnapshot();
  const double cost = problem.Cost().value();
  const Gauge gauge = Gauge::Fixed{scene.poses[0], Elsewhere(8)};
  const Status refused = MoveToGauge(&problem, gauge);
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(problem.GetSnapshot().states, states.states) << "nothing has moved";
  for (const AnyEdge& prior : priors)
    EXPECT_NE(refused.message().find(ToString(prior)), std::string::npos) << refused.message();
  EXPECT_EQ(refused.edge(), priors[0]);

  const Status moved = MoveToGauge(&problem, gauge, {.move_absolute_priors = true});
  ASSERT_TRUE(moved.ok()) << moved.message();
  ExpectSameResiduals(before, problem, cost);
}

TEST(MoveToGauge, RefusesWhatIsNoMotionOfTheGroup) {
  GaugeScene scene(9);
  const Snapshot states = scene.problem.GetSnapshot();
  OrbitMotion roll;
  const Matrix3 R = so3::Exp(Vector3(0.1, 0.0, 0.0));
  std::copy_n(R.data(), 9, roll.R);
  OrbitMotion scale;
  scale.scale = 2.0;
  OrbitMotion none;
  none.R[0] = 2.0;
  OrbitMotion nan;
  nan.t[2] = NAN;
  for (const OrbitMotion& g : {roll, scale, none, nan}) {
    EXPECT_FALSE(MoveAlongOrbit(&scene.problem, g).ok());
    EXPECT_EQ(scene.problem.GetSnapshot().states, states.states);
  }
  EXPECT_TRUE(MoveToGauge(&scene.problem, Gauge::Free).ok());
  EXPECT_FALSE(MoveToGauge(&scene.problem, Gauge::FixedPoses{scene.poses[0], scene.poses[1]}).ok());
  EXPECT_EQ(MoveToGauge(&scene.problem, Gauge::Fixed{}).code(), StatusCode::kUnknownHandle);
}

// What is held in a chart stays held in it, and a gauge remembers where its anchor went.
TEST(MoveToGauge, ChartsAndReferencesGoAlong) {
  GaugeScene scene(10);
  Problem& problem = scene.problem;
  ASSERT_TRUE(problem.SetFixed(scene.poses[4], Fix::kPositionAndYaw).ok());
  ASSERT_TRUE(problem.Solve(Converge()).converged());
  const double cost = problem.Cost().value();
  const Pose there = Elsewhere(11);
  ASSERT_TRUE(MoveToGauge(&problem, Gauge::Fixed{scene.poses[0], there}).ok());
  const Pose held = problem.Get(scene.poses[4]).pose;
  ASSERT_TRUE(problem.Solve(Converge()).ok());
  EXPECT_NEAR(problem.Cost().value(), cost, 1e-9 * cost) << "still the optimum";
  // What is left of a second convergence turns it, to second order.
  EXPECT_LT(std::abs(YawBetween(held, problem.Get(scene.poses[4]).pose)), 1e-11);
  // The first pose was remembered as an anchor: slide away by another, and back without saying
  // where.
  ASSERT_TRUE(MoveToGauge(&problem, Gauge::Fixed{scene.poses[2], Elsewhere(12)}).ok());
  ASSERT_EQ(problem.gauge_references().size(), 2u);
  const Pose now = problem.Get(scene.poses[0]).pose;
  // Up to what the solve in between, which held another pose, moved the anchor: to convergence.
  EXPECT_LT(
      (now.p() - Vector3(Eigen::Map<const Vector3>(problem.gauge_references()[0].pose))).norm(),
      1e-6);
}

class MoveWindows : public ::testing::TestWithParam<const char*> {};

TEST_P(MoveWindows, CostsStay) {
  const auto path = DataDir() / "windows" / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  const auto windows = ReadViowin(path.string());
  ASSERT_TRUE(windows.ok());
  double worst = 0.0;
  for (std::size_t w = 0; w < std::min<std::size_t>(windows->size(), 5); ++w) {
    for (const WindowKind kind : {WindowKind::kVision, WindowKind::kVisualInertial}) {
      Problem problem;
      const auto handles = AddToGraph((*windows)[w], kind, {}, &problem);
      ASSERT_TRUE(handles.ok());
      ASSERT_TRUE(problem.Solve({.max_iterations = 20}).ok());
      std::vector<AnyVertex> vertices{handles->poses[0], handles->poses[1]};
      if (kind == WindowKind::kVisualInertial) {
        vertices.emplace_back(handles->speed_biases[1]);
        AddPrior(&problem, vertices, w);
      }
      const Gauge gauge = Gauge::Fixed{handles->poses[3], Elsewhere(w)};
      const double cost = problem.Cost().value();
      const int absolute =
          problem.NumEdges<EdgePosePriorVec>() + problem.NumEdges<EdgeSpeedBiasPrior>();
      if (absolute > 0) {
        const Status refused = MoveToGauge(&problem, gauge);
        EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
        EXPECT_TRUE(refused.edge());
      }
      const Status status = MoveToGauge(&problem, gauge, {.move_absolute_priors = true});
      ASSERT_TRUE(status.ok()) << status.message();
      const double error = std::abs(problem.Cost().value() - cost) / cost;
      worst = std::max(worst, error);
      EXPECT_LT(error, 1e-12) << "window " << w;
    }
  }
  std::printf("[          ] largest relative change of a cost: %.2g\n", worst);
}

INSTANTIATE_TEST_SUITE_P(Files, MoveWindows,
                         ::testing::Values("win10.txt.gz", "win11m.txt.gz", "win20.txt.gz",
                                           "win50.txt.gz"));

}  // namespace
}  // namespace glissade::test
