// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Forms that an edge of a user's own may have, and what happens where it has no value.

#include <gtest/gtest.h>

#include <random>
#include <tuple>
#include <vector>

#include "glissade/glissade.h"
#include "glissade/testing/check_jacobians.h"
#include "support/template_edges.h"
#include "support/user_types.h"

namespace glissade {
namespace {

using test::BearingInPacks;
using test::BentInPacks;
using test::Normal;
using test::OffsetInPacks;
using test::RangeInPacks;

TEST(EdgeForms, TemplateEdgesHaveTheJacobiansOfTheirResiduals) {
  const VertexPose pose{Pose(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 0.2, 0.3))};
  const VertexPointXYZ point(1.0, -0.5, 4.0);
  test::VertexBearing bearing;
  for (const JacobianCheck& check :
       {CheckJacobians(RangeInPacks{2.0}, pose, point),
        CheckJacobians(OffsetInPacks{Vector3(1.0, 2.0, 3.0), 2.0}, pose, point),
        CheckJacobians(BentInPacks{1.0}, pose, point),
        CheckJacobians(BentInPacks{9.0}, pose, point),
        CheckJacobians(BearingInPacks{}, pose, bearing)}) {
    EXPECT_TRUE(check.ok) << check.message;
  }
}

/// One of many points lies where the pose is: a condition that one lane alone has, and no value.
TEST(EdgeForms, AnEdgeThatFailsInOneLaneIsNamed) {
  for (const int bad : {0, 3, 8, 20}) {
    Problem problem;
    const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{});
    EdgeHandle<RangeInPacks> culprit;
    for (int k = 0; k < 21; ++k) {
      const VertexHandle<VertexPointXYZ> point =
          problem.AddVertex(VertexPointXYZ(k == bad ? 0.0 : 1.0 + k, 0.0, 0.0));
      const EdgeHandle<RangeInPacks> edge = problem.AddEdge(RangeInPacks{1.0}, {pose, point});
      if (k == bad) culprit = edge;
    }
    const SolveSummary summary = problem.Solve();
    EXPECT_EQ(summary.status.code(), StatusCode::kEvaluationFailed);
    EXPECT_EQ(summary.status.edge(), AnyEdge(culprit)) << summary.status.message();
  }
}

/// NaN where it did not look for it.
TEST(EdgeForms, AnEdgeThatIsNotFiniteInOneLaneIsNamed) {
  for (const int bad : {0, 5, 19}) {
    Problem problem;
    VertexPose behind;
    const VertexHandle<VertexPose> pose = problem.AddVertex(behind);
    EdgeHandle<BearingInPacks> culprit;
    for (int k = 0; k < 20; ++k) {
      test::VertexBearing bearing;  // sideways: z is 0
      if (k == bad) {
        bearing.data[0] = 1.0;
        bearing.data[2] = 0.0;
      }
      const VertexHandle<test::VertexBearing> vertex = problem.AddVertex(bearing);
      const EdgeHandle<BearingInPacks> edge = problem.AddEdge(BearingInPacks{}, {pose, vertex});
      if (k == bad) culprit = edge;
    }
    const SolveSummary summary = problem.Solve();
    EXPECT_EQ(summary.status.code(), StatusCode::kEvaluationFailed);
    EXPECT_EQ(summary.status.edge(), AnyEdge(culprit)) << summary.status.message();
  }
}

/// RangeInPacks without its Jacobians.
struct RangeOfResidual {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  static constexpr auto kLanes = Fields(&RangeOfResidual::measured);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const T& range, Vec<T, 1>& r) const {
    using std::sqrt;
    const Vec<T, 3> x = point.p - pose.p;
    const T distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (distance == T(0.0)) return false;
    r[0] = distance - range;
    return true;
  }
};

TEST(EdgeForms, EdgesWithoutJacobiansAreThoseWithJacobians) {
  const auto make = [](auto edge) {
    std::mt19937 engine(11);
    Problem problem;
    std::vector<VertexHandle<VertexPose>> poses;
    for (int k = 0; k < 4; ++k) {
      const Vector3 phi(Normal(engine, 0.3), Normal(engine, 0.3), Normal(engine, 0.3));
      const Vector3 p(0.5 * k, Normal(engine, 0.2), Normal(engine, 0.2));
      poses.push_back(problem.AddVertex(VertexPose{Pose(so3::ExpQuaternion(phi), p)}));
    }
    for (int l = 0; l < 21; ++l) {
      const VertexHandle<VertexPointXYZ> point = problem.AddVertex(
          VertexPointXYZ(Normal(engine, 2.0), Normal(engine, 2.0), 5.0 + Normal(engine, 0.5)));
      for (const VertexHandle<VertexPose>& pose : poses) {
        edge.measured = 5.0 + Normal(engine, 0.5);
        EXPECT_TRUE(problem.AddEdge(edge, {pose, point}).ok());
      }
    }
    EXPECT_TRUE(problem.MakeHessian().ok());
    return problem;
  };
  const Problem by_hand = make(RangeInPacks{}), found = make(RangeOfResidual{});
  const Eigen::MatrixXd H = by_hand.Hessian();
  const Eigen::VectorXd b = by_hand.Rhs();
  ASSERT_EQ(found.Hessian().rows(), H.rows());
  EXPECT_LT((found.Hessian() - H).cwiseAbs().maxCoeff(), 1e-12 * H.cwiseAbs().maxCoeff());
  EXPECT_LT((found.Rhs() - b).cwiseAbs().maxCoeff(), 1e-12 * b.cwiseAbs().maxCoeff());
}

/// Derives from a template edge, and has an Evaluate of its own; or has not.
struct HalfRange : RangeInPacks {
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector<1>& r,
                Jacobian<1, 6>* d_pose, Jacobian<1, 3>* d_point) const {
    const bool ok = internal::EvaluateInDouble(static_cast<const RangeInPacks&>(*this),
                                               std::tie(pose, point), r, d_pose, d_point);
    r *= 0.5;
    if (d_pose) *d_pose *= 0.5;
    if (d_point) *d_point *= 0.5;
    return ok;
  }
};
struct OtherRange : RangeInPacks {};

TEST(EdgeForms, AnEdgeThatDerivesFromATemplateEdgeHasItsOwnEvaluate) {
  static_assert(!kEvaluatesInPacks<HalfRange> && kEvaluatesInPacks<OtherRange>);
  Problem problem;
  const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{});
  for (int k = 0; k < 9; ++k) {
    const VertexHandle<VertexPointXYZ> point = problem.AddVertex(VertexPointXYZ(1.0 + k, 0.0, 0.0));
    ASSERT_TRUE(problem.AddEdge(HalfRange{{k + 3.0}}, {pose, point}).ok());
    ASSERT_TRUE(problem.AddEdge(OtherRange{{k + 2.0}}, {pose, point}).ok());
  }
  ASSERT_TRUE(problem.MakeHessian().ok());
  EXPECT_NEAR(problem.Rhs()[0], 9 * -0.5 + 9 * -1.0, 1e-13);
  EXPECT_NEAR(problem.Solve({.max_iterations = 0}).initial_cost, 18 * 0.5, 1e-13);
}

}  // namespace
}  // namespace glissade
