// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "glissade/bridge/autodiff.h"
#include "glissade/bridge/ceres.h"
#include "glissade/bridge/cost_function_edge.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "glissade/testing/check_jacobians.h"
#include "support/dense_reference.h"
#include "support/graph_random.h"
#include "support/user_types.h"

// Ceres's cost functions, losses and Jets as edges and losses of a graph.

namespace glissade::bridge {
namespace {

using test::GraphRandom;

/// EdgeReprojectionXYZ with T_b_c = identity, as one would write it for Ceres.
struct ReprojectionFunctor {
  Vector2 uv;

  template <class T>
  bool operator()(const T* pose, const T* point, T* r) const {
    const T x = point[0] - pose[0], y = point[1] - pose[1], z = point[2] - pose[2];
    // q^-1 (x, y, z) q with q = (-u, w)
    const T ux = -pose[3], uy = -pose[4], uz = -pose[5], w = pose[6];
    const T tx = 2.0 * (uy * z - uz * y), ty = 2.0 * (uz * x - ux * z),
            tz = 2.0 * (ux * y - uy * x);
    const T bx = x + w * tx + (uy * tz - uz * ty);
    const T by = y + w * ty + (uz * tx - ux * tz);
    const T bz = z + w * tz + (ux * ty - uy * tx);
    if (bz == T(0.0)) return false;
    r[0] = bx / bz - uv[0];
    r[1] = by / bz - uv[1];
    return true;
  }
};

/// Of types the bridge does not know.
struct ScaledBearingFunctor {
  double measured;
  template <class T>
  bool operator()(const T* bearing, const T* scale, T* r) const {
    using std::sin;
    r[0] = scale[0] * bearing[0] - measured;
    r[1] = sin(scale[0]) * bearing[1] + bearing[2] * bearing[2];
    r[2] = bearing[0] * bearing[1];
    return true;
  }
};

/// Three vertices of one type, all of their coordinates told apart.
struct ThreePointsFunctor {
  template <class T>
  bool operator()(const T* a, const T* b, const T* c, T* r) const {
    r[0] = a[0] + 2.0 * a[1] * b[2] + c[0] * c[1];
    return true;
  }
  [[nodiscard]] Status Validate() const {
    return valid ? Status() : Status(StatusCode::kInvalidArgument, "not valid");
  }
  bool valid = true;
};

struct Bundle {
  std::vector<VertexPose> poses;
  std::vector<VertexPointXYZ> points;
  std::vector<std::vector<Vector2>> uv;  // [pose][point]

  explicit Bundle(std::uint64_t seed) {
    GraphRandom random(seed);
    for (int k = 0; k < 4; ++k) {
      poses.push_back({Pose(random.Rotation(0.3), random.Vec3(1.0))});
    }
    for (int l = 0; l < 15; ++l) {
      points.emplace_back(random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0),
                          random.Uniform(4.0, 8.0));
    }
    for (const VertexPose& pose : poses) {
      auto& row = uv.emplace_back();
      for (const VertexPointXYZ& point : points) {
        Vector2 r;
        EdgeReprojectionXYZ{}.Evaluate(pose, point, r, nullptr, nullptr);
        row.push_back(r + random.NormalVector<2>(0.003));
      }
    }
    for (VertexPose& pose : poses)
      pose.pose = random.Perturb(pose.pose, 0.02, 0.01);
    for (VertexPointXYZ& point : points)
      point.p() += random.NormalVector<3>(0.05);
  }

  /// add(problem, pose, point, uv) adds the edge.
  template <class Add>
  Problem Build(Add&& add) const {
    Problem problem;
    std::vector<VertexHandle<VertexPose>> pose_handles;
    std::vector<VertexHandle<VertexPointXYZ>> point_handles;
    for (const VertexPose& pose : poses)
      pose_handles.push_back(problem.AddVertex(pose));
    for (const VertexPointXYZ& point : points)
      point_handles.push_back(problem.AddVertex(point));
    EXPECT_TRUE(problem.SetFixed(pose_handles[0]).ok());
    EXPECT_TRUE(problem.SetFixed(pose_handles[1], Fix::kPosition).ok());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      for (std::size_t l = 0; l < points.size(); ++l)
        add(&problem, pose_handles[k], point_handles[l], uv[k][l]);
    }
    return problem;
  }
};

void ExpectSameEquationsAndOptimum(Problem* problem, Problem* reference) {
  ASSERT_TRUE(problem->MakeHessian().ok());
  ASSERT_TRUE(reference->MakeHessian().ok());
  // The same vertices in the same order; their handles are of two graphs.
  const auto ours = problem->FreeVertices(), theirs = reference->FreeVertices();
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t k = 0; k < ours.size(); ++k)
    EXPECT_EQ(ToString(ours[k]), ToString(theirs[k]));
  EXPECT_LT(test::HessianError(problem->Hessian(), reference->Hessian()), 1e-13);
  EXPECT_LT(test::RelativeError(problem->Rhs(), reference->Rhs()), 1e-12);
  const double cost = reference->Solve().final_cost;
  EXPECT_NEAR(problem->Solve().final_cost, cost, 1e-12 * cost);
}

