// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Exceptions of a user's code come out of Solve on the thread that called it, the same one for any
// number of threads; the graph then holds the best state so far.

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include "minimizer/strip.h"

namespace glissade {
namespace {

using test::Strip;

std::atomic<int> evaluations{0};
int throw_from = -1;  // evaluation from which on edges of a group throw

/// Throws its number, once it is time.
struct EdgeThrowing : EdgeReprojection {
  int number = 0;
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_rho) const {
    const int count = ++evaluations;
    if (throw_from >= 0 && count > throw_from && number % 3 == 0) {
      throw std::runtime_error("edge " + std::to_string(number));
    }
    return EdgeReprojection::Evaluate(host, target, depth, r, d_r_d_host, d_r_d_target, d_r_d_rho);
  }
};

bool loss_throws = false;
struct ThrowingLoss {
  void Evaluate(double s, double rho[3]) const {
    if (loss_throws) throw std::logic_error("loss");
    rho[0] = s;
    rho[1] = 1.0;
    rho[2] = 0.0;
  }
};

class ThrowingSolver final : public LinearSolver {
 public:
  [[nodiscard]] SchurForm Form(const SchurLayout& all_blocks) override {
    return inner_.Form(all_blocks);
  }
  LinearSolverResult Prepare(const SchurOperator& S) override { return inner_.Prepare(S); }
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override {
    if (++solves == 3) throw std::runtime_error("solver");
    return inner_.Solve(S, b, x, request);
  }
  int solves = 0;

