// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Jacobians with first estimates against their definition: d(residual)/d(relative pose) at x by
// differences, times d(relative pose)/d(poses) at x_lin by differences.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "common/random_states.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/graph/pools.h"
#include "glissade/lie/so3.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kStep = 1e-5;

/// [rho, phi] of T' = (Exp(phi), rho) T.
Vector6 LeftDifference(const Pose& moved, const Pose& from) {
  const Pose d = moved * from.Inverse();
  Vector6 twist;
  twist.head<3>() = d.p();
  twist.tail<3>() = so3::Log(Quaternion(d.q()));
  return twist;
}
Pose LeftMoved(const Pose& T, const Vector6& d) {
  return Pose(so3::ExpQuaternion(Vector3(d.tail<3>())), Vector3(d.head<3>())) * T;
}

/// d(T_b^-1 T_a)/d(pose a), d(pose b), left twists, at the given poses.
std::array<Eigen::Matrix<double, 6, 6>, 2> RelativePoseJacobians(const VertexPose& a,
                                                                 const VertexPose& b) {
  std::array<Eigen::Matrix<double, 6, 6>, 2> J;
  const Pose at = b.pose.Inverse() * a.pose;
  for (int which = 0; which < 2; ++which) {
    for (int c = 0; c < 6; ++c) {
      Vector6 twist[2];
      for (int sign = 0; sign < 2; ++sign) {
        VertexPose moved[2] = {a, b};
        double d[6] = {};
        d[c] = sign == 0 ? kStep : -kStep;
        moved[which].Plus(d);
        twist[sign] = LeftDifference(moved[1].pose.Inverse() * moved[0].pose, at);
      }
      J[static_cast<std::size_t>(which)].col(c) = (twist[0] - twist[1]) / (2.0 * kStep);
    }
  }
  return J;
}

class TwoPoses : public ::testing::Test {
 protected:
  void SetUp() override {
    test::Random random(4);
    a.pose = random.RandomPose(0.3, 0.2);
    b.pose = random.RandomPose(0.3, 0.2);
    a_lin = a;
    b_lin = b;
    double d[6];
    for (VertexPose* pose : {&a_lin, &b_lin}) {
      for (double& x : d)
        x = random.Uniform(-0.1, 0.1);
      pose->Plus(d);
    }
    pose_a = graph.AddVertex(a).value();
    pose_b = graph.AddVertex(b).value();
    ASSERT_TRUE(graph.SetFirstEstimate(pose_a, {a_lin.Data(), 7}).ok());
    ASSERT_TRUE(graph.SetFirstEstimate(pose_b, {b_lin.Data(), 7}).ok());
  }

  /// Residual and Jacobians of the only edge of a pool.
  template <class E>
  Eigen::VectorXd Evaluate(std::vector<RowMajor>* J) {
    const EdgePoolBase& pool = *graph.EdgePoolOf(&kTypeInfo<E>);
    std::vector<double*> blocks;
    J->clear();
    for (int i = 0; i < pool.arity(0); ++i) {
      J->emplace_back(
          RowMajor::Zero(pool.residual_dim(0), pool.vertex_pool(0, i)->ops().tangent_dim));
    }
    for (RowMajor& block : *J)
      blocks.push_back(block.data());
    return EvaluateBlocks<E>(blocks);
  }
  /// The same, of the Jacobians that are not null.
  template <class E>
  Eigen::VectorXd EvaluateBlocks(std::span<double* const> blocks) {
    const EdgePoolBase& pool = *graph.EdgePoolOf(&kTypeInfo<E>);
    Eigen::VectorXd r(pool.residual_dim(0));
    std::vector<const double*> states, points;
    for (int i = 0; i < pool.arity(0); ++i) {
      const VertexPoolBase& vertices = *pool.vertex_pool(0, i);
      const int index = vertices.slots().IndexOf(pool.vertex_slot(0, i));
      states.push_back(vertices.Data(index));
      points.push_back(vertices.first_estimates().At(index));
    }
    EXPECT_TRUE(pool.EvaluateAt(0, states.data(), points.data(), r.data(), blocks.data()));
    return r;
  }

