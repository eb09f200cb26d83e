// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A solve says "converged" where it has, whatever the world's origin and units are, and whatever
// one variable of it is like.

#include <gtest/gtest.h>

#include <cmath>

#include "minimizer/strip.h"
#include "support/rosenbrock.h"

namespace glissade {
namespace {

using test::EdgeRosenbrock;
using test::Strip;
using test::StripOptions;

/// A number in tiny units.
struct EdgeSteep {
  using Vertices = VertexList<VertexVector<1>>;
  static constexpr int kResidualDim = 1;
  double slope = 1e12;
  bool Evaluate(const VertexVector<1>& v, Vector<1>& r, Jacobian<1, 1>* J) const {
    r[0] = slope * v.Data()[0];
    if (J != nullptr) (*J)(0, 0) = slope;
    return true;
  }
};

// |dx| was compared with |x| over all variables: one inverse depth of 1e10 among 80, and the solve
// had converged before its first step.
TEST(StoppingRules, OneWildVariableDoesNotEndTheSolve) {
  Strip strip({.noise = 0.5}), wild({.noise = 0.5});
  const double cost = strip.problem.Solve().final_cost;
  ASSERT_TRUE(wild.problem.Set(wild.depths[7], VertexInverseDepth{1e10}).ok());
  const SolveSummary& summary = wild.problem.Solve();
  EXPECT_GT(summary.accepted_steps, 2) << summary.BriefReport();
  // Its own terms are flat out there; all others get where they get without it.
  double own = 0.0;
  for (const AnyEdge& edge : wild.problem.Edges()) {
    for (const AnyVertex& vertex : wild.problem.VerticesOf(edge).value()) {
      if (vertex == AnyVertex(wild.depths[7])) own += 0.5 * wild.problem.Chi2(edge).value();
    }
  }
  EXPECT_LT(summary.final_cost - own, 1.2 * cost) << summary.BriefReport();
}

// At 6.4e6 m from the origin, where a position has 1e-9 m of rounding, it stopped ten orders of
// magnitude above what that rounding allows.
TEST(StoppingRules, TheWorldsOriginDoesNotMatter) {
  Strip near, far({.origin = Vector3(6.4e6, -2e6, 1e6)});
  const SolveSummary& at_origin = near.problem.Solve();
  EXPECT_TRUE(at_origin.converged()) << at_origin.BriefReport();
  EXPECT_LT(at_origin.final_cost, 1e-15) << at_origin.BriefReport();
  const SolveSummary& far_away = far.problem.Solve();
  EXPECT_TRUE(far_away.converged()) << far_away.BriefReport();
  EXPECT_LT(far_away.final_cost, 1e-10) << far_away.BriefReport();
}

// Powers of two, so that every number of the solve is the same but for its exponent.
TEST(StoppingRules, UnitsDoNotMatter) {
  const StripOptions metres{.noise = 0.5};
  StripOptions others = metres;
  others.scale = 1024.0;
  others.focal = 32.0 * metres.focal;
  Strip a(metres), b(others);
  // Tight enough that the rule of the step is the one that ends it.
  const SolveOptions options{.cost_tolerance = 0.0, .step_tolerance = 1e-6};
  const SolveSummary& in_metres = a.problem.Solve(options);
  const SolveSummary& in_others = b.problem.Solve(options);
  EXPECT_EQ(in_metres.termination, Termination::kConvergedStep) << in_metres.BriefReport();
  EXPECT_EQ(in_others.termination, Termination::kConvergedStep) << in_others.BriefReport();
  EXPECT_EQ(in_metres.iterations.size(), in_others.iterations.size());
  EXPECT_NEAR(in_others.final_cost, 1024.0 * in_metres.final_cost, 1e-9 * in_others.final_cost);
}

// max |g_i| was compared with the start's, in units as they come: what is large there need not be
// far from its best.
TEST(StoppingRules, OneSteepVariableDoesNotEndTheSolve) {
  Problem problem;
  VertexVector<2> start;
  start.Data()[0] = -1.2;
  start.Data()[1] = 1.0;
  const VertexHandle<VertexVector<2>> v = problem.AddVertex(start);
  VertexVector<1> off;
  off.Data()[0] = 1e-9;
  const VertexHandle<VertexVector<1>> steep = problem.AddVertex(off);
  ASSERT_TRUE(problem.AddEdge(EdgeRosenbrock{}, {v}).ok());
  ASSERT_TRUE(problem.AddEdge(EdgeSteep{}, {steep}).ok());
  const SolveSummary& summary = problem.Solve({.max_iterations = 200});
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_NEAR(problem.Get(v).Data()[0], 1.0, 1e-6) << summary.BriefReport();
}

// What the tolerance promises: no variable is further from where the model has its minimum than
// tolerance * sqrt(2 cost) of its standard deviation.
TEST(StoppingRules, TheStepToleranceIsInStandardDeviations) {
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    Strip strip({.noise = 0.5});
    const SolveSummary summary = strip.problem.Solve({.cost_tolerance = 0.0,
                                                      .gradient_tolerance = 0.0,
                                                      .step_tolerance = tolerance,
                                                      .initial_lambda = 1e-12});
    ASSERT_EQ(summary.termination, Termination::kConvergedStep) << summary.BriefReport();
    ASSERT_TRUE(strip.problem.MakeHessian().ok());
    ASSERT_TRUE(strip.problem.SolveLinearSystem(0.0).ok());
    const Eigen::VectorXd dx = strip.problem.Step();
    const Eigen::VectorXd sigma = strip.problem.Hessian().inverse().diagonal().cwiseSqrt();
    EXPECT_LE(dx.cwiseQuotient(sigma).cwiseAbs().maxCoeff(),
              1.001 * tolerance * std::sqrt(2.0 * summary.final_cost));
    EXPECT_GT(dx.norm(), 0.0);
  }
}

}  // namespace
}  // namespace glissade
