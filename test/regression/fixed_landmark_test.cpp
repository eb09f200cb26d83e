// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Fixing a landmark made its block of H zero, the inverse of that infinite, every step NaN, and
// Solve reported success. Here a fixed landmark leaves the system; and a landmark that nothing
// determines is named, not divided by.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "regression/course_support.h"

namespace glissade {
namespace {

struct System {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  int num_pose_scalars = 0;
};

System SystemOf(Problem& problem) {
  EXPECT_TRUE(problem.MakeHessian().ok());
  System system{problem.Hessian(), problem.Rhs(), 0};
  for (const AnyVertex& vertex : problem.FreeVertices())
    system.num_pose_scalars += vertex.type == &kTypeInfo<VertexPose> ? 6 : 0;
  return system;
}

/// Elimination as in the course: every H_ll is inverted, whatever is in it.
Eigen::VectorXd EliminateBlindly(const System& system, double lambda) {
  const auto p = system.num_pose_scalars;
  const auto l = static_cast<int>(system.b.size()) - p;
  const Eigen::MatrixXd W = system.H.topRightCorner(p, l);
  const Eigen::VectorXd inverse = system.H.diagonal().tail(l).cwiseInverse();
  Eigen::MatrixXd S = system.H.topLeftCorner(p, p) - W * inverse.asDiagonal() * W.transpose();
  S.diagonal().array() += lambda;
  Eigen::VectorXd dx(p + l);
  dx.head(p) = S.ldlt().solve(system.b.head(p) - W * inverse.asDiagonal() * system.b.tail(l));
  dx.tail(l) = inverse.cwiseProduct(system.b.tail(l) - W.transpose() * dx.head(p));
  return dx;
}

/// The check: a step that exists and solves the system it was made from.
bool IsStepOf(const System& system, double lambda, const Eigen::VectorXd& dx) {
  Eigen::MatrixXd A = system.H;
  A.diagonal().head(system.num_pose_scalars).array() += lambda;
  return dx.allFinite() && (A * dx - system.b).norm() <= 1e-9 * system.b.norm();
}

constexpr double kLambda = 1e-3;
SolveOptions PoseDamping() {
  SolveOptions options;
  options.damping = Damping::kPoseBlock;
  return options;
}

TEST(FixedLandmark, LeavesTheSystem) {
  Problem problem;
  const CourseHandles handles = AddToGraph(MakeCourseScene(), problem).value();
  const System all = SystemOf(problem);
  EXPECT_EQ(all.b.size(), 18 + 20);
  EXPECT_TRUE(IsStepOf(all, kLambda, EliminateBlindly(all, kLambda)));

  EXPECT_TRUE(problem.SetFixed(handles.points[3]).ok());
  EXPECT_TRUE(problem.SetFixed(handles.points[7]).ok());
  const System ours = SystemOf(problem);
  EXPECT_EQ(ours.b.size(), 18 + 18);
  ASSERT_TRUE(problem.SolveLinearSystem(kLambda, PoseDamping()).ok());
  EXPECT_TRUE(IsStepOf(ours, kLambda, problem.Step()));

  // With the defect the landmark stays, as a row and a column of zeros.
  System defective = all;
  for (int k : {18 + 3, 18 + 7}) {
    defective.H.row(k).setZero();
    defective.H.col(k).setZero();
    defective.b[k] = 0.0;
  }
  EXPECT_FALSE(IsStepOf(defective, kLambda, EliminateBlindly(defective, kLambda)));
}

TEST(FixedLandmark, StaysWhereItIsAndTheRestConverges) {
  for (const SolveOptions& options : {test::ConvergedOptions(), test::CourseOptions(false)}) {
    for (int fix : {0, 2}) {
      const CourseScene scene = MakeCourseScene();
      Problem problem;
      const CourseHandles handles = AddToGraph(scene, problem, {.fix_poses = fix}).value();
      for (std::size_t k : {std::size_t{3}, std::size_t{7}}) {
        const double rho = scene.TrueInverseDepth(scene.points[k]);
        EXPECT_TRUE(problem.Set(handles.points[k], VertexInverseDepth{rho}).ok());
        EXPECT_TRUE(problem.SetFixed(handles.points[k]).ok());
      }
      const SolveSummary summary = problem.Solve(options);
      EXPECT_TRUE(summary.converged()) << summary.BriefReport();
      EXPECT_EQ(summary.num_landmarks, 18);
      for (std::size_t k = 0; k < handles.points.size(); ++k) {
        const double rho = problem.Get(handles.points[k]).rho;
        EXPECT_TRUE(std::isfinite(rho));
        const bool held = k == 3 || k == 7;
        EXPECT_EQ(held && rho == scene.TrueInverseDepth(scene.points[k]), held);
      }
      EXPECT_LT(SystemOf(problem).b.lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

TEST(FixedLandmark, AllOfThem) {
  Problem problem;
  const CourseHandles handles = AddToGraph(MakeCourseScene(), problem, {.fix_poses = 2}).value();
  for (const auto& point : handles.points)
    EXPECT_TRUE(problem.SetFixed(point).ok());
  const SolveSummary summary = problem.Solve(test::ConvergedOptions());
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_EQ(summary.num_landmarks, 0);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
}

/// An observation with the course's treatment of a fixed landmark: no derivative.
struct EdgeBlindToDepth : EdgeReprojection {
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_rho) const {
    if (d_r_d_rho) d_r_d_rho->setZero();
    return EdgeReprojection::Evaluate(host, target, depth, r, d_r_d_host, d_r_d_target, nullptr);
  }
};

TEST(FixedLandmark, ALandmarkThatNothingDeterminesIsNamed) {
  const CourseScene scene = MakeCourseScene();
  Problem problem;
  const CourseHandles handles = AddToGraph(scene, problem, {.fix_poses = 2}).value();
  const auto blind = problem.AddVertex(VertexInverseDepth{0.2}).value();
  ASSERT_TRUE(
      problem.AddEdge(EdgeBlindToDepth{}, {handles.poses[0], handles.poses[2], blind}).ok());
  const Snapshot before = problem.GetSnapshot();

  const SolveSummary refused = problem.Solve(PoseDamping());
  EXPECT_EQ(refused.termination, Termination::kFailed);
  EXPECT_EQ(refused.status.code(), StatusCode::kSingular) << refused.status.message();
  EXPECT_EQ(refused.status.vertex(), AnyVertex(blind));
  EXPECT_EQ(problem.GetSnapshot().states, before.states);

  // Damping of all variables can bear it: the landmark stays, the rest is solved.
  const SolveSummary solved = problem.Solve(test::ConvergedOptions());
  EXPECT_TRUE(solved.converged()) << solved.BriefReport();
  EXPECT_EQ(problem.Get(blind).rho, 0.2);
}

}  // namespace
}  // namespace glissade
