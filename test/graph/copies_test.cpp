// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Clone, move, snapshot.

#include <gtest/gtest.h>

#include "glissade/minimizer/minimizer.h"
#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

/// A graph with something of everything that a copy could forget.
Window BuildRich(Graph* graph) {
  Window w = AddWindow(graph, {.frames = 5, .landmarks = 25, .track = 3, .loss = Huber{1.5}});
  Must(graph->SetFixed(w.poses[0]));
  Must(graph->SetFixed(w.poses[1], Fix::kPositionAndYaw));
  Must(graph->SetFixed(w.poses[2], Fix::kPosition));
  Must(graph->SetFixed(w.landmarks[4]));
  Must(graph->SetEliminated(w.landmarks[5], false));
  Must(graph->SetLoss(w.edges[3], Cauchy{0.7}));
  Must(graph->RemoveVertex(w.landmarks[9]));
  Must(graph->RemoveEdge(w.edges[50]));
  return w;
}

TEST(GraphClone, BehavesLikeTheOriginalToTheLastBit) {
  Problem problem;
  BuildRich(&problem);
  Problem copy = problem.Clone();
  EXPECT_TRUE(GraphRecord(copy) == GraphRecord(problem));
  const SolveSummary a = problem.Solve({.max_iterations = 8});
  const SolveSummary b = copy.Solve({.max_iterations = 8});
  EXPECT_TRUE(SameIterations(a, b));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), copy.GetSnapshot()));
  // A copy in the middle of the game, charts moved and all.
  Problem later = problem.Clone();
  EXPECT_TRUE(SameIterations(problem.Solve({.max_iterations = 8}),
                             SolveSummary(later.Solve({.max_iterations = 8}))));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), later.GetSnapshot()));
}

TEST(GraphClone, SharesNothing) {
  Problem problem;
  const Window w = BuildRich(&problem);
  const GraphRecord before(problem);
  {
    Problem copy = problem.Clone();
    Must(copy.Set(w.landmarks[0], VertexInverseDepth{3.0}));
    Must(copy.SetFixed(w.poses[3]));
    Must(copy.SetLoss(w.edges[0], Tukey{1.0}));
    Must(copy.SetSqrtInformation(w.edges[1], Matrix2::Identity()));
    Must(copy.RemoveVertex(w.poses[4]));
    Must(copy.AddVertex(VertexPose()));
    Must(copy.AddVertex(VertexVector<2>()));
    copy.Compact();
    ASSERT_TRUE(copy.Solve({.max_iterations = 4}).ok());
    EXPECT_TRUE(GraphRecord(problem) == before);
    // And the other way round.
    Problem second = problem.Clone();
    const GraphRecord second_before(second);
    ASSERT_TRUE(problem.Solve({.max_iterations = 2}).ok());
    Must(problem.RemoveVertex(w.poses[3]));
    EXPECT_TRUE(GraphRecord(second) == second_before);
  }
  // The copies are gone; the original goes on.
  EXPECT_TRUE(problem.Solve({.max_iterations = 2}).ok());
  EXPECT_TRUE(problem.Contains(AnyVertex(w.poses[4])));
}

TEST(GraphClone, OfAnEmptyGraph) {
  const Graph graph;
  Graph copy = graph.Clone();
  EXPECT_EQ(copy.NumVertices(), 0);
  EXPECT_TRUE(copy.AddVertex(VertexPose()).ok());
}

TEST(GraphSnapshot, RestoresEveryBitAndTheWayOn) {
  Problem problem;
  const Window w = BuildRich(&problem);
  ASSERT_TRUE(problem.Solve({.max_iterations = 2}).ok());  // charts are off their anchors now
  const Snapshot snapshot = problem.GetSnapshot();
  const SolveSummary first = problem.Solve({.max_iterations = 6});
  const Snapshot end = problem.GetSnapshot();
  ASSERT_FALSE(SameBits(end, snapshot));

  Must(problem.RestoreSnapshot(snapshot));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), snapshot));
  const SolveSummary second = problem.Solve({.max_iterations = 6});
  EXPECT_TRUE(SameIterations(first, second));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), end));

  // Also where Set anchored a chart anew in between.
  Must(problem.Set(w.poses[1], VertexPose{problem.Get(w.poses[3]).pose}));
  Must(problem.RestoreSnapshot(snapshot));
  EXPECT_TRUE(SameIterations(problem.Solve({.max_iterations = 6}), first));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), end));
}

