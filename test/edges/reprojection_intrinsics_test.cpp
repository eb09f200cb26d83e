// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Edges whose intrinsics are a vertex: against cameras whose intrinsics are constants, against
// numeric derivatives, and their normal equations against dense ones.
#include "glissade/edges/reprojection_intrinsics.h"

#include <gtest/gtest.h>

#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "edges/edge_test_util.h"
#include "glissade/cameras/kannala_brandt.h"
#include "glissade/cameras/radtan.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "support/dense_reference.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

static_assert(EdgeType<EdgeReprojectionRadial>);
static_assert(EdgeType<EdgeReprojectionRadtan>);
static_assert(EdgeType<EdgeReprojectionFisheye>);
static_assert(kEvaluatesInPacks<EdgeReprojectionFisheye>);

/// What the library has of the same camera as a constant.
CameraRadtan Constant(const EdgeReprojectionRadial::Intrinsics& k, IntrinsicsRadial) {
  return {{k.value[0], k.value[0], k.value[1], k.value[2]}, k.value[3], k.value[4]};
}
CameraRadtan Constant(const EdgeReprojectionRadtan::Intrinsics& k, IntrinsicsRadtan) {
  return {{k.value[0], k.value[1], k.value[2], k.value[3]},
          k.value[4],
          k.value[5],
          k.value[6],
          k.value[7]};
}
CameraKannalaBrandt Constant(const EdgeReprojectionFisheye::Intrinsics& k, IntrinsicsFisheye) {
  return {{k.value[0], k.value[1], k.value[2], k.value[3]},
          k.value[4],
          k.value[5],
          k.value[6],
          k.value[7]};
}

void MakeIntrinsics(Random& random, VertexVector<5>& k) {
  k.value = {random.Uniform(300, 800), random.Uniform(200, 400), random.Uniform(200, 400),
             random.Uniform(-0.2, 0.2), random.Uniform(-0.05, 0.05)};
}
void MakeIntrinsics(Random& random, VertexVector<8>& k) {
  k.value = {random.Uniform(300, 800), random.Uniform(300, 800), random.Uniform(200, 400),
             random.Uniform(200, 400)};
  const double size[4] = {0.1, 0.03, 0.01, 0.01};
  for (std::size_t i = 0; i < 4; ++i)
    k.value[4 + i] = random.Uniform(-size[i], size[i]);
}

template <class Model>
struct OneView {
  using Edge = EdgeReprojectionIntrinsicsOf<Model>;
  VertexPose pose;
  VertexPointXYZ point;
  typename Edge::Intrinsics intrinsics;
  Edge edge;

  OneView(Random& random, double angle, const Vector3& p_c) {
    pose.pose = random.RandomPose(2.0, angle);
    edge.T_b_c = random.RandomPose(0.3);
    edge.uv = Vector2(300.0, 250.0) + random.Vec2(100.0);
    MakeIntrinsics(random, intrinsics);
    point = VertexPointXYZ(pose.pose * (edge.T_b_c * p_c));
  }

  void Check() const {
    Vector2 r, expected;
    const auto camera = Constant(intrinsics, Model{});
    const EdgeReprojectionXYZOf<std::remove_const_t<decltype(camera)>> constant{edge.uv, edge.T_b_c,
                                                                                camera};
    ASSERT_TRUE(constant.Evaluate(pose, point, expected, nullptr, nullptr));
    ASSERT_TRUE(edge.Evaluate(pose, point, intrinsics, r, nullptr, nullptr, nullptr));
    EXPECT_LT((r - expected).norm(), 1e-9);
    ExpectJacobians(edge, pose, point, intrinsics);
    EXPECT_DOUBLE_EQ(edge.Depth(pose, point, intrinsics), constant.Depth(pose, point));
  }
};

template <class Model>
class EdgeReprojectionIntrinsics : public testing::Test {};
using Models = testing::Types<IntrinsicsRadial, IntrinsicsRadtan, IntrinsicsFisheye>;
TYPED_TEST_SUITE(EdgeReprojectionIntrinsics, Models);

TYPED_TEST(EdgeReprojectionIntrinsics, IsTheCameraWithConstantIntrinsics) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3 p_c(random.Uniform(-3, 3), random.Uniform(-3, 3), random.Uniform(3, 9));
    OneView<TypeParam>(random, random.Uniform(0.0, 3.1), p_c).Check();
  }
  for (const double angle : test::kSpecialAngles) {
    SCOPED_TRACE(angle);
    OneView<TypeParam>(random, angle, Vector3(0.4, -0.7, 2.0)).Check();
  }
  // Behind the camera, and close to the axis, where the fisheye has another formula.
  OneView<TypeParam>(random, 1.0, Vector3(1.0, 2.0, -5.0)).Check();
  OneView<TypeParam>(random, 1.0, Vector3(1e-4, -2e-4, 2.0)).Check();
}

TEST(EdgeReprojectionFisheye, OnTheAxisAndBesideIt) {
  // Pose and extrinsic are the identity, so that the point is where it is said to be.
  VertexVector<8> k{{500, 510, 320, 240, 0.05, -0.02, 0.01, 0.003}};
  const EdgeReprojectionFisheye edge;
  for (const double x : {0.0, 1e-9, 0.99e-5, 1.01e-5, 1e-4}) {
    SCOPED_TRACE(x);
    ExpectJacobians(edge, VertexPose{}, VertexPointXYZ(x, 0.0, 1.0), k);
  }
  ExpectJacobians(edge, VertexPose{}, VertexPointXYZ(1.0, 1.0, 0.0), k);  // 90 degrees
  Vector2 r;
  EXPECT_FALSE(
      edge.Evaluate(VertexPose{}, VertexPointXYZ(0, 0, -1), k, r, nullptr, nullptr, nullptr));
}

