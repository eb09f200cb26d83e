// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// EdgesOf() walked all edges of the graph, so that a front end's questions about its landmarks cost
// more than its solve. And what goes with lists of edges: their order, removal, copies.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "graph/toy_graphs.h"
#include "support/graph_random.h"

namespace glissade::test {
namespace {

/// Each vertex has the edges that name it, in the order of Edges(), as a search through all says.
void ExpectTrueLists(const Graph& graph) {
  const std::vector<AnyEdge> edges = graph.Edges();
  std::vector<std::vector<AnyVertex>> on;
  for (const AnyEdge& edge : edges)
    on.push_back(Must(graph.VerticesOf(edge)));
  EXPECT_EQ(graph.NumEdges(), int(edges.size()));
  for (const AnyVertex& vertex : graph.Vertices()) {
    std::vector<AnyEdge> expected;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (std::count(on[k].begin(), on[k].end(), vertex) > 0) expected.push_back(edges[k]);
    }
    ASSERT_EQ(Must(graph.EdgesOf(vertex)), expected) << ToString(vertex);
    ASSERT_EQ(Must(graph.NumEdgesOf(vertex)), int(expected.size()));
  }
}

std::unique_ptr<DynamicEdge> PriorFor(const Graph& graph, std::span<const AnyVertex> vertices) {
  std::vector<const VertexOps*> types;
  std::vector<double> x0;
  std::size_t dim = 0;
  for (const AnyVertex& vertex : vertices) {
    types.push_back(&graph.PoolOf(vertex.type)->ops());
    const auto x = graph.LinearizationPoint(vertex);
    x0.insert(x0.end(), x.begin(), x.end());
    dim += std::size_t(types.back()->tangent_dim);
  }
  const std::vector<double> r0(1, 0.0), J(dim, 1.0);
  return std::move(EdgeMarginalPrior::Create(types, x0, r0, J)).value();
}

/// Adds and removes at random: landmarks with their observations, poses with priors of both kinds.
class Walk {
 public:
  explicit Walk(std::uint64_t seed) : random_(seed) {
    for (int k = 0; k < 4; ++k)
      AddPose();
  }
  void Step() {
    const int what = random_.Int(10);
    if (what < 2) {
      AddPose();
    } else if (what < 5) {
      AddLandmark();
    } else if (what == 5) {
      AddPrior();
    } else if (what < 8) {
      const std::vector<AnyEdge> edges = graph.Edges();
      if (!edges.empty()) Must(graph.RemoveEdge(Pick(edges)));
    } else if (what == 8 && graph.NumVertices<VertexPose>() > 3) {
      Must(graph.RemoveVertex(Pick(graph.Vertices()), PriorOnVertex::kRemove));
    } else if (random_.Chance(0.3)) {
      graph.Compact();
    }
  }

  Graph graph;

 private:
  template <class T>
  T Pick(const std::vector<T>& all) {
    return all[std::size_t(random_.Int(int(all.size())))];
  }
  std::vector<VertexHandle<VertexPose>> Poses() const {
    std::vector<VertexHandle<VertexPose>> poses;
    graph.ForEachVertex<VertexPose>([&](auto handle, const auto&) { poses.push_back(handle); });
    return poses;
  }
  void AddPose() {
    const auto pose = Must(graph.AddVertex(VertexPose()));
    if (random_.Chance(0.5)) Must(graph.AddEdge(EdgeSE3Prior(), {pose}));
    const auto before = Pick(Poses());
    if (before != pose) Must(graph.AddEdge(EdgeRelativePose(), {before, pose}));
  }
  void AddLandmark() {
    const auto depth = Must(graph.AddVertex(VertexInverseDepth{0.5}));
    const auto poses = Poses();
    for (std::size_t k = 1; k < poses.size(); ++k) {
      if (random_.Chance(0.5)) Must(graph.AddEdge(EdgeReprojection(), {poses[0], poses[k], depth}));
    }
  }
  void AddPrior() {
    std::vector<AnyVertex> on;
    for (const auto& pose : Poses()) {
      if (random_.Chance(0.4)) on.emplace_back(pose);
    }
    if (!on.empty()) Must(graph.AddEdge(PriorFor(graph, on), on));
  }