  Graph graph;
  VertexPose a, b, a_lin, b_lin;
  VertexHandle<VertexPose> pose_a, pose_b;
};

/// f(T_b_a) by moving pose a so that the relative pose is the given one.
template <class F>
RowMajor RelativeDerivative(const VertexPose& a, const VertexPose& b, int rows, F&& f) {
  RowMajor d(rows, 6);
  const Pose at = b.pose.Inverse() * a.pose;
  for (int c = 0; c < 6; ++c) {
    Eigen::VectorXd value[2];
    for (int sign = 0; sign < 2; ++sign) {
      Vector6 step = Vector6::Zero();
      step[c] = sign == 0 ? kStep : -kStep;
      value[sign] = f(VertexPose{b.pose * LeftMoved(at, step)}, b);
    }
    d.col(c) = (value[0] - value[1]) / (2.0 * kStep);
  }
  return d;
}

TEST_F(TwoPoses, ReprojectionTakesTheRelativePoseAtXAndThePosesAtTheirFirstEstimates) {
  EdgeReprojection edge;
  edge.uv_host = Vector2(0.2, -0.1);
  edge.uv_target = Vector2(0.1, 0.1);
  edge.T_b_c = Pose(so3::ExpQuaternion(Vector3(0.1, 0.2, -0.3)), Vector3(0.1, 0.0, 0.05));
  const VertexInverseDepth depth{0.4};
  const auto rho = graph.AddVertex(depth);
  const double far = 0.1;
  ASSERT_TRUE(graph.SetFirstEstimate(rho.value(), {&far, 1}).ok());  // does not count
  ASSERT_TRUE(graph.AddEdge(edge, {pose_a, pose_b, rho}).ok());
  std::vector<RowMajor> J;
  const Eigen::VectorXd r = Evaluate<EdgeReprojection>(&J);

  Vector2 at_x;
  Jacobian<2, 1> d_r_d_rho;
  ASSERT_TRUE(edge.Evaluate(a, b, depth, at_x, nullptr, nullptr, &d_r_d_rho));
  EXPECT_EQ(r[0], at_x[0]);
  EXPECT_EQ(r[1], at_x[1]);
  EXPECT_LT((J[2] - d_r_d_rho).norm(), 1e-14);
  const RowMajor d_r_d_rel =
      RelativeDerivative(a, b, 2, [&](const VertexPose& host, const VertexPose& target) {
        Vector2 value;
        EXPECT_TRUE(edge.Evaluate(host, target, depth, value, nullptr, nullptr, nullptr));
        return Eigen::VectorXd(value);
      });
  const auto d_rel = RelativePoseJacobians(a_lin, b_lin);
  EXPECT_LT((J[0] - d_r_d_rel * d_rel[0]).norm(), 1e-8);
  EXPECT_LT((J[1] - d_r_d_rel * d_rel[1]).norm(), 1e-8);
  // And that is another thing than the derivative at x.
  EXPECT_GT((J[0] - d_r_d_rel * RelativePoseJacobians(a, b)[0]).norm(), 1e-3);
}

TEST_F(TwoPoses, RelativePoseLikewise) {
  EdgeRelativePose edge;
  test::Random random(8);
  edge.T_i_j = random.RandomPose(0.3, 0.3);
  ASSERT_TRUE(graph.AddEdge(edge, {pose_a, pose_b}).ok());
  std::vector<RowMajor> J;
  Evaluate<EdgeRelativePose>(&J);
  const RowMajor d_r_d_rel =
      RelativeDerivative(a, b, 6, [&](const VertexPose& i, const VertexPose& j) {
        Vector6 value;
        EXPECT_TRUE(edge.Evaluate(i, j, value, nullptr, nullptr));
        return Eigen::VectorXd(value);
      });
  const auto d_rel = RelativePoseJacobians(a_lin, b_lin);
  EXPECT_LT((J[0] - d_r_d_rel * d_rel[0]).norm(), 1e-8);
  EXPECT_LT((J[1] - d_r_d_rel * d_rel[1]).norm(), 1e-8);
}