 private:
  DenseCholeskySolver inner_;
};

/// A strip whose edges are all EdgeThrowing: enough of them for several chunks of work.
void MakeThrowing(Problem* problem) {
  Strip strip({.noise = 0.5, .num_frames = 8, .landmarks_per_frame = 250});
  int number = 0;
  std::vector<AnyVertex> vertices;
  std::vector<std::pair<EdgeThrowing, std::vector<AnyVertex>>> edges;
  strip.problem.ForEachEdge<EdgeReprojection>(
      [&](EdgeHandle<EdgeReprojection> handle, const EdgeReprojection& edge) {
        EdgeThrowing throwing;
        static_cast<EdgeReprojection&>(throwing) = edge;
        throwing.number = ++number;
        edges.emplace_back(throwing, strip.problem.VerticesOf(handle).value());
      });
  for (const AnyEdge& edge : strip.problem.Edges())
    ASSERT_TRUE(strip.problem.RemoveEdge(edge).ok());
  EdgeOptions<EdgeThrowing> options;
  options.sqrt_information = Matrix2(400.0 * Matrix2::Identity());
  const auto pose = [](AnyVertex v) { return *v.As<VertexPose>(); };
  for (const auto& [edge, v] : edges) {
    ASSERT_TRUE(
        strip.problem
            .AddEdge(edge, {pose(v[0]), pose(v[1]), *v[2].As<VertexInverseDepth>()}, options)
            .ok());
  }
  *problem = std::move(strip.problem);
}

/// Whether f throws, and what.
template <class F>
std::string WhatOf(F&& f) {
  try {
    f();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(Exceptions, OfAnEdgeComeOutWithTheBestStateForAnyNumberOfThreads) {
  Problem original;
  ASSERT_NO_FATAL_FAILURE(MakeThrowing(&original));
  const int edges = original.NumEdges();
  ASSERT_GT(edges, 3 * 1500) << "several chunks";
  const Problem start = original.Clone();
  // Amid the first linearization, amid a trial cost, amid the linearization after it, and later.
  for (const double when : {0.0, 1.5, 2.5, 3.5, 4.5}) {
    std::string first;
    for (const int threads : {1, 2, 4}) {
      SCOPED_TRACE(std::to_string(when) + " with threads " + std::to_string(threads));
      Problem problem = start.Clone();
      double last_cost = start.Cost().value();
      SolveOptions options;
      options.cost_tolerance = 0.0;
      options.num_threads = threads;
      options.callback = [&](const IterationSummary& iteration) {
        last_cost = iteration.cost;
        return CallbackAction::kContinue;
      };
      evaluations = 0;
      throw_from = static_cast<int>(when * edges);
      const std::string what = WhatOf([&] { problem.Solve(options); });
      throw_from = -1;
      EXPECT_EQ(what.substr(0, 5), "edge ");
      // With one thread, edges of the first chunk may have been through when it begins.
      if (when == 0.0) {
        if (first.empty()) first = what;
        EXPECT_EQ(what, first);
      }
      EXPECT_LE(problem.Cost().value(), last_cost * (1.0 + 1e-12));
      const SolveSummary& later = problem.Solve();
      EXPECT_TRUE(later.converged()) << later.BriefReport();
    }
  }
}

// The trial state was left in the graph.
TEST(Exceptions, AtATrialPointLeaveTheStatesBeforeIt) {
  Problem problem;
  ASSERT_NO_FATAL_FAILURE(MakeThrowing(&problem));
  const Snapshot before = problem.GetSnapshot();
  for (const int threads : {1, 2}) {
    evaluations = 0;
    throw_from = problem.NumEdges() + 10;
    EXPECT_NE(WhatOf([&] { problem.Solve({.num_threads = threads}); }), "");
    throw_from = -1;
    EXPECT_EQ(problem.GetSnapshot().states, before.states);
  }
}

TEST(Exceptions, OfALossACallbackASolverComeOut) {
  for (const int threads : {1, 2}) {
    Strip strip({.noise = 0.5, .loss = ThrowingLoss{}});
    const double start = strip.problem.Cost().value();
    SolveOptions options;
    options.num_threads = threads;
    options.cost_tolerance = 0.0;
    options.callback = [&](const IterationSummary& iteration) {
      if (iteration.iteration == 1) loss_throws = true;
      return CallbackAction::kContinue;
    };
    EXPECT_EQ(WhatOf([&] { strip.problem.Solve(options); }), "loss");
    loss_throws = false;
    EXPECT_LT(strip.problem.Cost().value(), start);

    options.callback = [](const IterationSummary& iteration) -> CallbackAction {
      if (iteration.iteration == 2) throw std::runtime_error("callback");
      return CallbackAction::kContinue;
    };
    EXPECT_EQ(WhatOf([&] { strip.problem.Solve(options); }), "callback");

    ThrowingSolver solver;
    options.callback = {};
    options.linear_solver = &solver;
    EXPECT_EQ(WhatOf([&] { strip.problem.Solve(options); }), "solver");
    options.linear_solver = nullptr;
    EXPECT_TRUE(strip.problem.Solve(options).ok());
  }
}

TEST(Exceptions, UndoTheGauge) {
  Strip strip({.noise = 0.5});
  Problem& problem = strip.problem;
  ASSERT_TRUE(problem.SetFixed(strip.frames[0], Fix::kFree).ok());
  ASSERT_TRUE(problem.SetFixed(strip.frames[1], Fix::kPosition).ok());
  const int edges = problem.NumEdges();
  for (const Gauge& gauge :
       {Gauge(Gauge::Fixed{strip.frames[2]}), Gauge(Gauge::Fixed{strip.frames[1]}),
        Gauge(Gauge::FixedPoses{strip.frames[2], strip.frames[3]}),
        Gauge(Gauge::Prior{strip.frames[2]})}) {
    SolveOptions options;
    options.gauge = gauge;
    options.callback = [](const IterationSummary& iteration) -> CallbackAction {
      if (iteration.iteration == 1) throw 17;
      return CallbackAction::kContinue;
    };
    EXPECT_THROW(problem.Solve(options), int);
    EXPECT_FALSE(problem.IsHolding());
    EXPECT_EQ(problem.NumEdges(), edges);
    EXPECT_EQ(problem.GetFixed(strip.frames[1]), Fix::kPosition);
    EXPECT_EQ(problem.GetFixed(strip.frames[2]), Fix::kFree);
    EXPECT_EQ(problem.free_tangents().size(), 1u);
  }
}

TEST(Exceptions, OfTheStepApiAndOfMarginalizationLeaveTheGraph) {
  Problem problem;
  ASSERT_NO_FATAL_FAILURE(MakeThrowing(&problem));
  const Snapshot before = problem.GetSnapshot();
  const int edges = problem.NumEdges();
  const AnyVertex pose = problem.Vertices().front();
  evaluations = throw_from = 0;
  EXPECT_NE(WhatOf([&] { (void)problem.MakeHessian(); }), "");
  EXPECT_NE(WhatOf([&] { (void)problem.Marginalize({pose}); }), "");
  EXPECT_NE(WhatOf([&] { (void)problem.ComputeCovariance(std::span(&pose, 1)); }), "");
  throw_from = -1;
  MarginalizeOptions options;
  options.drop_if = [](const Graph&, AnyEdge) -> bool { throw std::runtime_error("rule"); };
  EXPECT_EQ(WhatOf([&] { (void)problem.Marginalize({pose}, options); }), "rule");
  EXPECT_EQ(problem.GetSnapshot().states, before.states);
  EXPECT_EQ(problem.NumEdges(), edges);
  EXPECT_TRUE(problem.MakeHessian().ok());
  EXPECT_TRUE(problem.Marginalize({pose}).ok());
}

}  // namespace
}  // namespace glissade