void AddNative(Problem* problem, VertexHandle<VertexPose> pose, VertexHandle<VertexPointXYZ> point,
               const Vector2& uv) {
  EXPECT_TRUE(
      problem->AddEdge(EdgeReprojectionXYZ{uv, Pose(), {}}, {pose, point}, {.loss = Huber{0.004}})
          .ok());
}

TEST(CostFunctionEdge, EqualsTheTypedEdge) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Bundle bundle(seed);
    Problem native = bundle.Build(AddNative);
    Problem adapted =
        bundle.Build([](Problem* problem, AnyVertex pose, AnyVertex point, const Vector2& uv) {
          auto cost = std::make_shared<ceres::AutoDiffCostFunction<ReprojectionFunctor, 2, 7, 3>>(
              new ReprojectionFunctor{uv});
          EXPECT_TRUE(problem
                          ->AddEdge(std::make_unique<CostFunctionEdge>(cost),
                                    std::vector<AnyVertex>{pose, point}, Huber{0.004})
                          .ok());
        });
    ExpectSameEquationsAndOptimum(&adapted, &native);
  }
}

TEST(EdgeAutodiff, EqualsTheTypedEdge) {
  using EdgeAutodiffXYZ = EdgeAutodiff<ReprojectionFunctor, 2, VertexPose, VertexPointXYZ>;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Bundle bundle(seed);
    Problem native = bundle.Build(AddNative);
    Problem adapted = bundle.Build([](Problem* problem, VertexHandle<VertexPose> pose,
                                      VertexHandle<VertexPointXYZ> point, const Vector2& uv) {
      const EdgeAutodiffXYZ edge{{uv}};
      EXPECT_TRUE(problem->AddEdge(edge, {pose, point}, {.loss = Huber{0.004}}).ok());
    });
    ExpectSameEquationsAndOptimum(&adapted, &native);
  }
}

// There and back: a Ceres cost function in a graph, exported to Ceres.
TEST(CostFunctionEdge, SurvivesExport) {
  const Bundle bundle(3);
  Problem native = bundle.Build(AddNative);
  Problem mixed =
      bundle.Build([&, count = 0](Problem* problem, VertexHandle<VertexPose> pose,
                                  VertexHandle<VertexPointXYZ> point, const Vector2& uv) mutable {
        if (++count % 2 == 0) return AddNative(problem, pose, point, uv);
        auto cost = std::make_shared<ceres::AutoDiffCostFunction<ReprojectionFunctor, 2, 7, 3>>(
            new ReprojectionFunctor{uv});
        EXPECT_TRUE(problem
                        ->AddEdge(std::make_unique<CostFunctionEdge>(cost),
                                  std::vector<AnyVertex>{pose, point}, Huber{0.004})
                        .ok());
      });
  ASSERT_TRUE(mixed.MakeHessian().ok());
  const CeresProblem exported = Export(mixed);
  const auto ceres = Linearize(exported, mixed.FreeVertices());
  ASSERT_TRUE(ceres.ok());
  EXPECT_LT(test::HessianError(mixed.Hessian(), ceres->Hessian()), 1e-13);
  EXPECT_NEAR(mixed.Solve().final_cost, native.Solve().final_cost, 1e-12 * native.Cost().value());
}

