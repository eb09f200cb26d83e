// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/bridge/manifold.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "bridge/vertex_manifold.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"
#include "support/dynamic_edges.h"
#include "support/graph_random.h"
#include "support/user_types.h"

namespace glissade::bridge {
namespace {

using test::GraphRandom;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class V>
V RandomVertex(GraphRandom* random) {
  V v;
  if constexpr (std::is_same_v<V, VertexPose>) {
    v.pose = random->RandomPose(5.0);
  } else if constexpr (std::is_same_v<V, test::VertexScale>) {
    v.s = random->Uniform(0.2, 5.0);
  } else {
    for (int i = 0; i < V::kAmbientDim; ++i)
      v.Data()[i] = random->Uniform(-2.0, 2.0);
    if constexpr (std::is_same_v<V, test::VertexBearing>) {
      const Vector3 d = v.d().normalized();
      std::copy_n(d.data(), 3, v.data);
    }
  }
  return v;
}

Eigen::VectorXd RandomDelta(int n, GraphRandom* random) {
  Eigen::VectorXd delta(n);
  for (int i = 0; i < n; ++i)
    delta[i] = random->Uniform(-0.5, 0.5);
  return delta;
}

template <class V>
class ManifoldTest : public testing::Test {};
using VertexTypes = testing::Types<VertexPose, VertexPointXYZ, VertexInverseDepth, VertexCameraBal,
                                   VertexSpeedBias, VertexVector<1>, VertexVector<7>,
                                   test::VertexBearing, test::VertexScale, test::VertexLine>;
TYPED_TEST_SUITE(ManifoldTest, VertexTypes);

// What Ceres asks of a manifold (ceres/manifold.h), on Ceres's side of the bridge.
TYPED_TEST(ManifoldTest, CeresAxioms) {
  GraphRandom random(5);
  const VertexManifold manifold(kVertexOps<TypeParam>);
  const int ambient = manifold.AmbientSize(), tangent = manifold.TangentSize();
  for (int trial = 0; trial < 20; ++trial) {
    const TypeParam vertex = RandomVertex<TypeParam>(&random);
    const double* x = vertex.Data();
    const Eigen::VectorXd delta = RandomDelta(tangent, &random);
    Eigen::VectorXd y(ambient), again(ambient), back(tangent);
    ASSERT_TRUE(manifold.Plus(x, delta.data(), y.data()));
    ASSERT_TRUE(manifold.Minus(y.data(), x, back.data()));
    EXPECT_LT((back - delta).norm(), 1e-12);
    ASSERT_TRUE(manifold.Plus(x, back.data(), again.data()));
    EXPECT_LT((again - y).norm(), 1e-12 * (1.0 + y.norm()));
    ASSERT_TRUE(manifold.Minus(x, x, back.data()));
    EXPECT_LT(back.norm(), 1e-15);

    // d(y boxminus x)/dy at y = x, in every ambient direction, also out of the manifold.
    RowMajorMatrix minus(tangent, ambient);
    ASSERT_TRUE(manifold.MinusJacobian(x, minus.data()));
    for (int i = 0; i < ambient; ++i) {
      const double step = 1e-5;
      Eigen::VectorXd ahead(tangent), behind(tangent);
      std::copy_n(x, TypeParam::kAmbientDim, y.data());
      y[i] += step;
      manifold.Minus(y.data(), x, ahead.data());
      y[i] -= 2.0 * step;
      manifold.Minus(y.data(), x, behind.data());
      EXPECT_LT(((ahead - behind) / (2.0 * step) - minus.col(i)).cwiseAbs().maxCoeff(), 1e-8);
    }
    // As Ceres applies it to an ambient Jacobian.
    const RowMajorMatrix J = RowMajorMatrix::Random(3, ambient);
    RowMajorMatrix plus(ambient, tangent), product(3, tangent);
    ASSERT_TRUE(manifold.PlusJacobian(x, plus.data()));
    ASSERT_TRUE(manifold.RightMultiplyByPlusJacobian(x, 3, J.data(), product.data()));
    EXPECT_LT((product - J * plus).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// What the bridge needs to rounding: a tangent Jacobian comes back from its ambient detour as it
// was.
TYPED_TEST(ManifoldTest, MinusJacobianInvertsPlusJacobian) {
  GraphRandom random(6);
  const VertexOps& ops = kVertexOps<TypeParam>;
  for (int trial = 0; trial < 50; ++trial) {
    const TypeParam x = RandomVertex<TypeParam>(&random);
    RowMajorMatrix plus(ops.ambient_dim, ops.tangent_dim), minus(ops.tangent_dim, ops.ambient_dim);
    PlusJacobian(ops, x.Data(), plus.data());
    MinusJacobian(ops, x.Data(), minus.data());
    const RowMajorMatrix identity = RowMajorMatrix::Identity(ops.tangent_dim, ops.tangent_dim);
    EXPECT_LT((minus * plus - identity).cwiseAbs().maxCoeff(), 4e-15);
  }
}

// Against closed forms that the bridge does not know.
TYPED_TEST(ManifoldTest, PlusJacobianIsExact) {
  GraphRandom random(7);
  const VertexOps& ops = kVertexOps<TypeParam>;
  for (int trial = 0; trial < 50; ++trial) {
    const TypeParam x = RandomVertex<TypeParam>(&random);
    RowMajorMatrix plus(ops.ambient_dim, ops.tangent_dim), exact(ops.ambient_dim, ops.tangent_dim);
    PlusJacobian(ops, x.Data(), plus.data());
    test::TangentBasis({&ops, x.Data()}, exact.data());
    EXPECT_LT((plus - exact).cwiseAbs().maxCoeff(), 1e-11 * exact.cwiseAbs().maxCoeff());
  }
}

TEST(Manifold, AdditiveTypesNeedNone) {
  EXPECT_EQ(MakeManifold(kVertexOps<VertexPointXYZ>), nullptr);
  EXPECT_EQ(MakeManifold(kVertexOps<VertexInverseDepth>), nullptr);
  EXPECT_EQ(MakeManifold(kVertexOps<VertexCameraBal>), nullptr);
  EXPECT_EQ(MakeManifold(kVertexOps<VertexSpeedBias>), nullptr);
  EXPECT_EQ(MakeManifold(kVertexOps<VertexVector<1>>), nullptr);
  EXPECT_EQ(MakeManifold(kVertexOps<VertexVector<15>>), nullptr);
  EXPECT_NE(MakeManifold(kVertexOps<VertexPose>), nullptr);
  // As many numbers as degrees of freedom does not make a type additive.
  EXPECT_NE(MakeManifold(kVertexOps<test::VertexScale>), nullptr);
  EXPECT_NE(MakeManifold(kVertexOps<test::VertexLine>), nullptr);  // it is, but nobody knows
}

TEST(Manifold, RotationOnlyPose) {
  GraphRandom random(8);
  const RotationOnlyManifold manifold;
  ASSERT_EQ(manifold.AmbientSize(), 7);
  ASSERT_EQ(manifold.TangentSize(), 3);
  for (int trial = 0; trial < 20; ++trial) {
    const VertexPose x{random.RandomPose(5.0)};
    const Eigen::Vector3d delta = RandomDelta(3, &random);
    double y[7], back[3];
    ASSERT_TRUE(manifold.Plus(x.Data(), delta.data(), y));
    EXPECT_TRUE(std::equal(y, y + 3, x.Data()));
    ASSERT_TRUE(manifold.Minus(y, x.Data(), back));
    EXPECT_LT((Eigen::Map<Eigen::Vector3d>(back) - delta).norm(), 1e-14);
    Eigen::Matrix<double, 7, 3, Eigen::RowMajor> plus;
    Eigen::Matrix<double, 3, 7, Eigen::RowMajor> minus;
    Eigen::Matrix<double, 7, 6, Eigen::RowMajor> full;
    manifold.PlusJacobian(x.Data(), plus.data());
    manifold.MinusJacobian(x.Data(), minus.data());
    PlusJacobian(kVertexOps<VertexPose>, x.Data(), full.data());
    EXPECT_LT((plus - full.rightCols<3>()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((minus * plus - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 4e-15);
  }
}

}  // namespace
}  // namespace glissade::bridge
