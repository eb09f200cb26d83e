// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What is held stays to the last bit; what is held in part stays in its chart.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

class GraphFixing : public ::testing::Test {
 protected:
  GraphFixing() {
    // No priors: nothing but the fixing keeps a pose.
    window_ = AddWindow(&problem_, {.frames = 5, .landmarks = 40, .track = 4, .prior = false});
    Must(problem_.SetFixed(window_.poses[4]));
  }
  const Pose& PoseAt(std::size_t k) const { return problem_.Get(window_.poses[k]).pose; }
  void Solve() {
    const SolveSummary& summary = problem_.Solve({.max_iterations = 30});
    ASSERT_TRUE(summary.ok()) << summary.BriefReport();
    ASSERT_LT(summary.final_cost, 0.5 * summary.initial_cost);
  }
  static double YawFrom(const Pose& pose, const Quaternion& q0) {
    // z of R R0^-1: the chart R = Exp(dphi) R0 has dphi_z = 0.
    const Quaternion q = pose.q() * q0.conjugate();
    return q.z();
  }

  Problem problem_;
  Window window_;
};

TEST_F(GraphFixing, WholeKeepsEveryBit) {
  Must(problem_.SetFixed(window_.poses[1]));
  Must(problem_.SetFixed(window_.landmarks[3]));
  const Pose before = PoseAt(1);
  const double rho = problem_.Get(window_.landmarks[3]).rho;
  const Pose free_before = PoseAt(2);
  Solve();
  EXPECT_EQ(PoseAt(1), before);
  EXPECT_EQ(problem_.Get(window_.landmarks[3]).rho, rho);
  EXPECT_NE(PoseAt(2), free_before);
}

TEST_F(GraphFixing, PositionKeepsEveryBitOfIt) {
  Must(problem_.SetFixed(window_.poses[1], Fix::kPosition));
  const Pose before = PoseAt(1);
  Solve();
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(PoseAt(1).data[k], before.data[k]);
  EXPECT_GT((PoseAt(1).q().coeffs() - before.q().coeffs()).norm(), 1e-4) << "its rotation moves";
}

TEST_F(GraphFixing, PositionAndYawKeepsBothThroughManySolves) {
  const auto pose = window_.poses[1];
  // 6 degrees of tilt error to take back.
  VertexPose tilted{PoseAt(1)};
  tilted.pose.q() = (tilted.pose.q() * so3::ExpQuaternion(Vector3(0.08, -0.06, 0.0))).normalized();
  Must(problem_.Set(pose, tilted));
  Must(problem_.SetFixed(pose, Fix::kPositionAndYaw));
  const Quaternion q0(PoseAt(1).q());
  const Pose before = PoseAt(1);
  for (int solve = 0; solve < 5; ++solve) {
    Must(problem_.Set(window_.poses[2],
                      VertexPose{PoseAt(2) * Pose(so3::ExpQuaternion(Vector3(0.02, 0.01, 0.03)),
                                                  Vector3(0.05, 0.0, 0.02))}));
    const SolveSummary& summary = problem_.Solve({.max_iterations = 30});
    ASSERT_TRUE(summary.ok()) << summary.BriefReport();
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(PoseAt(1).data[k], before.data[k]);
    EXPECT_LT(std::abs(YawFrom(PoseAt(1), q0)), 1e-13) << "solve " << solve;
  }
  EXPECT_GT(so3::Log(Quaternion(q0.conjugate() * PoseAt(1).q())).norm(), 0.05) << "tilt moved";
}

TEST_F(GraphFixing, TheChartIsAnchoredAnewBySetAndBySetFixed) {
  const auto pose = window_.poses[1];
  Must(problem_.SetFixed(pose, Fix::kPositionAndYaw));
  VertexPose turned{PoseAt(1)};
  turned.pose.q() = (so3::ExpQuaternion(Vector3(0.0, 0.0, 0.02)) * turned.pose.q()).normalized();
  Must(problem_.Set(pose, turned));
  Solve();
  EXPECT_LT(std::abs(YawFrom(PoseAt(1), Quaternion(turned.pose.q()))), 1e-13)
      << "yaw is that of the pose that was set";
  // Once more at the present pose: it is the new reference.
  const Quaternion q1(PoseAt(1).q());
  Must(problem_.SetFixed(pose, Fix::kPositionAndYaw));
  ASSERT_EQ(problem_.free_tangents().size(), 1u);
  EXPECT_EQ(problem_.free_tangents()[0].dphi[0], 0.0);
  Must(problem_.Set(window_.poses[2], VertexPose{PoseAt(2) * Pose(Quaternion::Identity(),
                                                                  Vector3(0.05, 0.02, 0.0))}));
  ASSERT_TRUE(problem_.Solve({.max_iterations = 30}).ok());
  EXPECT_LT(std::abs(YawFrom(PoseAt(1), q1)), 1e-13);
}

TEST_F(GraphFixing, ChangesOfMindLeaveOneRule) {
  const auto pose = window_.poses[1];
  for (const Fix fix : {Fix::kPosition, Fix::kPositionAndYaw, Fix::kPosition, Fix::kWhole,
                        Fix::kPositionAndYaw, Fix::kFree, Fix::kWhole, Fix::kFree}) {
    Must(problem_.SetFixed(pose, fix));
    EXPECT_EQ(problem_.GetFixed(pose), fix);
    const bool partial = fix == Fix::kPosition || fix == Fix::kPositionAndYaw;
    EXPECT_EQ(problem_.free_tangents().size(), partial ? 1u : 0u);
    Must(problem_.MakeHessian());
    const std::vector<int> offsets = problem_.FreeOffsets();
    const int freedom = fix == Fix::kFree       ? 6
                        : fix == Fix::kPosition ? 3
                        : fix == Fix::kWhole    ? 0
                                                : 2;
    EXPECT_EQ(offsets.back(), 3 * 6 + freedom + 40) << "poses 0, 2, 3, this one, landmarks";
  }
}