  GraphRandom random_;
};

TEST(EdgesOf, IsWhatASearchThroughAllEdgesFinds) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    Walk walk(seed);
    for (int k = 0; k < 120; ++k) {
      walk.Step();
      ExpectTrueLists(walk.graph);
      if (k % 30 != 29) continue;
      // A copy has lists of its own, and what was moved from is empty.
      Graph copy = walk.graph.Clone();
      ExpectTrueLists(copy);
      for (const AnyVertex& vertex : copy.Vertices())
        Must(copy.RemoveVertex(vertex, PriorOnVertex::kRemove));
      EXPECT_EQ(copy.NumEdges(), 0);
      ExpectTrueLists(walk.graph);
      Graph moved = std::move(walk.graph);
      EXPECT_EQ(walk.graph.NumEdges(), 0);
      ExpectTrueLists(moved);
      walk.graph = std::move(moved);
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(EdgesOf, AGaugesEdgeComesAndGoes) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 4, .landmarks = 12, .track = 3});
  const AnyVertex on[] = {w.poses[1], w.poses[2]};
  for (int turn = 0; turn < 3; ++turn) {
    const int before = Must(graph.NumEdgesOf(on[0]));
    Must(graph.BeginHold({}, PriorFor(graph, on), on));
    EXPECT_EQ(Must(graph.NumEdgesOf(on[0])), before + 1);
    ExpectTrueLists(graph);
    const int dying = turn == 1 ? 1 : 0;  // the landmark's observation from on[0]
    if (turn == 1) Must(graph.RemoveVertex(w.landmarks[0]));
    if (turn == 2) Must(graph.AddEdge(PriorFor(graph, on), on));  // it is not the youngest then
    graph.EndHold();
    EXPECT_EQ(Must(graph.NumEdgesOf(on[0])), (turn == 2 ? before + 1 : before) - dying);
    ExpectTrueLists(graph);
  }
}

TEST(EdgesOf, AVertexInTheSlotOfARemovedOneHasNoneOfItsEdges) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 4, .landmarks = 12, .track = 3});
  Must(graph.RemoveVertex(w.poses[1]));
  const auto pose = Must(graph.AddVertex(VertexPose()));
  ASSERT_EQ(pose.slot, w.poses[1].slot);
  EXPECT_EQ(Must(graph.NumEdgesOf(pose)), 0);
  const auto edge = Must(graph.AddEdge(EdgeRelativePose(), {w.poses[0], pose}));
  EXPECT_EQ(Must(graph.EdgesOf(pose)), std::vector<AnyEdge>{AnyEdge(edge)});
  ExpectTrueLists(graph);
}

TEST(EdgesOf, EdgesDieWithTheirVertexAtOnce) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 4, .landmarks = 12, .track = 3});
  const auto& pool = *graph.Pool<EdgeReprojection>();
  const int before = pool.slots().NumAlive();
  const int dying = Must(graph.NumEdgesOf(w.landmarks[0]));
  ASSERT_GT(dying, 0);
  Must(graph.RemoveVertex(w.landmarks[0]));
  EXPECT_EQ(pool.slots().NumAlive(), before - dying);
  EXPECT_EQ(graph.NumEdges<EdgeReprojection>(), before - dying);
}

/// Seconds of the fastest of some runs over the first landmarks.
double TimeOfQuestions(int frames_apart) {
  Graph graph;
  std::vector<VertexHandle<VertexInverseDepth>> depths;
  for (int group = 0; group < frames_apart; ++group) {
    const auto a = Must(graph.AddVertex(VertexPose())), b = Must(graph.AddVertex(VertexPose()));
    for (int k = 0; k < 20; ++k) {
      depths.push_back(Must(graph.AddVertex(VertexInverseDepth{0.5})));
      Must(graph.AddEdge(EdgeReprojection(), {a, b, depths.back()}));
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 20; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    int sum = 0;
    for (std::size_t k = 0; k < 20; ++k)
      sum += Must(graph.NumEdgesOf(depths[k])) + int(Must(graph.EdgesOf(depths[k])).size());
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(sum, 40);
    best = std::min(best, time.count());
  }
  return best;
}

// A thousand times as many edges: a search through all takes a thousand times as long, or nearly.
TEST(EdgesOf, CostsTheDegreeNotAllEdges) {
  const double small = TimeOfQuestions(1), large = TimeOfQuestions(1000);
  EXPECT_LT(large, 20.0 * small);
}

TEST(ForEachEdge, HandsTheVerticesWhereTheyAreAskedFor) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 4, .landmarks = 12, .track = 3});
  Must(graph.RemoveVertex(w.landmarks[2]));
  std::vector<AnyEdge> with, without;
  graph.ForEachEdge<EdgeReprojection>([&](EdgeHandle<EdgeReprojection> edge,
                                          const EdgeReprojection& value,
                                          const EdgeVertexHandles<EdgeReprojection>& vertices) {
    const auto& [host, target, depth] = vertices;
    EXPECT_EQ(Must(graph.VerticesOf(edge)), (std::vector<AnyVertex>{host, target, depth}));
    EXPECT_EQ(&value, graph.Find(edge));
    EXPECT_NE(graph.Find(depth), nullptr);
    with.emplace_back(edge);
  });
  graph.ForEachEdge<EdgeReprojection>([&](auto edge, const auto&) { without.emplace_back(edge); });
  EXPECT_EQ(with, without);
  EXPECT_EQ(int(with.size()), graph.NumEdges<EdgeReprojection>());
}

}  // namespace
}  // namespace glissade::test
