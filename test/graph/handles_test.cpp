// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

using Number = VertexVector<1>;
using NumberHandle = VertexHandle<Number>;

/// Ties one number to a value.
struct EdgeNumber {
  using Vertices = VertexList<Number>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  bool Evaluate(const Number& x, Vector<1>& r, Jacobian<1, 1>* J) const {
    r[0] = x.value[0] - measured;
    if (J) (*J)(0, 0) = 1.0;
    return true;
  }
};

/// Ties two numbers together.
struct EdgeDifference {
  using Vertices = VertexList<Number, Number>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  bool Evaluate(const Number& x, const Number& y, Vector<1>& r, Jacobian<1, 1>* J_x,
                Jacobian<1, 1>* J_y) const {
    r[0] = y.value[0] - x.value[0] - measured;
    if (J_x) (*J_x)(0, 0) = -1.0;
    if (J_y) (*J_y)(0, 0) = 1.0;
    return true;
  }
};

/// Every call that takes a vertex handle refuses this one and leaves the graph alone.
void ExpectRefused(Graph* graph, NumberHandle dead) {
  const GraphRecord before(*graph);
  EXPECT_FALSE(graph->Contains(AnyVertex(dead)));
  EXPECT_EQ(graph->Find(dead), nullptr);
  EXPECT_EQ(graph->Get(dead).value[0], 0.0);
  EXPECT_EQ(graph->Set(dead, Number{{5.0}}).code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->SetFixed(dead).code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->SetEliminated(dead, true).code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->GetFixed(dead), Fix::kFree);
  const Status removal = graph->RemoveVertex(dead);
  EXPECT_EQ(removal.code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(removal.vertex(), AnyVertex(dead));
  const auto edge = graph->AddEdge(EdgeNumber{}, {dead});
  EXPECT_EQ(edge.status().code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(edge.status().vertex(), AnyVertex(dead));
  EXPECT_EQ(graph->EdgesOf(dead).status().code(), StatusCode::kUnknownHandle);
  EXPECT_TRUE(GraphRecord(*graph) == before);
}

void ExpectRefused(Graph* graph, EdgeHandle<EdgeNumber> dead) {
  const GraphRecord before(*graph);
  EXPECT_FALSE(graph->Contains(AnyEdge(dead)));
  EXPECT_EQ(graph->Find(dead), nullptr);
  const Status removal = graph->RemoveEdge(dead);
  EXPECT_EQ(removal.code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(removal.edge(), AnyEdge(dead));
  EXPECT_EQ(graph->SetLoss(dead, Huber{1.0}).code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->SetInformation(dead, SquareMatrix<1>::Identity()).code(),
            StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->SetSqrtInformation(dead, SquareMatrix<1>::Identity()).code(),
            StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->Chi2(dead).status().code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->DepthOf(dead).status().code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph->VerticesOf(dead).status().code(), StatusCode::kUnknownHandle);
  EXPECT_TRUE(GraphRecord(*graph) == before);
}

TEST(GraphHandles, NullAndMadeUpHandlesAreRefused) {
  Graph empty;
  ExpectRefused(&empty, NumberHandle());
  ExpectRefused(&empty, NumberHandle{0, 0});
  ExpectRefused(&empty, EdgeHandle<EdgeNumber>());

  Graph graph;
  const NumberHandle x = graph.AddVertex(Number{{1.0}});
  Must(graph.AddEdge(EdgeNumber{}, {x}));
  ExpectRefused(&graph, NumberHandle());
  ExpectRefused(&graph, NumberHandle{x.slot, x.generation});
  ExpectRefused(&graph, NumberHandle{x.slot, x.generation, x.graph + 1});
  ExpectRefused(&graph, NumberHandle{x.slot, x.generation + 1, x.graph});
  ExpectRefused(&graph, NumberHandle{x.slot + 1, 0, x.graph});
  ExpectRefused(&graph, NumberHandle{0x7fffffff, 0, x.graph});
  ExpectRefused(&graph, EdgeHandle<EdgeNumber>());
  ExpectRefused(&graph, EdgeHandle<EdgeNumber>{0, 1, x.graph});
  ExpectRefused(&graph, EdgeHandle<EdgeNumber>{1, 0, x.graph});
  EXPECT_FALSE(graph.Contains(AnyVertex(nullptr, 0, 0)));
  EXPECT_FALSE(graph.Contains(AnyEdge(nullptr, 0, 0)));
  EXPECT_FALSE(graph.Contains(AnyVertex(VertexHandle<VertexPose>{0, 0, x.graph})))
      << "another type";
}

TEST(GraphHandles, OfRemovedVerticesStayDeadWhenTheSlotIsUsedAgain) {
  Graph graph;
  const NumberHandle a = graph.AddVertex(Number{{1.0}});
  const NumberHandle b = graph.AddVertex(Number{{2.0}});
  Must(graph.RemoveVertex(a));
  ExpectRefused(&graph, a);
  const NumberHandle c = graph.AddVertex(Number{{3.0}});
  EXPECT_EQ(c.slot, a.slot) << "the test wants the slot to be used again";
  EXPECT_NE(c.generation, a.generation);
  ExpectRefused(&graph, a);
  EXPECT_EQ(graph.Get(b).value[0], 2.0);
  EXPECT_EQ(graph.Get(c).value[0], 3.0);
  graph.Compact();
  ExpectRefused(&graph, a);
  EXPECT_EQ(graph.Get(b).value[0], 2.0);
  EXPECT_EQ(graph.Get(c).value[0], 3.0);
}

TEST(GraphHandles, OfEdgesDieWithTheirVertices) {
  Graph graph;
  const NumberHandle a = graph.AddVertex(Number{{1.0}});
  const NumberHandle b = graph.AddVertex(Number{{2.0}});
  const auto on_a = Must(graph.AddEdge(EdgeNumber{0.5}, {a}));
  const auto on_b = Must(graph.AddEdge(EdgeNumber{0.5}, {b}));
  const auto both = Must(graph.AddEdge(EdgeDifference{}, {a, b}));
  Must(graph.RemoveVertex(a));
  EXPECT_EQ(graph.NumEdges(), 1);
  ExpectRefused(&graph, on_a);
  EXPECT_FALSE(graph.Contains(AnyEdge(both)));
  EXPECT_TRUE(graph.Contains(AnyEdge(on_b)));

  // Its slot is used again before anything was compacted: the edge must not come back to life.
  const NumberHandle again = graph.AddVertex(Number{{7.0}});
  ASSERT_EQ(again.slot, a.slot);
  ExpectRefused(&graph, on_a);
  EXPECT_FALSE(graph.Contains(AnyEdge(both)));
  EXPECT_EQ(graph.NumEdges(), 1);
  EXPECT_TRUE(Must(graph.EdgesOf(again)).empty());
  EXPECT_EQ(Must(graph.Chi2()), 1.5 * 1.5);

  graph.Compact();
  const auto newer = Must(graph.AddEdge(EdgeNumber{7.0}, {again}));
  EXPECT_NE(newer, on_a);
  ExpectRefused(&graph, on_a);
  EXPECT_EQ(graph.NumEdges(), 2);
}

TEST(GraphHandles, SurviveCompaction) {
  Graph graph;
  std::vector<NumberHandle> x;
  std::vector<EdgeHandle<EdgeNumber>> e;
  for (int k = 0; k < 10; ++k) {
    x.push_back(graph.AddVertex(Number{{double(k)}}));
    e.push_back(graph.AddEdge(EdgeNumber{10.0 * k}, {x.back()}));
  }
  for (const int k : {0, 3, 4, 9})
    Must(graph.RemoveVertex(x[std::size_t(k)]));
  graph.Compact();
  for (const int k : {1, 2, 5, 6, 7, 8}) {
    ASSERT_NE(graph.Find(x[std::size_t(k)]), nullptr);
    EXPECT_EQ(graph.Find(x[std::size_t(k)])->value[0], k);
    ASSERT_NE(graph.Find(e[std::size_t(k)]), nullptr);
    EXPECT_EQ(graph.Find(e[std::size_t(k)])->measured, 10.0 * k);
    EXPECT_EQ(Must(graph.Chi2(AnyEdge(e[std::size_t(k)]))), 81.0 * k * k);
  }
}

// A model of a graph as a list, compared after each of many random operations.
TEST(GraphHandles, RandomAddsAndRemovalsAgreeWithAModel) {
  Random random(5);
  Graph graph;
  struct Item {
    NumberHandle handle;
    double value;
  };
  struct Link {
    EdgeHandle<EdgeDifference> handle;
    NumberHandle from, to;
    double measured;
  };
  std::vector<Item> items;
  std::vector<Link> links;
  std::vector<NumberHandle> dead;
  std::vector<EdgeHandle<EdgeDifference>> dead_edges;
  const auto pick = [&](std::size_t n) { return std::size_t(random.Uniform(0.0, double(n))); };
  for (int step = 0; step < 3000; ++step) {
    const double what = random.Uniform(0.0, 1.0);
    if (what < 0.35 || items.size() < 3) {
      const double value = random.Uniform(-1.0, 1.0);
      items.push_back({graph.AddVertex(Number{{value}}), value});
    } else if (what < 0.65) {
      const std::size_t i = pick(items.size()), j = pick(items.size());
      const auto edge =
          graph.AddEdge(EdgeDifference{double(step)}, {items[i].handle, items[j].handle});
      ASSERT_EQ(edge.ok(), i != j);
      if (i != j) {
        links.push_back({edge.value(), items[i].handle, items[j].handle, double(step)});
      }
    } else if (what < 0.8) {
      const std::size_t i = pick(items.size());
      const NumberHandle gone = items[i].handle;
      Must(graph.RemoveVertex(gone));
      dead.push_back(gone);
      items.erase(items.begin() + std::ptrdiff_t(i));
      std::erase_if(links, [&](const Link& link) {
        const bool dies = link.from == gone || link.to == gone;
        if (dies) dead_edges.push_back(link.handle);
        return dies;
      });
    } else if (what < 0.95) {
      if (links.empty()) continue;
      const std::size_t i = pick(links.size());
      Must(graph.RemoveEdge(links[i].handle));
      dead_edges.push_back(links[i].handle);
      links.erase(links.begin() + std::ptrdiff_t(i));
    } else {
      graph.Compact();
    }
    ASSERT_EQ(graph.NumVertices(), int(items.size()));
    ASSERT_EQ(graph.NumEdges(), int(links.size()));
    ASSERT_EQ(graph.NumEdges<EdgeDifference>(), int(links.size()));
    if (step % 50 != 0) continue;
    std::size_t k = 0;
    graph.ForEachVertex<Number>([&](NumberHandle handle, const Number& value) {
      ASSERT_LT(k, items.size());
      EXPECT_EQ(handle, items[k].handle) << "insertion order";
      EXPECT_EQ(value.value[0], items[k].value);
      ++k;
    });
    k = 0;
    graph.ForEachEdge<EdgeDifference>([&](EdgeHandle<EdgeDifference> h, const EdgeDifference& e) {
      ASSERT_LT(k, links.size());
      EXPECT_EQ(h, links[k].handle) << "insertion order";
      EXPECT_EQ(e.measured, links[k].measured);
      EXPECT_EQ(Must(graph.VerticesOf(h)), (std::vector<AnyVertex>{links[k].from, links[k].to}));
      ++k;
    });
    for (const NumberHandle& handle : dead)
      ASSERT_FALSE(graph.Contains(AnyVertex(handle)));
    for (const auto& handle : dead_edges)
      ASSERT_FALSE(graph.Contains(AnyEdge(handle)));
  }
}

// An edge on one vertex: the Result in the braces is the vertex, not something to make all of the
// argument of. A tuple of handles, and what was made of handles before, will do as well.
TEST(GraphHandles, OneResultInBracesIsTheVertexOfAnEdgeOnOne) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose{});
  const auto handle = pose.value();
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{}, {pose}).ok());
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{}, {handle}).ok());
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{}, std::tuple(handle)).ok());
  const EdgeVertices<EdgeSE3Prior> kept{pose};
  EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{}, kept).ok());
  EXPECT_EQ(graph.NumEdges(), 4);
}

}  // namespace
}  // namespace glissade::test