TEST_F(TwoPoses, PointsTakeTheirOwnFirstEstimate) {
  const VertexPointXYZ x(0.3, -0.2, 4.0), x_lin(0.35, -0.1, 4.2);
  const auto point = graph.AddVertex(x);
  ASSERT_TRUE(graph.SetFirstEstimate(point.value(), {x_lin.Data(), 3}).ok());
  const EdgeReprojectionXYZ edge;
  ASSERT_TRUE(graph.AddEdge(edge, {pose_a, point}).ok());
  std::vector<RowMajor> J;
  Evaluate<EdgeReprojectionXYZ>(&J);
  // d(point in body)/d(pose), d(point) at x_lin; d(residual)/d(point in body) at x.
  const Matrix3 R = a.pose.R(), R_lin = a_lin.pose.R();
  Vector2 r;
  Jacobian<2, 3> d_r_d_point;
  ASSERT_TRUE(edge.Evaluate(a, x, r, nullptr, &d_r_d_point));
  const Matrix<2, 3> f = d_r_d_point * R;
  const Vector3 P = R_lin.transpose() * (x_lin.p() - a_lin.pose.p());
  EXPECT_LT((J[1] - f * R_lin.transpose()).norm(), 1e-14);
  EXPECT_LT((J[0].leftCols<3>() + f * R_lin.transpose()).norm(), 1e-14);
  EXPECT_LT((J[0].rightCols<3>() - f * so3::Hat(P)).norm(), 1e-14);
}

TEST_F(TwoPoses, AVertexWithoutAFirstEstimateCountsWithItsValue) {
  Graph plain;
  const auto i = plain.AddVertex(a), j = plain.AddVertex(b);
  EdgeRelativePose edge;
  ASSERT_TRUE(plain.AddEdge(edge, {i, j}).ok());
  graph = std::move(plain);
  std::vector<RowMajor> J;
  Evaluate<EdgeRelativePose>(&J);
  Vector6 r;
  Jacobian<6, 6> J_i, J_j;
  ASSERT_TRUE(edge.Evaluate(a, b, r, &J_i, &J_j));
  EXPECT_LT((J[0] - J_i).norm() + (J[1] - J_j).norm(), 1e-15);
}

/// Nine points of one body seen in another: 27 rows that depend on the relative pose only.
struct EdgeManyRows {
  using Vertices = VertexList<VertexPose, VertexPose>;
  static constexpr int kResidualDim = 27;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  bool Evaluate(const VertexPose& a, const VertexPose& b, Vector<27>& r, Jacobian<27, 6>* J_a,
                Jacobian<27, 6>* J_b) const {
    const Matrix3 R_a = a.pose.R(), R_b = b.pose.R();
    for (int k = 0; k < 9; ++k) {
      const Vector3 point(0.3 * k, std::sin(k), 1.0 - 0.1 * k * k);
      const Vector3 in_b = R_b.transpose() * (R_a * point + a.pose.p() - b.pose.p());
      r.segment<3>(3 * k) = in_b;
      if (J_a) {
        J_a->block<3, 3>(3 * k, 0) = R_b.transpose();
        J_a->block<3, 3>(3 * k, 3) = -R_b.transpose() * R_a * so3::Hat(point);
      }
      if (J_b) {
        J_b->block<3, 3>(3 * k, 0) = -R_b.transpose();
        J_b->block<3, 3>(3 * k, 3) = so3::Hat(in_b);
      }
    }
    return true;
  }
};