TEST(CostFunctionEdge, OnTypesOfAUsersOwn) {
  GraphRandom random(9);
  auto cost = std::make_shared<ceres::AutoDiffCostFunction<ScaledBearingFunctor, 3, 3, 1>>(
      new ScaledBearingFunctor{0.7});
  const CostFunctionEdge edge(cost);
  const EdgeAutodiff<ScaledBearingFunctor, 3, test::VertexBearing, test::VertexScale> typed{{0.7}};
  for (int trial = 0; trial < 20; ++trial) {
    test::VertexBearing bearing;
    const Vector3 d = random.Direction();
    std::copy_n(d.data(), 3, bearing.data);
    const test::VertexScale scale{random.Uniform(0.5, 2.0)};
    // The checker differentiates along Plus.
    const JacobianCheck check = CheckJacobians(typed, bearing, scale);
    EXPECT_TRUE(check.ok) << check.message;
    Vector3 r, r_dynamic;
    Jacobian<3, 2> J0, J0_dynamic;
    Jacobian<3, 1> J1, J1_dynamic;
    ASSERT_TRUE(typed.Evaluate(bearing, scale, r, &J0, &J1));
    const VertexRef refs[] = {{&kVertexOps<test::VertexBearing>, bearing.Data()},
                              {&kVertexOps<test::VertexScale>, scale.Data()}};
    double* jacobians[] = {J0_dynamic.data(), J1_dynamic.data()};
    ASSERT_TRUE(edge.Evaluate(refs, r_dynamic.data(), jacobians));
    EXPECT_EQ(r, r_dynamic);
    EXPECT_LT((J0 - J0_dynamic).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((J1 - J1_dynamic).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(EdgeAutodiff, KeepsVerticesApart) {
  const EdgeAutodiff<ThreePointsFunctor, 1, VertexPointXYZ, VertexPointXYZ, VertexPointXYZ> edge{};
  const VertexPointXYZ a(1, 2, 3), b(4, 5, 6), c(7, 8, 9);
  const JacobianCheck check = CheckJacobians(edge, a, b, c);
  EXPECT_TRUE(check.ok) << check.message;
  Vector<1> r;
  Jacobian<1, 3> J_a, J_b, J_c;
  ASSERT_TRUE(edge.Evaluate(a, b, c, r, &J_a, nullptr, &J_c));
  EXPECT_EQ(r[0], 1.0 + 2.0 * 2.0 * 6.0 + 56.0);
  EXPECT_EQ(J_a, (Jacobian<1, 3>(1.0, 12.0, 0.0)));
  EXPECT_EQ(J_c, (Jacobian<1, 3>(8.0, 7.0, 0.0)));
}

TEST(EdgeAutodiff, ReprojectionJacobians) {
  GraphRandom random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const VertexPose pose{random.RandomPose(3.0)};
    const VertexPointXYZ point(pose.pose * Vector3(0.3, -0.4, random.Uniform(1.0, 5.0)));
    const EdgeAutodiff<ReprojectionFunctor, 2, VertexPose, VertexPointXYZ> edge{{{0.1, 0.2}}};
    const JacobianCheck check = CheckJacobians(edge, pose, point);
    EXPECT_TRUE(check.ok) << check.message;
  }
}

TEST(EdgeAutodiff, NoValueAndValidate) {
  const EdgeAutodiff<ReprojectionFunctor, 2, VertexPose, VertexPointXYZ> edge{{{0.1, 0.2}}};
  Vector2 r;
  Jacobian<2, 6> J;
  EXPECT_FALSE(edge.Evaluate(VertexPose{}, VertexPointXYZ(1, 1, 0), r, nullptr, nullptr));
  EXPECT_FALSE(edge.Evaluate(VertexPose{}, VertexPointXYZ(1, 1, 0), r, &J, nullptr));

  Graph graph;
  VertexHandle<VertexVector<3>> v[3];
  for (auto& handle : v)
    handle = graph.AddVertex(VertexVector<3>{});
  using Edge =
      EdgeAutodiff<ThreePointsFunctor, 1, VertexVector<3>, VertexVector<3>, VertexVector<3>>;
  EXPECT_TRUE(graph.AddEdge(Edge{{.valid = true}}, {v[0], v[1], v[2]}).ok());
  EXPECT_EQ(graph.AddEdge(Edge{{.valid = false}}, {v[0], v[1], v[2]}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(CostFunctionEdge, ChecksItsVertices) {
  Graph graph;
  const VertexHandle<VertexPose> pose = graph.AddVertex(VertexPose{});
  const VertexHandle<VertexPointXYZ> point = graph.AddVertex(VertexPointXYZ(0, 0, 3));
  auto cost = std::make_shared<ceres::AutoDiffCostFunction<ReprojectionFunctor, 2, 7, 3>>(
      new ReprojectionFunctor{});
  const auto add = [&](std::shared_ptr<const ceres::CostFunction> function,
                       const std::vector<AnyVertex>& vertices) {
    return graph.AddEdge(std::make_unique<CostFunctionEdge>(std::move(function)), vertices)
        .status()
        .code();
  };
  EXPECT_EQ(add(cost, {pose, point}), StatusCode::kOk);
  EXPECT_EQ(add(cost, {point, pose}), StatusCode::kInvalidArgument);
  EXPECT_EQ(add(cost, {pose}), StatusCode::kInvalidArgument);
  EXPECT_EQ(add(nullptr, {pose, point}), StatusCode::kInvalidArgument);
  EXPECT_EQ(graph.NumEdges(), 1);
}

TEST(CeresLoss, IsTheLoss) {
  const ceres::HuberLoss huber(1.5);
  const Loss loss = CeresLoss{&huber};
  const Loss own = Huber{1.5};
  for (const double s : {0.0, 0.5, 2.0, 2.25, 2.5, 100.0}) {
    double a[3], b[3];
    loss.Evaluate(s, a);
    own.Evaluate(s, b);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(a[k], b[k], 1e-14 * std::max(1.0, std::abs(b[k])));
  }
  EXPECT_EQ(Loss(CeresLoss{}).Validate().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade::bridge
