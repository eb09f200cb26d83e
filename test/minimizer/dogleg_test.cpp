// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "glissade/glissade.h"
#include "glissade/graph/pools.h"
#include "glissade/minimizer/minimizer.h"
#include "support/rosenbrock.h"

namespace glissade {
namespace {

using test::EdgeRosenbrock;

/// A x - (1, 2, 3).
struct EdgeLinear {
  using Vertices = VertexList<VertexVector<3>>;
  static constexpr int kResidualDim = 3;
  bool Evaluate(const VertexVector<3>& x, Vector<3>& r, Jacobian<3, 3>* J) const {
    Matrix3 A;
    A << 4, 1, 0, 1, 3, -1, 0, 2, 5;
    r = A * Vector3(x.Data()) - Vector3(1, 2, 3);
    if (J != nullptr) *J = A;
    return true;
  }
};

VertexVector<2> At(double x, double y) {
  VertexVector<2> v;
  v.Data()[0] = x;
  v.Data()[1] = y;
  return v;
}

TEST(Dogleg, FollowsRosenbrocksValley) {
  for (const Method method : {Method::kLevenbergMarquardt, Method::kDogleg}) {
    Problem problem;
    const VertexHandle<VertexVector<2>> v = problem.AddVertex(At(-1.2, 1.0));
    ASSERT_TRUE(problem.AddEdge(EdgeRosenbrock{}, {v}).ok());
    const SolveSummary& summary =
        problem.Solve({.max_iterations = 200, .method = method, .initial_radius = 1.0});
    EXPECT_TRUE(summary.converged()) << summary.BriefReport();
    EXPECT_NEAR(problem.Get(v).Data()[0], 1.0, 1e-6);
    EXPECT_NEAR(problem.Get(v).Data()[1], 1.0, 1e-6);
  }
}

TEST(Dogleg, StepsStayInTheRegion) {
  for (const double radius : {0.01, 0.3, 3.0}) {
    Problem problem;
    const VertexHandle<VertexVector<2>> v = problem.AddVertex(At(-1.2, 1.0));
    ASSERT_TRUE(problem.AddEdge(EdgeRosenbrock{}, {v}).ok());
    ASSERT_TRUE(problem.MakeHessian().ok());
    const Eigen::VectorXd scale = problem.Hessian().diagonal().cwiseSqrt();
    problem.Solve({.max_iterations = 1, .method = Method::kDogleg, .initial_radius = radius});
    const Eigen::Vector2d step(problem.Get(v).Data()[0] + 1.2, problem.Get(v).Data()[1] - 1.0);
    EXPECT_LE(scale.cwiseProduct(step).norm(), radius * (1.0 + 1e-12));
  }
}

TEST(Dogleg, TakesTheWholeStepOnALinearProblem) {
  Problem problem;
  VertexVector<3> start;
  start.Data()[0] = 3.0;
  const VertexHandle<VertexVector<3>> v = problem.AddVertex(start);
  ASSERT_TRUE(problem.AddEdge(EdgeLinear{}, {v}).ok());
  const SolveSummary& summary = problem.Solve({.max_iterations = 1, .method = Method::kDogleg});
  EXPECT_LT(summary.final_cost, 1e-12 * summary.initial_cost);
}

TEST(QuadraticForm, EqualsTheDenseProduct) {
  Problem problem;
  const auto a = problem.AddVertex(VertexPose{});
  const auto b = problem.AddVertex(
      VertexPose{Pose(so3::ExpQuaternion(Vector3(0.1, 0.2, -0.1)), Vector3(0.5, 0.1, 0.0))});
  for (int k = 0; k < 20; ++k) {
    const auto depth = problem.AddVertex(VertexInverseDepth{0.2 + 0.01 * k});
    EdgeReprojection edge;
    edge.uv_host = Vector2(0.02 * k - 0.2, 0.1);
    edge.uv_target = Vector2(0.02 * k - 0.25, 0.12);
    ASSERT_TRUE(problem.AddEdge(edge, {a, b, depth}).ok());
  }
  ASSERT_TRUE(problem.MakeHessian().ok());
  const Eigen::MatrixXd H = problem.Hessian();
  std::vector<double> d(static_cast<std::size_t>(H.rows()));
  for (std::size_t k = 0; k < d.size(); ++k)
    d[k] = std::sin(1.0 + double(k));
  const Eigen::Map<const Eigen::VectorXd> direction(d.data(), H.rows());
  const double expected = direction.dot(H * direction);

  for (const bool group : {false, true}) {
    Structure structure;
    NormalEquations equations;
    ThreadPool threads;
    double cost = 0.0;
    ASSERT_TRUE(structure.Analyze(&problem, {.group_landmarks = group}).ok());
    ASSERT_TRUE(equations.Linearize(structure, &problem, &threads, &cost).ok());
    // Lanes are sorted and padded: bring the direction into the order of step().
    std::vector<double> sorted(equations.step().size(), 0.0);
    std::size_t from = 0;
    for (const auto& pool : problem.vertex_pools()) {
      for (int k = 0; k < pool->size(); ++k) {
        const std::int32_t to = structure.step_offsets(pool->id())[static_cast<std::size_t>(k)];
        for (int i = 0; i < pool->ops().tangent_dim; ++i) {
          sorted[static_cast<std::size_t>(to + i)] = d[from++];
        }
      }
    }
    EXPECT_NEAR(equations.QuadraticForm(structure, problem, sorted), expected, 1e-12 * expected);
  }
}

}  // namespace
}  // namespace glissade