TEST_F(GraphFixing, RemovedPosesTakeTheirChartsAlong) {
  Must(problem_.SetFixed(window_.poses[1], Fix::kPositionAndYaw));
  Must(problem_.SetFixed(window_.poses[2], Fix::kPosition));
  Must(problem_.RemoveVertex(window_.poses[1]));
  ASSERT_EQ(problem_.free_tangents().size(), 1u);
  EXPECT_EQ(problem_.free_tangents()[0].vertex, AnyVertex(window_.poses[2]));
  const Pose before = PoseAt(2);
  ASSERT_TRUE(problem_.Solve().ok());
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(PoseAt(2).data[k], before.data[k]);
}

TEST_F(GraphFixing, EverythingFixedIsSolvedAtOnce) {
  for (const AnyVertex& vertex : problem_.Vertices())
    Must(problem_.SetFixed(vertex));
  const Snapshot before = problem_.GetSnapshot();
  const double cost = Must(problem_.Cost());
  const SolveSummary& summary = problem_.Solve();
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_EQ(summary.num_poses, 0);
  EXPECT_EQ(summary.num_landmarks, 0);
  EXPECT_NEAR(summary.final_cost, cost, 1e-9 * cost);
  EXPECT_TRUE(SameBits(problem_.GetSnapshot(), before));
}

TEST_F(GraphFixing, AFixedPoseWithNothingElseFreeButLandmarks) {
  for (const auto& pose : window_.poses)
    Must(problem_.SetFixed(pose));
  const SolveSummary& summary = problem_.Solve({.max_iterations = 30});
  ASSERT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_EQ(summary.num_poses, 0);
  EXPECT_EQ(summary.num_landmarks, 40);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
}

// A partly fixed pose next to a block wider than a pose: blocks are projected, whatever their size.
struct EdgePoseWide {
  using Vertices = VertexList<VertexPose, VertexVector<60>>;
  static constexpr int kResidualDim = 7;
  bool Evaluate(const VertexPose& pose, const VertexVector<60>& x, Vector<7>& r,
                Jacobian<7, 6>* J_pose, Jacobian<7, 60>* J_x) const {
    const Matrix3 R = pose.pose.R();
    const Vector3 v(x.value[0], x.value[7], x.value[19]);
    r.head<3>() = pose.pose.p() + R * v;
    r[3] = x.value[3] - 1.0;
    r[4] = x.value[12] + 2.0;
    r[5] = 0.1 * x.value[0];
    r[6] = 0.1 * x.value[19];
    if (J_pose) {
      J_pose->setZero();
      J_pose->topLeftCorner<3, 3>().setIdentity();
      J_pose->topRightCorner<3, 3>() = -(R * so3::Hat(v));
    }
    if (J_x) {
      J_x->setZero();
      for (int k = 0; k < 3; ++k) {
        (*J_x)(k, 0) = R(k, 0);
        (*J_x)(k, 7) = R(k, 1);
        (*J_x)(k, 19) = R(k, 2);
      }
      (*J_x)(3, 3) = (*J_x)(4, 12) = 1.0;
      (*J_x)(5, 0) = (*J_x)(6, 19) = 0.1;
    }
    return true;
  }
};

TEST(GraphFixingWide, NextToABlockOfSixtyDimensions) {
  Problem problem;
  Random random(4);
  VertexVector<60> wide;
  for (double& v : wide.value)
    v = random.Uniform(-1.0, 1.0);
  const Pose T_w_b = random.RandomPose(1.0);
  const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{T_w_b});
  const VertexHandle<VertexVector<60>> x = problem.AddVertex(wide);
  Must(problem.AddEdge(EdgePoseWide(), {pose, x}));
  Must(problem.AddEdge(EdgeSE3Prior{T_w_b}, {pose}));
  for (const Fix fix : {Fix::kPosition, Fix::kPositionAndYaw}) {
    Must(problem.SetFixed(pose, fix));
    Must(problem.MakeHessian());
    const int d = fix == Fix::kPosition ? 3 : 2;
    const Eigen::MatrixXd H = problem.Hessian();
    ASSERT_EQ(H.rows(), d + 60);
    // Against J' J with the basis put in by hand.
    Vector<7> r;
    Jacobian<7, 6> J_pose;
    Jacobian<7, 60> J_x;
    EdgePoseWide().Evaluate(problem.Get(pose), problem.Get(x), r, &J_pose, &J_x);
    const FreeTangent& tangent = problem.free_tangents()[0];
    Eigen::MatrixXd E(6, d);
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < d; ++k)
        E(i, k) = tangent.basis[i * d + k];
    }
    Vector6 r_prior;
    Jacobian<6, 6> J_prior;
    EdgeSE3Prior{T_w_b}.Evaluate(problem.Get(pose), r_prior, &J_prior);
    Eigen::MatrixXd J(13, d + 60);
    J << Eigen::MatrixXd(J_pose) * E, J_x, Eigen::MatrixXd(J_prior) * E,
        Eigen::MatrixXd::Zero(6, 60);
    EXPECT_LT((H - J.transpose() * J).cwiseAbs().maxCoeff(), 1e-12);
    Eigen::VectorXd residual(13);
    residual << r, r_prior;
    EXPECT_LT((problem.Rhs() + J.transpose() * residual).cwiseAbs().maxCoeff(), 1e-12);
    ASSERT_TRUE(problem.Solve().ok());
  }
}

}  // namespace
}  // namespace glissade::test
