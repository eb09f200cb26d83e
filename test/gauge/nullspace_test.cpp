// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/nullspace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "glissade/cameras/pinhole.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "support/dense_reference.h"
#include "support/gauge_scene.h"
#include "support/graph_random.h"

// J u = 0 at any state, and who breaks it.

namespace glissade::test {
namespace {

GaugeSceneOptions Options(GaugeGroup group, bool inverse_depth) {
  GaugeSceneOptions options;
  options.imu = group == GaugeGroup::kVisualInertial;
  options.relative_poses = group == GaugeGroup::kStereo;
  options.inverse_depth = inverse_depth;
  options.start_noise = 0.05;  // far from the optimum: J u = 0 does not care
  return options;
}

constexpr GaugeGroup kGroups[] = {GaugeGroup::kVisualInertial, GaugeGroup::kStereo,
                                  GaugeGroup::kMono};

/// Of u'Hu from H's blocks: sums of some hundred terms that cancel.
constexpr double kRounding = 1e-14;

bool Names(const NullspaceReport& report, AnyEdge edge) {
  return std::any_of(report.edges.begin(), report.edges.end(),
                     [&](const GaugeBreach& breach) { return breach.edge == edge; });
}

// From the Jacobian itself, dense and edge by edge, at states far from any optimum.
TEST(Nullspace, JuIsZeroAtAnyState) {
  for (const GaugeGroup group : kGroups) {
    for (const bool inverse_depth : {true, false}) {
      GaugeScene scene(1, Options(group, inverse_depth));
      const std::vector<AnyVertex> vertices = scene.problem.Vertices();
      const DenseReference dense(scene.problem, vertices);
      const Orbit orbit = Orbit::Of(scene.problem).value();
      Eigen::MatrixXd Ju = Eigen::MatrixXd::Zero(dense.J.rows(), orbit.dim());
      Eigen::VectorXd terms = Eigen::VectorXd::Zero(orbit.dim());
      Eigen::Index begin = 0;
      for (const AnyVertex& vertex : vertices) {
        const VertexPoolBase& pool = *scene.problem.PoolOf(vertex.type);
        const int dim = pool.ops().tangent_dim;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> U =
            Eigen::MatrixXd::Zero(dim, orbit.dim());
        if (orbit.Moves(vertex)) {
          orbit.Directions(vertex, pool.Data(pool.slots().IndexOf(vertex.slot)), U.data());
        }
        const Eigen::MatrixXd part = dense.J.middleCols(begin, dim) * U;
        Ju += part;
        terms += part.colwise().squaredNorm().transpose();
        begin += dim;
      }
      EXPECT_LT((Ju.colwise().squaredNorm().transpose().array() / terms.array()).maxCoeff(), 1e-29);
    }
  }
}

TEST(Nullspace, IsExactAtAnyState) {
  for (const GaugeGroup group : kGroups) {
    for (const bool inverse_depth : {true, false}) {
      GaugeScene scene(1, Options(group, inverse_depth));
      const auto report = CheckNullspace(&scene.problem);
      ASSERT_TRUE(report.ok()) << report.status().message();
      EXPECT_EQ(report->group, group);
      ASSERT_EQ(report->directions.size(), static_cast<std::size_t>(Dimension(group)));
      EXPECT_LT(report->MaxKappa(), kRounding);
      EXPECT_TRUE(report->edges.empty());
      EXPECT_TRUE(report->held.empty());
    }
  }
}

/// A camera model that the library does not know.
struct OwnCamera : CameraPinhole {
  friend bool operator==(const OwnCamera&, const OwnCamera&) = default;
};

/// An observation that it does not know either: of what it needs, it says that it is rays.
struct OwnReprojection : EdgeReprojectionOf<CameraPinhole> {};

/// The scene's observations through E, with pixels.
template <class E>
void ExpectScaleIsAboutTheCamera() {
  GaugeScene scene(1, Options(GaugeGroup::kMono, true));
  Problem& problem = scene.problem;
  struct Observation {
    EdgeReprojection edge;
    EdgeVertexHandles<EdgeReprojection> vertices;
  };
  std::vector<Observation> observations;
  std::vector<AnyEdge> old;
  problem.ForEachEdge<EdgeReprojection>(
      [&](auto handle, const EdgeReprojection& edge, const auto& vertices) {
        observations.push_back({edge, vertices});
        old.push_back(handle);
      });
  ASSERT_GT(observations.size(), 100u);
  for (const AnyEdge& edge : old)
    ASSERT_TRUE(problem.RemoveEdge(edge).ok());
  for (const Observation& o : observations) {
    const Vector2 px(400.0 * o.edge.uv_target[0] + 320.0, 410.0 * o.edge.uv_target[1] + 240.0);
    E edge;
    edge.uv_host = o.edge.uv_host;
    edge.uv_target = px;
    edge.T_b_c = o.edge.T_b_c;
    static_cast<CameraPinhole&>(edge.camera) = {400.0, 410.0, 320.0, 240.0};
    ASSERT_TRUE(problem.AddEdge(edge, o.vertices).ok());
  }
  const auto report = CheckNullspace(&problem);
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(report->group, GaugeGroup::kMono);
  EXPECT_LT(report->MaxKappa(), kRounding);
  EXPECT_TRUE(report->edges.empty());
}

// The lever arm of a camera was looked for in edges on normalized coordinates only, later in those
// of the library's camera models: with others, the body's origin was scaled instead of the camera's
// centre, and edges with other names were taken for metric ones.
TEST(Nullspace, ScaleIsAboutTheCameraOfAnyModel) {
  ExpectScaleIsAboutTheCamera<EdgeReprojectionOf<CameraPinhole>>();
  ExpectScaleIsAboutTheCamera<EdgeReprojectionOf<OwnCamera>>();
  ExpectScaleIsAboutTheCamera<OwnReprojection>();
}

// Not so by accident: the same with a wrong group shows what is observed.
TEST(Nullspace, ADirectionTooMuchIsSeen) {
  GaugeScene stereo(2, Options(GaugeGroup::kStereo, true));
  auto report = CheckNullspace(&stereo.problem, {.group = GaugeGroup::kMono});
  ASSERT_TRUE(report.ok());
  for (int k = 0; k < 6; ++k)
    EXPECT_LT(report->directions[static_cast<std::size_t>(k)].kappa, kRounding);
  EXPECT_EQ(report->directions[6].name, "scale");
  EXPECT_GT(report->directions[6].kappa, 1e-6);
  EXPECT_EQ(report->edges.size(), 9u) << "the relative poses";
  GaugeScene inertial(2, Options(GaugeGroup::kVisualInertial, true));
  report = CheckNullspace(&inertial.problem, {.group = GaugeGroup::kStereo});
  ASSERT_TRUE(report.ok());
  EXPECT_GT(report->directions[0].kappa, 1e-6) << "roll is observed through gravity";
}

TEST(Nullspace, LossesKeepIt) {
  GaugeScene scene(3, Options(GaugeGroup::kVisualInertial, true));
  int k = 0;
  for (const AnyEdge& edge : scene.problem.Edges()) {
    const Loss losses[] = {Loss(Huber{0.5}), Loss(Cauchy{1.0}), Loss()};
    ASSERT_TRUE(scene.problem.SetLoss(edge, losses[++k % 3]).ok());
  }
  const auto report = CheckNullspace(&scene.problem);
  ASSERT_TRUE(report.ok());
  EXPECT_LT(report->MaxKappa(), kRounding);
}

TEST(Nullspace, NamesThePosePrior) {
  for (const GaugeGroup group : kGroups) {
    GaugeScene scene(4, Options(group, true));
    EdgeOptions<EdgeSE3Prior> weight;
    weight.sqrt_information = 10.0 * Matrix6::Identity();
    const auto prior = scene.problem.AddEdge(EdgeSE3Prior{scene.problem.Get(scene.poses[3]).pose},
                                             {scene.poses[3]}, weight);
    const auto report = CheckNullspace(&scene.problem);
    ASSERT_TRUE(report.ok());
    ASSERT_EQ(report->edges.size(), 1u);
    EXPECT_EQ(report->edges[0].edge, AnyEdge(prior.value()));
    // Its part of kappa is all of it, and u'Hu is its information.
    const auto k = static_cast<std::size_t>(group == GaugeGroup::kVisualInertial ? 1 : 3);
    EXPECT_EQ(report->directions[k].name, "x");
    EXPECT_NEAR(report->directions[k].information, 100.0, 1e-3);
    EXPECT_NEAR(report->edges[0].kappa[k], report->directions[k].kappa,
                1e-6 * report->directions[k].kappa);
  }
}

TEST(Nullspace, NamesASpeedPriorForYawAlone) {
  GaugeScene scene(5);
  EdgeOptions<EdgeSpeedBiasPrior> weight;
  weight.sqrt_information = 10.0 * SquareMatrix<9>::Identity();
  const auto prior = scene.problem.AddEdge(EdgeSpeedBiasPrior{scene.problem.Get(scene.speeds[0])},
                                           {scene.speeds[0]}, weight);
  const auto report = CheckNullspace(&scene.problem);
  ASSERT_TRUE(report.ok());
  ASSERT_TRUE(Names(report.value(), prior.value()));
  EXPECT_GT(report->directions[0].kappa, 1e-12);
  for (std::size_t k = 1; k < 4; ++k)
    EXPECT_LT(report->directions[k].kappa, kRounding);
}

/// An observation of a known direction, which breaks the gauge.
struct EdgeSun {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 3;
  static constexpr bool kIsObservation = true;
  Vector3 sun_b = Vector3::UnitX();
  bool Evaluate(const VertexPose& pose, Vector3& r, Jacobian<3, 6>* J) const {
    const Vector3 sun = pose.pose.R().transpose() * Vector3(0.6, 0.0, 0.8);
    r = sun - sun_b;
    if (J != nullptr) {
      J->setZero();
      J->rightCols<3>() = so3::Hat(sun);
    }
    return true;
  }
};

TEST(Nullspace, NamesAnObservationOnlyIfNothingElseExplainsIt) {
  GaugeScene scene(6);
  EdgeOptions<EdgeSun> weight;
  weight.sqrt_information = 100.0 * Matrix3::Identity();
  const auto sun = scene.problem.AddEdge(EdgeSun{}, {scene.poses[2]}, weight);
  const auto report = CheckNullspace(&scene.problem);
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->edges.size(), 1u);
  EXPECT_EQ(report->edges[0].edge, AnyEdge(sun.value()));
  EXPECT_LT(report->directions[3].kappa, kRounding);
}

TEST(Nullspace, SaysWhatIsHeld) {
  GaugeScene scene(7);
  ASSERT_TRUE(scene.problem.SetFixed(scene.poses[0]).ok());
  ASSERT_TRUE(scene.problem.SetFixed(scene.poses[1], Fix::kPositionAndYaw).ok());
  ASSERT_TRUE(scene.problem.SetFixed(scene.speeds[1], Fix::kBiases).ok());
  const auto report = CheckNullspace(&scene.problem);
  ASSERT_TRUE(report.ok());
  const std::vector<AnyVertex> expected{scene.poses[1], scene.poses[0]};
  EXPECT_EQ(report->held, expected);
  EXPECT_GT(report->MaxKappa(), 1e-6);
  EXPECT_TRUE(report->edges.empty()) << "no edge breaks it";
}

// After a solve H belongs to the last state that was linearized, one step before the end.
TEST(Nullspace, FromTheLinearizationThatASolveLeft) {
  for (const GaugeGroup group : kGroups) {
    for (const bool inverse_depth : {true, false}) {
      GaugeScene scene(8, Options(group, inverse_depth));
      SolveOptions options;
      options.cost_tolerance = 1e-2;  // stops right after a large step
      ASSERT_EQ(scene.problem.Solve(options).termination, Termination::kConvergedCost);
      const auto left = scene.problem.CheckNullspace();
      ASSERT_TRUE(left.ok()) << left.status().message();
      EXPECT_LT(left->MaxKappa(), kRounding);
      EXPECT_TRUE(left->edges.empty());
      // Another linearization, not the same numbers.
      const auto fresh = CheckNullspace(&scene.problem);
      ASSERT_TRUE(fresh.ok());
      EXPECT_LT(fresh->MaxKappa(), kRounding);
    }
  }
}

TEST(Nullspace, AfterASolveInAGaugeItIsTheMeasurements) {
  GaugeScene scene(9);
  for (const Gauge& gauge :
       {Gauge(Gauge::Fixed{scene.poses[0]}), Gauge(Gauge::Prior{scene.poses[0]})}) {
    ASSERT_TRUE(scene.problem.Solve({.gauge = gauge}).ok());
    const auto report = scene.problem.CheckNullspace();
    ASSERT_TRUE(report.ok());
    EXPECT_LT(report->MaxKappa(), kRounding);
    EXPECT_TRUE(report->held.empty());
    EXPECT_TRUE(report->edges.empty());
  }
}

TEST(Nullspace, RefusesWhatIsNotLinearized) {
  GaugeScene scene(10);
  Structure structure;
  NormalEquations equations;
  EXPECT_EQ(CheckNullspace(scene.problem, structure, &equations).status().code(),
            StatusCode::kInvalidArgument);
  Graph empty;
  EXPECT_FALSE(CheckNullspace(&empty).ok());
}

/// A prior on poses 0, 1 and speed 0 with x0 off from the truth, J of the right null space at x0.
std::unique_ptr<EdgeMarginalPrior> PriorOn(const GaugeScene& scene, std::uint64_t seed,
                                           std::vector<AnyVertex>* vertices) {
  GraphRandom random(seed);
  *vertices = {scene.poses[0], scene.poses[1], scene.speeds[0]};
  std::vector<const VertexOps*> ops;
  std::vector<double> x0;
  for (const AnyVertex& vertex : *vertices) {
    const VertexPoolBase& pool = *scene.problem.PoolOf(vertex.type);
    ops.push_back(&pool.ops());
    std::vector<double> delta, state(static_cast<std::size_t>(pool.ops().ambient_dim));
    for (int k = 0; k < pool.ops().tangent_dim; ++k)
      delta.push_back(0.02 * random.Normal());
    pool.ops().plus(pool.Data(pool.slots().IndexOf(vertex.slot)), delta.data(), state.data());
    x0.insert(x0.end(), state.begin(), state.end());
  }
  Eigen::Matrix<double, 21, 4, Eigen::RowMajor> U;
  const Orbit orbit = Orbit::Of(scene.problem).value();
  orbit.Directions((*vertices)[0], x0.data(), U.data());
  orbit.Directions((*vertices)[1], x0.data() + 7, U.data() + 24);
  orbit.Directions((*vertices)[2], x0.data() + 14, U.data() + 48);
  Eigen::Matrix<double, 17, 21, Eigen::RowMajor> J;
  for (int k = 0; k < J.size(); ++k)
    J.data()[k] = 30.0 * random.Normal();
  J -= (J * U) * (U.transpose() * U).inverse() * U.transpose();
  std::vector<double> r0(17);
  for (double& r : r0)
    r = random.Normal();
  return std::move(EdgeMarginalPrior::Create(ops, x0, r0, std::span(J.data(), 17 * 21)).value());
}

// u is taken at x_lin. With active edges linearized there too (kFull) the null space is whole; with
// edges at x it is not, and the edges between vertices of the prior are named.
TEST(Nullspace, FirstEstimates) {
  for (const FirstEstimates mode : {FirstEstimates::kFull, FirstEstimates::kPriorOnly}) {
    GaugeScene scene(11);
    std::vector<AnyVertex> vertices;
    auto prior = PriorOn(scene, 12, &vertices);
    ASSERT_TRUE(scene.problem.AddEdge(std::move(prior), vertices).ok());
    scene.problem.SetFirstEstimates(mode);
    const auto report = CheckNullspace(&scene.problem);
    ASSERT_TRUE(report.ok());
    if (mode == FirstEstimates::kFull) {
      EXPECT_LT(report->MaxKappa(), kRounding);
      EXPECT_TRUE(report->edges.empty());
    } else {
      EXPECT_GT(report->directions[0].kappa, 1e-9);
      EXPECT_FALSE(report->edges.empty());
      for (const GaugeBreach& breach : report->edges) {
        EXPECT_NE(breach.edge.type, &kTypeInfo<DynamicEdge>) << "the prior is right";
      }
      for (std::size_t k = 1; k < 4; ++k)
        EXPECT_LT(report->directions[k].kappa, kRounding)
            << "translation does not depend on the point";
    }
  }
}

// A graph whose every edge sees the gauge made a list of them all.
TEST(Nullspace, EdgesAreCountedAndTheFirstOnesListed) {
  GaugeScene scene(21);
  for (const auto& pose : scene.poses) {
    ASSERT_TRUE(scene.problem.AddEdge(EdgeSE3Prior{scene.problem.Get(pose).pose}, {pose}).ok());
  }
  const auto all = scene.problem.CheckNullspace();
  ASSERT_TRUE(all.ok()) << all.status().message();
  EXPECT_EQ(all->num_edges, 10);
  EXPECT_EQ(all->edges.size(), 10u);
  const auto some = scene.problem.CheckNullspace({.max_edges = 3});
  ASSERT_TRUE(some.ok());
  EXPECT_EQ(some->num_edges, 10);
  ASSERT_EQ(some->edges.size(), 3u);
  EXPECT_EQ(some->edges[2].edge, all->edges[2].edge);
  EXPECT_FALSE(scene.problem.CheckNullspace({.max_edges = -1}).ok());
  EXPECT_FALSE(scene.problem.CheckNullspace({.tolerance = NAN}).ok());
}

// After a solve under a gauge, from a linearization without it: the same as without the solve.
TEST(Nullspace, AfterASolveUnderAGauge) {
  GaugeScene scene(22);
  ASSERT_TRUE(scene.problem.Solve(Converge(Gauge::Fixed{scene.poses[0]})).ok());
  const auto fresh = CheckNullspace(static_cast<Graph*>(&scene.problem));
  ASSERT_TRUE(fresh.ok());
  for (int turn = 0; turn < 2; ++turn) {
    const auto kept = scene.problem.CheckNullspace();
    ASSERT_TRUE(kept.ok());
    EXPECT_TRUE(kept->held.empty());
    for (std::size_t k = 0; k < kept->directions.size(); ++k)
      EXPECT_EQ(kept->directions[k].information, fresh->directions[k].information);
  }
}

}  // namespace
}  // namespace glissade::test