TEST(EdgeReprojectionIntrinsics, NoValueInTheCameraPlane) {
  Vector2 r;
  EXPECT_FALSE(EdgeReprojectionRadial{}.Evaluate(VertexPose{}, VertexPointXYZ(1, 2, 0),
                                                 VertexVector<5>{{500, 0, 0, 0, 0}}, r, nullptr,
                                                 nullptr, nullptr));
  EXPECT_FALSE(EdgeReprojectionRadtan{}.Evaluate(VertexPose{}, VertexPointXYZ(1, 2, 0),
                                                 VertexVector<8>{{500, 500, 0, 0, 0, 0, 0, 0}}, r,
                                                 nullptr, nullptr, nullptr));
}

TEST(EdgeReprojectionIntrinsics, RefusesWhatIsNotFinite) {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose{});
  const auto point = problem.AddVertex(VertexPointXYZ(0, 0, 1));
  const auto k = problem.AddVertex(VertexVector<5>{{500, 0, 0, 0, 0}});
  EdgeReprojectionRadial edge;
  edge.uv[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(problem.AddEdge(edge, {pose, point, k}).status().code(), StatusCode::kNotFinite);
  edge = {};
  edge.T_b_c.data[6] = 0.5;
  EXPECT_FALSE(problem.AddEdge(edge, {pose, point, k}).ok());
}

/// Images that share intrinsics, with a second camera on the same body and one that is held in
/// part.
template <class Model>
void Build(std::uint64_t seed, Problem* problem) {
  using Edge = EdgeReprojectionIntrinsicsOf<Model>;
  Random random(seed);
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<typename Edge::Intrinsics>> cameras;
  for (int k = 0; k < 6; ++k) {
    poses.push_back(
        problem->AddVertex(VertexPose{random.RandomPose(0.5, random.Uniform(0.0, 0.3))}));
  }
  for (int k = 0; k < 3; ++k) {
    typename Edge::Intrinsics intrinsics;
    MakeIntrinsics(random, intrinsics);
    cameras.push_back(problem->AddVertex(intrinsics));
  }
  ASSERT_TRUE(problem->SetFixedNumbers(cameras[1], 0b00100).ok());
  ASSERT_TRUE(problem->SetFixed(cameras[2]).ok());
  ASSERT_TRUE(problem->SetFixed(poses[0], Fix::kPosition).ok());
  const Pose second(so3::ExpQuaternion(Vector3(0.02, 0.1, 0.0)), Vector3(0.2, 0.0, 0.0));
  for (int l = 0; l < 40; ++l) {
    const auto point = problem->AddVertex(
        VertexPointXYZ(random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(5, 9)));
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (random.Uniform(0, 1) < 0.3) continue;
      Edge edge;
      edge.uv = Vector2(300.0, 250.0) + random.Vec2(100.0);
      if (random.Uniform(0, 1) < 0.5) edge.T_b_c = second;
      Loss loss;
      if (l % 3 == 0) loss = Huber{20.0};
      ASSERT_TRUE(problem->AddEdge(edge, {poses[k], point, cameras[k % 3]}, {.loss = loss}).ok());
    }
    // Points that are eliminated in groups beside them: a vertex of 8 numbers among the poses.
    if (l % 4 != 0) continue;
    const auto grouped = problem->AddVertex(
        VertexPointXYZ(random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(5, 9)));
    for (const auto pose : poses) {
      const EdgeReprojectionXYZ edge{random.Vec2(0.3), Pose()};
      ASSERT_TRUE(
          problem->AddEdge(edge, {pose, grouped}, {.sqrt_information = 500.0 * Matrix2::Identity()})
              .ok());
    }
  }
}

TYPED_TEST(EdgeReprojectionIntrinsics, NormalEquationsAreTheDenseOnes) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem;
    ASSERT_NO_FATAL_FAILURE(Build<TypeParam>(seed, &problem));
    ASSERT_TRUE(problem.MakeHessian().ok());
    const test::DenseReference dense(problem, problem.FreeVertices());
    const Eigen::MatrixXd H = problem.Hessian();
    ASSERT_EQ(H.rows(), dense.J.cols());
    EXPECT_LT(test::HessianError(H, dense.H()), 1e-12);
    EXPECT_LT(test::RelativeError(problem.Rhs(), dense.b()), 1e-11);
    ASSERT_TRUE(problem.SolveLinearSystem(1e-3).ok());
    const Eigen::VectorXd step =
        test::DampedStep(dense.J, dense.r, test::MarquardtDamping(dense.J, 1e-3));
    EXPECT_LT(test::RelativeError(problem.Step(), step), 1e-8);
  }
}

TYPED_TEST(EdgeReprojectionIntrinsics, EvaluatesInPacks) {
  Problem problem;
  ASSERT_NO_FATAL_FAILURE(Build<TypeParam>(4, &problem));
  const SolveSummary& summary = problem.Solve({.max_iterations = 2});
  ASSERT_TRUE(summary.ok()) << summary.BriefReport();
  const auto name = std::string_view(kTypeInfo<EdgeReprojectionIntrinsicsOf<TypeParam>>.name);
  bool found = false;
  for (const EdgeEvaluation& edges : summary.edges) {
    // ... beside points in groups, which see the poses alone.
    if (edges.type == kTypeInfo<EdgeReprojectionXYZ>.name) {
      EXPECT_GT(edges.as_twists, 0);
    }
    if (edges.type != name) continue;
    found = true;
    EXPECT_GT(edges.in_packs, 100);
    EXPECT_EQ(edges.one_by_one, 0);
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace glissade
