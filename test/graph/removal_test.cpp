// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Removing, compacting, and that results do not depend on what was there before.

#include <gtest/gtest.h>

#include <algorithm>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

TEST(GraphRemoval, TakesTheEdgesOfAVertexAndNothingElse) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 4, .landmarks = 12, .track = 3});
  const AnyVertex gone = w.poses[1];
  const std::vector<AnyEdge> dying = Must(graph.EdgesOf(gone));
  ASSERT_FALSE(dying.empty());
  const std::vector<AnyEdge> all = graph.Edges();
  std::vector<AnyEdge> staying;
  double chi2 = 0.0;
  for (const AnyEdge& edge : all) {
    if (std::find(dying.begin(), dying.end(), edge) != dying.end()) continue;
    staying.push_back(edge);
    chi2 += Must(graph.Chi2(edge));
  }
  Must(graph.RemoveVertex(gone));
  EXPECT_EQ(graph.Edges(), staying);
  EXPECT_EQ(graph.NumEdges(), int(staying.size()));
  EXPECT_EQ(graph.NumVertices<VertexPose>(), 3);
  EXPECT_EQ(graph.NumVertices<VertexInverseDepth>(), 12);
  EXPECT_NEAR(Must(graph.Chi2()), chi2, 1e-9 * chi2);
  graph.Compact();
  EXPECT_EQ(graph.Edges(), staying);
  EXPECT_NEAR(Must(graph.Chi2()), chi2, 1e-9 * chi2);
}

TEST(GraphRemoval, CompactKeepsWeightsLossesFixesAndElimination) {
  Graph graph;
  Window w = AddWindow(&graph, {.frames = 5, .landmarks = 15, .track = 4});
  Must(graph.SetFixed(w.poses[3]));
  Must(graph.SetFixed(w.poses[4], Fix::kPositionAndYaw));
  Must(graph.SetFixed(w.landmarks[7]));
  Must(graph.SetEliminated(w.landmarks[9], false));
  Must(graph.SetSqrtInformation(w.edges[30], Matrix2(7.0 * Matrix2::Identity())));
  Must(graph.SetLoss(w.edges[31], Huber{0.3}));
  const auto values = [&] {
    std::vector<double> chi2;
    for (const AnyEdge& edge : graph.Edges())
      chi2.push_back(Must(graph.Chi2(edge)));
    return chi2;
  };
  Must(graph.RemoveVertex(w.landmarks[0]));
  Must(graph.RemoveVertex(w.landmarks[3]));
  Must(graph.RemoveVertex(w.poses[2]));
  Must(graph.RemoveEdge(w.edges[5]));
  const std::vector<double> chi2 = values();
  const double cost = Must(graph.Cost());
  const Snapshot snapshot = graph.GetSnapshot();
  graph.Compact();
  EXPECT_EQ(values(), chi2);
  EXPECT_EQ(Must(graph.Cost()), cost);
  EXPECT_TRUE(SameBits(graph.GetSnapshot(), snapshot));
  EXPECT_EQ(graph.GetFixed(w.poses[3]), Fix::kWhole);
  EXPECT_EQ(graph.GetFixed(w.poses[4]), Fix::kPositionAndYaw);
  EXPECT_EQ(graph.GetFixed(w.landmarks[7]), Fix::kWhole);
  EXPECT_EQ(graph.GetFixed(w.landmarks[8]), Fix::kFree);
  // Elimination moved along as well: the landmark kept is the only one among the kept variables.
  Problem problem(std::move(graph));
  Must(problem.MakeHessian());
  const std::vector<AnyVertex> free = problem.FreeVertices();
  const auto kept = std::find(free.begin(), free.end(), AnyVertex(w.landmarks[9]));
  const auto eliminated = std::find(free.begin(), free.end(), AnyVertex(w.landmarks[8]));
  ASSERT_NE(kept, free.end());
  ASSERT_NE(eliminated, free.end());
  EXPECT_EQ(kept - free.begin(), 3) << "after poses 0, 1 and 4";
  EXPECT_GT(eliminated, kept);
  EXPECT_EQ(std::count(free.begin(), free.end(), AnyVertex(w.landmarks[7])), 0) << "is fixed";
}

/// Builds the same window on top of different pasts.
struct Past {
  const char* name;
  void (*make)(Graph*);
};
const Past kPasts[] = {
    {"a vertex of each type, gone",
     [](Graph* g) {
       const VertexHandle<VertexInverseDepth> d = g->AddVertex(VertexInverseDepth{1.0});
       const VertexHandle<VertexPose> p = g->AddVertex(VertexPose());
       Must(g->RemoveVertex(d));
       Must(g->RemoveVertex(p));
     }},
    {"a window, gone and compacted",
     [](Graph* g) {
       AddWindow(g, {.frames = 7, .landmarks = 40, .seed = 77});
       for (const AnyVertex& v : g->Vertices())
         Must(g->RemoveVertex(v));
       g->Compact();
     }},
    {"a window, gone, not compacted",
     [](Graph* g) {
       AddWindow(g, {.frames = 3, .landmarks = 9, .seed = 78});
       for (const AnyVertex& v : g->Vertices())
         Must(g->RemoveVertex(v));
     }},
    {"types in another order, gone",
     [](Graph* g) {
       // First come types that the window uses later or not at all.
       const VertexHandle<Spot> s = g->AddVertex(Spot());
       const VertexHandle<VertexVector<3>> x = g->AddVertex(VertexVector<3>());
       const VertexHandle<VertexPose> p = g->AddVertex(VertexPose());
       Must(g->AddEdge(EdgeLinearSpot(), {x, s}));
       Must(g->AddEdge(EdgeSE3Prior(), {p}));
       for (const AnyVertex& v : g->Vertices())
         Must(g->RemoveVertex(v));
     }},
};

/// Window, priors and a part of other types, so that the order of types matters.
void AddMixed(Graph* graph) {
  AddWindow(graph, {.frames = 4, .landmarks = 20, .seed = 5});
  const VertexHandle<VertexVector<3>> x = graph->AddVertex(VertexVector<3>{{1.0, 2.0, 3.0}});
  const VertexHandle<VertexVector<3>> y = graph->AddVertex(VertexVector<3>{{0.1, -0.2, 0.3}});
  EdgeLinearPair edge;
  edge.A = 0.7 * Matrix3::Identity();
  edge.B = 0.3 * Matrix3::Ones();
  Must(graph->AddEdge(edge, {x, y}));
  EdgeLinearSpot to_spot;
  to_spot.A.setOnes();
  to_spot.B << 1.0, 0.5, -0.3, 0.4, 0.2, -1.0, 0.1, 0.9;
  const VertexHandle<Spot> s = graph->AddVertex(Spot{{0.4, 0.6}});
  Must(graph->AddEdge(to_spot, {x, s}));
  Must(graph->AddEdge(to_spot, {y, s}));
}

TEST(GraphRemoval, ThePastDoesNotChangeABit) {
  Problem fresh;
  AddMixed(&fresh);
  const SolveOptions options{.max_iterations = 6};
  const SolveSummary expected = fresh.Solve(options);
  ASSERT_GT(expected.accepted_steps, 2);
  for (const Past& past : kPasts) {
    SCOPED_TRACE(past.name);
    Problem problem;
    past.make(&problem);
    AddMixed(&problem);
    const SolveSummary& summary = problem.Solve(options);
    EXPECT_TRUE(SameIterations(summary, expected));
    EXPECT_TRUE(SameStates(problem.GetSnapshot(), fresh.GetSnapshot()));
  }
}

TEST(GraphRemoval, RemovingInAnyOrderGivesTheSameBitsAsNeverAdding) {
  // The window of interest among others that go: first, last, interleaved, in two batches.
  const auto build = [](Problem* problem, int removal) {
    std::vector<Window> extra;
    extra.push_back(AddWindow(problem, {.frames = 3, .landmarks = 10, .seed = 50}));
    AddMixed(problem);
    extra.push_back(AddWindow(problem, {.frames = 4, .landmarks = 16, .seed = 51}));
    std::vector<AnyVertex> gone;
    for (const Window& w : extra) {
      gone.insert(gone.end(), w.poses.begin(), w.poses.end());
      gone.insert(gone.end(), w.landmarks.begin(), w.landmarks.end());
    }
    if (removal == 1) std::reverse(gone.begin(), gone.end());
    for (std::size_t k = 0; k < gone.size(); ++k) {
      Must(problem->RemoveVertex(gone[k]));
      if (removal == 2 && k == gone.size() / 2) problem->Compact();
    }
  };
  Problem fresh;
  AddMixed(&fresh);
  const SolveSummary expected = fresh.Solve({.max_iterations = 6});
  for (int removal = 0; removal < 3; ++removal) {
    SCOPED_TRACE(removal);
    Problem problem;
    build(&problem, removal);
    EXPECT_TRUE(SameIterations(problem.Solve({.max_iterations = 6}), expected));
    EXPECT_TRUE(SameStates(problem.GetSnapshot(), fresh.GetSnapshot()));
  }
}

TEST(GraphRemoval, BetweenSolvesGoesOnFromThePresentState) {
  Problem problem;
  const Window w = AddWindow(&problem, {.frames = 6, .landmarks = 30});
  ASSERT_TRUE(problem.Solve({.max_iterations = 3}).ok());
  Must(problem.RemoveVertex(w.poses[0]));
  Must(problem.RemoveEdge(w.edges[40]));
  Problem copy = problem.Clone();
  const SolveSummary expected = copy.Solve({.max_iterations = 5});
  const SolveSummary& summary = problem.Solve({.max_iterations = 5});
  EXPECT_TRUE(SameIterations(summary, expected));
  EXPECT_TRUE(SameStates(problem.GetSnapshot(), copy.GetSnapshot()));
  EXPECT_EQ(summary.num_edges, problem.NumEdges());
}

TEST(GraphRemoval, ASnapshotFitsAlsoAfterTheSolveThatCompacts) {
  // Types came in one order and, with the first of them gone, stand in another.
  Problem problem;
  const VertexHandle<VertexVector<3>> first = problem.AddVertex(VertexVector<3>());
  AddMixed(&problem);
  Must(problem.RemoveVertex(first));
  const Snapshot snapshot = problem.GetSnapshot();
  ASSERT_TRUE(problem.Solve({.max_iterations = 3}).ok());
  ASSERT_TRUE(problem.RestoreSnapshot(snapshot).ok());
  for (const AnyVertex& vertex : snapshot.vertices)
    EXPECT_TRUE(problem.Contains(vertex));
  Problem again = problem.Clone();
  ASSERT_TRUE(again.RestoreSnapshot(snapshot).ok()) << "the copy has the same handles";
  EXPECT_TRUE(SameBits(again.GetSnapshot(), problem.GetSnapshot()));
}

}  // namespace
}  // namespace glissade::test