// More than 16 rows were reported as an edge without a finite residual.
TEST_F(TwoPoses, AnEdgeMayHaveAnyNumberOfRows) {
  const EdgeManyRows edge;
  ASSERT_TRUE(graph.AddEdge(edge, {pose_a, pose_b}).ok());
  std::vector<RowMajor> J;
  const Eigen::VectorXd r = Evaluate<EdgeManyRows>(&J);
  const auto value = [&](const VertexPose& i, const VertexPose& j) {
    Vector<27> residual;
    EXPECT_TRUE(edge.Evaluate(i, j, residual, nullptr, nullptr));
    return Eigen::VectorXd(residual);
  };
  EXPECT_LT((r - value(a, b)).norm(), 1e-15);
  const RowMajor d_r_d_rel = RelativeDerivative(a, b, 27, value);
  const auto d_rel = RelativePoseJacobians(a_lin, b_lin);
  EXPECT_LT((J[0] - d_r_d_rel * d_rel[0]).norm(), 1e-7);
  EXPECT_LT((J[1] - d_r_d_rel * d_rel[1]).norm(), 1e-7);
  EXPECT_GT((J[0] - d_r_d_rel * RelativePoseJacobians(a, b)[0]).norm(), 1e-3);
}

// The Jacobian of a vertex is the same whether that of the other is wanted or not.
TEST_F(TwoPoses, OneVertexHeldChangesNothingForTheOther) {
  const auto point = graph.AddVertex(VertexPointXYZ(0.3, -0.2, 4.0));
  const VertexPointXYZ x_lin(0.35, -0.1, 4.2);
  ASSERT_TRUE(graph.SetFirstEstimate(point.value(), {x_lin.Data(), 3}).ok());
  ASSERT_TRUE(graph.AddEdge(EdgeReprojectionXYZ(), {pose_a, point}).ok());
  ASSERT_TRUE(graph.AddEdge(EdgeManyRows(), {pose_a, pose_b}).ok());
  const auto check = [&]<class E>(std::type_identity<E>) {
    std::vector<RowMajor> both;
    Evaluate<E>(&both);
    for (std::size_t wanted = 0; wanted < 2; ++wanted) {
      RowMajor J = RowMajor::Zero(both[wanted].rows(), both[wanted].cols());
      double* blocks[2] = {};
      blocks[wanted] = J.data();
      EvaluateBlocks<E>(blocks);
      EXPECT_LT((J - both[wanted]).norm(), 1e-14 * both[wanted].norm()) << kTypeInfo<E>.name;
    }
    double* none[2] = {};
    EvaluateBlocks<E>(none);
  };
  check(std::type_identity<EdgeReprojectionXYZ>());
  check(std::type_identity<EdgeManyRows>());
}

/// Null to rounding at the points of linearization, whichever edge: that is what it is for.
TEST(FirstEstimateJacobians, TheGaugeStaysUnobserved) {
  test::ViWalk walk(2);
  Graph& graph = walk.graph();
  for (int k = 0; k < 6; ++k)
    walk.AddFrame();
  for (int k = 0; k < 4; ++k) {
    const AnyVertex pose = walk.pose(k), sb = walk.speed_bias(k);
    const auto p = graph.LinearizationPoint(pose), v = graph.LinearizationPoint(sb);
    ASSERT_TRUE(graph.SetFirstEstimate(pose, std::vector<double>(p.begin(), p.end())).ok());
    ASSERT_TRUE(graph.SetFirstEstimate(sb, std::vector<double>(v.begin(), v.end())).ok());
  }
  walk.Shake(0.05, 1.0);
  graph.SetFirstEstimates(FirstEstimates::kFull);
  for (const auto direction : test::kGaugeDirections)
    EXPECT_LT(test::MeasureGauge(graph, direction).kappa, 1e-28);
  // With points of only some vertices, and no consistent use of them, yaw would be seen.
  graph.SetFirstEstimates(FirstEstimates::kOff);
  EXPECT_GT(test::MeasureGauge(graph, test::GaugeDirection::kYaw).kappa, 1e-9);
}

}  // namespace
}  // namespace glissade