TEST(GraphSnapshot, AfterChangesOfWhatIsHeld) {
  Problem problem;
  const Window w = BuildRich(&problem);
  const Snapshot snapshot = problem.GetSnapshot();
  Must(problem.SetFixed(w.poses[1], Fix::kFree));
  Must(problem.SetFixed(w.poses[3], Fix::kPositionAndYaw));
  ASSERT_TRUE(problem.Solve({.max_iterations = 4}).ok());
  Must(problem.RestoreSnapshot(snapshot));
  EXPECT_TRUE(SameBits(problem.GetSnapshot(), snapshot)) << "values are those of the snapshot";
  EXPECT_EQ(problem.GetFixed(w.poses[1]), Fix::kFree) << "what is held is not part of it";
  EXPECT_EQ(problem.GetFixed(w.poses[3]), Fix::kPositionAndYaw);
  ASSERT_EQ(problem.free_tangents().size(), 2u);
  // The chart of pose 3 is anchored at the restored value: a first step of nothing moves nothing.
  Must(problem.MakeHessian());
  Must(problem.SolveLinearSystem(1e30));
  Must(problem.UpdateStates());
  const Snapshot after = problem.GetSnapshot();
  for (std::size_t k = 0; k < after.states.size(); ++k)
    EXPECT_NEAR(after.states[k], snapshot.states[k], 1e-14);
}

TEST(GraphSnapshot, FitsACloneToo) {
  Problem problem;
  BuildRich(&problem);
  const Snapshot snapshot = problem.GetSnapshot();
  Problem copy = problem.Clone();
  ASSERT_TRUE(copy.Solve({.max_iterations = 3}).ok());
  Must(copy.RestoreSnapshot(snapshot));
  EXPECT_TRUE(SameBits(copy.GetSnapshot(), snapshot));
}

TEST(GraphMove, TakesEverythingAlongAndLeavesAnEmptyGraph) {
  Graph graph;
  const Window w = BuildRich(&graph);
  const GraphRecord before(graph);
  Graph moved = std::move(graph);
  const GraphRecord after(moved);
  EXPECT_TRUE(SameBits(after.snapshot, before.snapshot));
  EXPECT_EQ(after.edges, before.edges);
  EXPECT_EQ(after.cost, before.cost);
  // NOLINTNEXTLINE: what is left behind is to be of use.
  EXPECT_EQ(graph.NumVertices(), 0);
  EXPECT_FALSE(graph.Contains(AnyVertex(w.poses[0])));
  const VertexHandle<VertexPose> pose = graph.AddVertex(VertexPose());
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior(), {pose}).ok());
  EXPECT_EQ(graph.NumEdges(), 1);
}

// A workspace knows its graph by more than an address and a count: graphs that come to lie where
// another was, with as many changes behind them, are analyzed anew.
TEST(GraphMove, AWorkspaceIsNotFooledByAGraphAtTheSamePlace) {
  SolverWorkspace workspace;
  Graph graph;
  AddWindow(&graph, {.frames = 6, .landmarks = 30});
  ASSERT_TRUE(Solve(&graph, &workspace, {.max_iterations = 2}).ok());

  Graph other = std::move(graph);
  const SolveSummary& empty = Solve(&graph, &workspace, {.max_iterations = 2});
  EXPECT_EQ(empty.status.code(), StatusCode::kNothingToSolve);
  EXPECT_EQ(empty.num_edges, 0);

  // As many calls, another topology.
  graph = Graph();
  AddWindow(&graph, {.frames = 6, .landmarks = 30, .track = 3});
  ASSERT_TRUE(Solve(&graph, &workspace, {.max_iterations = 2}).ok());
  Graph twin;
  AddWindow(&twin, {.frames = 10, .landmarks = 29, .track = 3, .seed = 3});
  ASSERT_EQ(twin.structure_version(), graph.structure_version()) << "the test wants a coincidence";
  Graph reference = twin.Clone();
  graph = std::move(twin);
  SolverWorkspace fresh;
  const SolveSummary expected = Solve(&reference, &fresh, {.max_iterations = 3});
  EXPECT_TRUE(SameIterations(Solve(&graph, &workspace, {.max_iterations = 3}), expected));
  EXPECT_TRUE(SameStates(graph.GetSnapshot(), reference.GetSnapshot()));
}

TEST(GraphMove, AWorkspaceInALoopOverGraphs) {
  SolverWorkspace workspace;
  for (int turn = 0; turn < 4; ++turn) {
    Graph graph;  // likely at the same address every time
    AddWindow(&graph, {.frames = 4 + turn, .landmarks = 32 - turn, .seed = std::uint64_t(turn)});
    Graph copy = graph.Clone();
    SolverWorkspace fresh;
    const SolveSummary expected = Solve(&copy, &fresh, {.max_iterations = 3});
    EXPECT_TRUE(SameIterations(Solve(&graph, &workspace, {.max_iterations = 3}), expected));
  }
}

}  // namespace
}  // namespace glissade::test
