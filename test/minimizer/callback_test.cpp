// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What an iteration callback finds, and what becomes of a solve whose graph it has changed.

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "minimizer/strip.h"

namespace glissade {
namespace {

using test::Strip;

TEST(Callback, FindsTheStatesOfTheCostItIsToldOnTheCallersThread) {
  Strip strip({.noise = 0.5});
  SolveOptions options;
  options.num_threads = 2;
  options.max_iterations = 8;
  options.initial_lambda = 1e-12;
  const auto caller = std::this_thread::get_id();
  int calls = 0;
  options.callback = [&](const IterationSummary& iteration) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(iteration.iteration, calls++);
    EXPECT_NEAR(strip.problem.Cost().value(), iteration.cost, 1e-9 * iteration.cost);
    return CallbackAction::kContinue;
  };
  const SolveSummary& summary = strip.problem.Solve(options);
  EXPECT_TRUE(summary.ok()) << summary.BriefReport();
  EXPECT_EQ(calls, static_cast<int>(summary.iterations.size()));
}

// Plans and pointers into the graph were used on: memory was corrupted.
TEST(Callback, ThatChangesTheGraphEndsTheSolve) {
  const std::pair<const char*, std::function<void(Strip*)>> changes[] = {
      {"adds vertices",
       [](Strip* s) {
         for (int k = 0; k < 1000; ++k)
           (void)s->problem.AddVertex(VertexInverseDepth{0.1});
       }},
      {"adds an edge", [](Strip* s) { (void)s->problem.AddEdge(EdgeSE3Prior{}, {s->frames[3]}); }},
      {"removes a landmark", [](Strip* s) { (void)s->problem.RemoveVertex(s->depths[3]); }},
      {"removes all edges",
       [](Strip* s) {
         for (const AnyEdge& edge : s->problem.Edges())
           (void)s->problem.RemoveEdge(edge);
       }},
      {"fixes a pose", [](Strip* s) { (void)s->problem.SetFixed(s->frames[3]); }},
      {"sets a value",
       [](Strip* s) { (void)s->problem.Set(s->depths[3], VertexInverseDepth{0.3}); }},
      {"sets a loss",
       [](Strip* s) { (void)s->problem.SetLoss(s->problem.Edges().front(), Huber{1.0}); }},
      {"marginalizes", [](Strip* s) { (void)s->problem.Marginalize({s->depths[3]}); }},
      {"solves it", [](Strip* s) { (void)s->problem.Solve({.max_iterations = 3}); }},
      {"solves it under a gauge",
       [](Strip* s) {
         (void)s->problem.Solve({.max_iterations = 3, .gauge = Gauge::Fixed{s->frames[2]}});
       }},
      {"clears it", [](Strip* s) { s->problem = Problem(); }},
  };
  for (const auto& [name, change] : changes) {
    for (const bool gauge : {false, true}) {
      for (const int at : {0, 1, 3}) {
        SCOPED_TRACE(std::string(name) + " at " + std::to_string(at));
        Strip strip({.noise = 0.5});
        SolveOptions options;
        options.cost_tolerance = 0.0;
        if (gauge) options.gauge = Gauge::Fixed{strip.frames[2]};
        int calls = 0;
        options.callback = [&](const IterationSummary& iteration) {
          ++calls;
          if (iteration.iteration == at) change(&strip);
          return CallbackAction::kContinue;
        };
        const SolveSummary& summary = strip.problem.Solve(options);
        EXPECT_EQ(summary.termination, Termination::kFailed);
        EXPECT_EQ(summary.status.code(), StatusCode::kInvalidArgument);
        EXPECT_NE(summary.status.message().find("callback"), std::string::npos)
            << summary.status.message();
        EXPECT_EQ(calls, at + 1);
        EXPECT_FALSE(strip.problem.IsHolding());
        EXPECT_EQ(strip.problem.GetFixed(strip.frames[4]), Fix::kFree);
        if (strip.problem.NumEdges() == 0) continue;
        EXPECT_TRUE(strip.problem.Solve().ok()) << "later solves work";
      }
    }
  }
}

// The workspace of the running solve went with the Problem.
TEST(Callback, ThatMovesTheProblemEndsTheSolve) {
  for (const Gauge::Kind kind : {Gauge::Kind::kFree, Gauge::Kind::kFixed, Gauge::Kind::kPrior}) {
    for (const bool destroy : {false, true}) {
      Strip strip({.noise = 0.5});
      const int edges = strip.problem.NumEdges();
      SolveOptions options;
      if (kind == Gauge::Kind::kFixed) options.gauge = Gauge::Fixed{strip.frames[2]};
      if (kind == Gauge::Kind::kPrior) options.gauge = Gauge::Prior{strip.frames[2]};
      std::optional<Problem> thief;
      options.callback = [&](const IterationSummary& iteration) {
        if (iteration.iteration == 2) {
          thief.emplace(std::move(strip.problem));
          if (destroy) thief.reset();
        }
        return CallbackAction::kContinue;
      };
      const SolveSummary& summary = strip.problem.Solve(options);
      EXPECT_EQ(summary.status.code(), StatusCode::kInvalidArgument) << summary.BriefReport();
      if (destroy) continue;
      EXPECT_EQ(thief->NumEdges(), edges) << "nothing of the gauge came along";
      EXPECT_EQ(thief->GetFixed(strip.frames[2]), Fix::kFree);
      EXPECT_TRUE(thief->Solve().ok());
    }
  }
}

TEST(Callback, ReturnValueThatIsNoneIsRefused) {
  Strip strip;
  SolveOptions options;
  options.callback = [](const IterationSummary&) { return static_cast<CallbackAction>(7); };
  EXPECT_EQ(strip.problem.Solve(options).status.code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade
