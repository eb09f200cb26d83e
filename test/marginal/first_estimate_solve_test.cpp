// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Solves with first estimates in full: what is linearized where, and how they end.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/marginal/marginalize.h"
#include "glissade/problem/problem.h"
#include "linear/both_paths.h"
#include "support/dense_reference.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Dense {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
};

/// H and b with Jacobians at first estimates and residuals at x, edge by edge; free vertices only.
Dense FirstEstimateSystem(const Graph& graph, const std::vector<AnyVertex>& order,
                          const std::vector<int>& offsets) {
  Dense system{Eigen::MatrixXd::Zero(offsets.back(), offsets.back()),
               Eigen::VectorXd::Zero(offsets.back())};
  for (const auto& pool : graph.edge_pools()) {
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      const int rows = pool->residual_dim(edge), arity = pool->arity(edge);
      Eigen::VectorXd r(rows);
      std::vector<const double*> states, points;
      std::vector<RowMajor> J;
      std::vector<double*> blocks;
      const EdgeMarginalPrior* prior = nullptr;
      if (pool->type() == &kTypeInfo<DynamicEdge>) {
        prior = dynamic_cast<const EdgeMarginalPrior*>(
            &static_cast<const DynamicEdgePool&>(*pool).At(edge));
      }
      for (int i = 0; i < arity; ++i) {
        const VertexPoolBase& vertices = *pool->vertex_pool(edge, i);
        const int index = vertices.slots().IndexOf(pool->vertex_slot(edge, i));
        states.push_back(vertices.Data(index));
        points.push_back(vertices.first_estimates().At(index));
        J.emplace_back(rows, vertices.ops().tangent_dim);
      }
      for (RowMajor& block : J)
        blocks.push_back(block.data());
      EXPECT_TRUE(pool->EvaluateAt(edge, states.data(), points.data(), r.data(), blocks.data()));
      if (prior != nullptr) {
        const Eigen::Map<const RowMajor> constant(prior->jacobian().data(), rows,
                                                  prior->TangentDim());
        Eigen::Index column = 0;
        for (RowMajor& block : J) {
          block = constant.middleCols(column, block.cols());
          column += block.cols();
        }
      }
      pool->Whiten(edge, r.data(), blocks.data());
      const auto offset = [&](int i) {
        const auto at = std::find(order.begin(), order.end(), pool->VertexOf(edge, i));
        return at == order.end() ? -1 : offsets[static_cast<std::size_t>(at - order.begin())];
      };
      for (int i = 0; i < arity; ++i) {
        const RowMajor& J_i = J[static_cast<std::size_t>(i)];
        if (offset(i) < 0) continue;
        system.b.segment(offset(i), J_i.cols()) -= J_i.transpose() * r;
        for (int j = 0; j < arity; ++j) {
          const RowMajor& J_j = J[static_cast<std::size_t>(j)];
          if (offset(j) < 0) continue;
          system.H.block(offset(i), offset(j), J_i.cols(), J_j.cols()) += J_i.transpose() * J_j;
        }
      }
    }
  }
  return system;
}

/// A window under a prior whose states have moved away from their linearization points.
void MakeWindow(test::ViWalk* walk, Problem* problem, double offset) {
  problem->SetFirstEstimates(FirstEstimates::kFull);
  walk->Attach(problem);
  for (int k = 0; k < 7; ++k)
    walk->AddFrame();
  ASSERT_TRUE(problem->Solve().ok());
  ASSERT_TRUE(problem->Marginalize(walk->TakeOldest()).ok());
  walk->AddFrame();
  walk->Shake(offset, 20.0 * offset);
}

TEST(FirstEstimateSolve, TheSystemIsThatOfADenseReference) {
  test::ViWalk walk(21);
  Problem problem;
  MakeWindow(&walk, &problem, 0.05);
  ASSERT_TRUE(problem.MakeHessian().ok());
  const Dense expected =
      FirstEstimateSystem(problem, problem.FreeVertices(), problem.FreeOffsets());
  EXPECT_LT(test::HessianError(problem.Hessian(), expected.H), 1e-12);
  EXPECT_LT((problem.Rhs() - expected.b).norm(), 1e-11 * expected.b.norm());
  // It is another system than that at x.
  problem.SetFirstEstimates(FirstEstimates::kOff);
  ASSERT_TRUE(problem.MakeHessian().ok());
  EXPECT_GT(test::HessianError(problem.Hessian(), expected.H), 1e-4);
}

TEST(FirstEstimateSolve, LandmarksInGroupsTakeTheSameStep) {
  test::ViWalk walk(22);
  Problem problem;
  MakeWindow(&walk, &problem, 0.02);
  const DampingTerm damping{.lambda = 1e-3};
  test::PathOutcome groups(&problem, true, damping), single(&problem, false, damping);
  EXPECT_GT(groups.structure.groups().num_landmarks, 0);
  test::ExpectSame(&groups, single, 1e-9);
}

TEST(FirstEstimateSolve, EndsAsConvergedHoweverFarTheFirstEstimatesAre) {
  for (const double offset : {0.001, 0.01, 0.05, 0.2}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      test::ViWalk walk(seed);
      Problem problem;
      MakeWindow(&walk, &problem, offset);
      const double start = problem.Cost().value();
      SolveOptions options;
      options.max_iterations = 200;
      const SolveSummary& summary = problem.Solve(options);
      EXPECT_TRUE(summary.converged()) << summary.BriefReport() << ", offset " << offset;
      EXPECT_LE(summary.final_cost, start);
      EXPECT_NEAR(problem.Cost().value(), summary.final_cost, 1e-9 * summary.final_cost);
    }
  }
}

/// A relative pose that was linearized a radian away, so that its first-estimate gradient does not
/// lead downhill: there is nothing but rejected steps, and the status says so.
TEST(FirstEstimateSolve, AnEndWithoutAnythingButRejectedStepsIsNamed) {
  Problem problem;
  problem.SetFirstEstimates(FirstEstimates::kFull);
  VertexPose first, second;
  second.pose.data[0] = 1.0;
  const auto a = problem.AddVertex(first), b = problem.AddVertex(second);
  ASSERT_TRUE(problem.SetFixed(a).ok());
  EdgeRelativePose edge;
  edge.T_i_j = Pose(Quaternion::Identity(), Vector3(2.0, 0.0, 0.0));
  ASSERT_TRUE(problem.AddEdge(edge, {a, b}).ok());
  // x_lin of the second frame is turned about: what looks like forwards is backwards.
  VertexPose turned = second;
  const double half_turn[6] = {0, 0, 0, 0, 0, 3.0};
  turned.Plus(half_turn);
  ASSERT_TRUE(problem.SetFirstEstimate(b.value(), {turned.Data(), 7}).ok());
  SolveOptions options;
  options.max_iterations = 500;
  const SolveSummary& summary = problem.Solve(options);
  EXPECT_EQ(summary.termination, Termination::kConvergedFirstEstimates) << summary.BriefReport();
  EXPECT_TRUE(summary.converged());
  EXPECT_EQ(summary.accepted_steps, 0);
  EXPECT_EQ(summary.final_cost, summary.initial_cost);
  EXPECT_NE(summary.BriefReport().find("first estimates"), std::string::npos);
}

}  // namespace
}  // namespace glissade
