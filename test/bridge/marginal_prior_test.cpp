// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A marginal prior in Ceres: the same cost and the same gradient.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/bridge/ceres.h"
#include "glissade/graph/pools.h"
#include "glissade/marginal/marginalize.h"
#include "glissade/problem/problem.h"
#include "support/vi_walk.h"

namespace glissade::bridge {
namespace {

TEST(MarginalPrior, CostAndGradientAreCeresOwn) {
  for (const MarginalForm form : {MarginalForm::kSquareRootQr, MarginalForm::kSchur}) {
    test::ViWalk walk(12);
    Problem problem;
    // The exact derivative of the prior, as Ceres has it: an exported cost function knows nothing
    // of linearization points.
    problem.SetFirstEstimates(FirstEstimates::kOff);
    walk.Attach(&problem);
    for (int k = 0; k < 6; ++k)
      walk.AddFrame();
    ASSERT_TRUE(problem.Marginalize(walk.TakeOldest(), {.form = form}).ok());
    walk.Shake(0.05, 2.0);

    const CeresProblem exported = Export(problem);
    double cost = 0.0;
    std::vector<double> gradient;
    std::vector<double*> blocks;
    for (const AnyVertex& vertex : problem.Vertices())
      blocks.push_back(const_cast<double*>(exported.ParameterBlock(vertex)));
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks;
    ASSERT_TRUE(const_cast<ceres::Problem&>(exported.problem())
                    .Evaluate(options, &cost, nullptr, &gradient, nullptr));
    EXPECT_NEAR(cost, problem.Cost().value(), 1e-12 * cost);

    ASSERT_TRUE(problem.MakeHessian().ok());
    const Eigen::VectorXd b = problem.Rhs();
    const auto free = problem.FreeVertices();
    const auto offsets = problem.FreeOffsets();
    const auto vertices = problem.Vertices();
    Eigen::Index at = 0;
    for (const AnyVertex& vertex : vertices) {
      const auto k =
          static_cast<std::size_t>(std::find(free.begin(), free.end(), vertex) - free.begin());
      if (k == free.size()) {  // nothing sees the landmarks of the newest frame yet
        at += problem.PoolOf(vertex.type)->ops().tangent_dim;
        continue;
      }
      for (int i = offsets[k]; i < offsets[k + 1]; ++i, ++at) {
        const double g = gradient[static_cast<std::size_t>(at)];
        EXPECT_NEAR(g, -b[i], 1e-9 * (1.0 + b.norm())) << ToString(vertex);
      }
    }
    EXPECT_EQ(at, static_cast<Eigen::Index>(gradient.size()));
    EXPECT_EQ(offsets.back(), b.size());
    // And it is no small matter.
    EXPECT_GT(b.norm(), 1.0);
  }
}

}  // namespace
}  // namespace glissade::bridge
