// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Columns of H were given out by the names of vertex types: in a problem without poses all vertices
// got column 0, and a type that was not on the list shared the columns of pose 0.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <string>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/course_scene.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"
#include "support/dense_reference.h"

namespace glissade {
namespace {

/// A user's own type.
struct VertexLevel {
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;
  double height = 0.0;
  double* Data() { return &height; }
  const double* Data() const { return &height; }
  void Plus(const double* delta) { height += delta[0]; }
  void Minus(const VertexLevel& x0, double* delta) const { delta[0] = height - x0.height; }
};
using VertexXY = VertexVector<2>;

struct EdgeLevelDifference {
  using Vertices = VertexList<VertexLevel, VertexLevel>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  bool Evaluate(const VertexLevel& a, const VertexLevel& b, Vector<1>& r, Jacobian<1, 1>* d_r_d_a,
                Jacobian<1, 1>* d_r_d_b) const {
    r[0] = b.height - a.height - measured;
    if (d_r_d_a) (*d_r_d_a)(0, 0) = -1.0;
    if (d_r_d_b) (*d_r_d_b)(0, 0) = 1.0;
    return true;
  }
};

struct EdgeLevelAndXY {
  using Vertices = VertexList<VertexLevel, VertexXY>;
  static constexpr int kResidualDim = 2;
  Vector2 measured = Vector2::Zero();
  bool Evaluate(const VertexLevel& level, const VertexXY& xy, Vector2& r,
                Jacobian<2, 1>* d_r_d_level, Jacobian<2, 2>* d_r_d_xy) const {
    r = Vector2(xy.value[0] + 2.0 * level.height, xy.value[1] - level.height) - measured;
    if (d_r_d_level) *d_r_d_level << 2.0, -1.0;
    if (d_r_d_xy) d_r_d_xy->setIdentity();
    return true;
  }
};

/// Four levels and three XY, coupled, linear and determined once the first level is fixed.
struct LevelProblem {
  Problem problem;
  std::vector<VertexHandle<VertexLevel>> levels;
  std::vector<VertexHandle<VertexXY>> xys;

  LevelProblem() {
    for (int k = 0; k < 4; ++k)
      levels.push_back(problem.AddVertex(VertexLevel{0.3 * k}));
    for (int k = 0; k < 3; ++k)
      xys.push_back(problem.AddVertex(VertexXY{{0.1 * k, -0.2}}));
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
      Add(EdgeLevelDifference{1.0 + 0.1 * static_cast<double>(k)}, {levels[k], levels[k + 1]});
    }
    for (std::size_t k = 0; k < xys.size(); ++k) {
      Add(EdgeLevelAndXY{Vector2(1.0, static_cast<double>(k))}, {levels[k], xys[k]});
      Add(EdgeLevelAndXY{Vector2(2.0, 0.5)}, {levels[k + 1], xys[k]});
    }
    EXPECT_TRUE(problem.SetFixed(levels[0]).ok());
  }
  template <class E>
  void Add(const E& edge, const EdgeVertexHandles<E>& vertices) {
    EXPECT_TRUE(problem.AddEdge(edge, vertices).ok());
  }
};

int DimOf(const Graph& graph, AnyVertex vertex) {
  return graph.PoolOf(vertex.type)->ops().tangent_dim;
}

/// The columns as the course gave them out: by type name.
std::vector<int> ColumnsByTypeName(const Graph& graph, const std::vector<AnyVertex>& vertices) {
  int poses = 0;
  for (const AnyVertex& v : vertices) {
    if (v.type->name == "VertexPose" || v.type->name == "VertexSpeedBias") poses += DimOf(graph, v);
  }
  int pose = 0;
  int landmark = poses;
  std::vector<int> columns;
  for (const AnyVertex& v : vertices) {
    int* next = nullptr;
    if (v.type->name == "VertexPose" || v.type->name == "VertexSpeedBias") next = &pose;
    if (v.type->name == "VertexInverseDepth") next = &landmark;
    columns.push_back(next != nullptr ? *next : 0);
    if (next != nullptr) *next += DimOf(graph, v);
  }
  return columns;
}

/// The check: every scalar of every vertex has a column of its own, without gaps.
bool IsOrder(const Graph& graph, const std::vector<AnyVertex>& vertices,
             const std::vector<int>& columns) {
  std::vector<int> used;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    for (int i = 0; i < DimOf(graph, vertices[k]); ++i)
      used.push_back(columns[k] + i);
  }
  std::sort(used.begin(), used.end());
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k] != static_cast<int>(k)) return false;
  }
  return true;
}

/// Cost after the Gauss-Newton step of a system assembled with these columns.
double CostAfterStep(const LevelProblem& p, const std::vector<AnyVertex>& vertices,
                     const std::vector<int>& columns) {
  const test::DenseReference dense(p.problem, vertices);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(dense.J.rows(), dense.J.cols());
  int column = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    for (int i = 0; i < DimOf(p.problem, vertices[k]); ++i, ++column)
      J.col(columns[k] + i) += dense.J.col(column);
  }
  const Eigen::VectorXd dx = -J.completeOrthogonalDecomposition().solve(dense.r);
  Graph moved = static_cast<const Graph&>(p.problem).Clone();
  const auto move = [&](const auto& handles) {
    for (const auto& handle : handles) {
      const auto at = std::find(vertices.begin(), vertices.end(), AnyVertex(handle));
      if (at == vertices.end()) continue;
      auto value = moved.Get(handle);
      value.Plus(dx.data() + columns[static_cast<std::size_t>(at - vertices.begin())]);
      EXPECT_TRUE(moved.Set(handle, value).ok());
    }
  };
  move(p.levels);
  move(p.xys);
  return moved.Cost().value();
}

TEST(VariableOrder, EveryVertexOfEveryTypeHasColumnsOfItsOwn) {
  LevelProblem p;
  ASSERT_TRUE(p.problem.MakeHessian().ok());
  const std::vector<AnyVertex> vertices = p.problem.FreeVertices();
  std::vector<int> columns = p.problem.FreeOffsets();
  ASSERT_EQ(columns.size(), vertices.size() + 1);
  EXPECT_EQ(columns.back(), 3 + 6);
  columns.pop_back();
  EXPECT_TRUE(IsOrder(p.problem, vertices, columns));
  const std::vector<int> by_name = ColumnsByTypeName(p.problem, vertices);
  EXPECT_FALSE(IsOrder(p.problem, vertices, by_name));

  // A linear problem: one step reaches the minimum, if the columns are right.
  const double best = CostAfterStep(p, vertices, columns);
  EXPECT_GT(CostAfterStep(p, vertices, by_name), 1.1 * best);
  SolveOptions options;
  options.initial_lambda = 1e-12;
  const SolveSummary summary = p.problem.Solve(options);
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_NEAR(summary.final_cost, best, 1e-10 * best);
}

TEST(VariableOrder, AnUnknownTypeBesidePoses) {
  Problem problem;
  ASSERT_TRUE(AddToGraph(MakeCourseScene(), problem).ok());
  ASSERT_TRUE(problem.MakeHessian().ok());
  const std::vector<AnyVertex> known = problem.FreeVertices();
  EXPECT_TRUE(IsOrder(problem, known, ColumnsByTypeName(problem, known)));

  const auto a = problem.AddVertex(VertexLevel{1.0}).value();
  const auto b = problem.AddVertex(VertexLevel{2.0}).value();
  ASSERT_TRUE(problem.AddEdge(EdgeLevelDifference{3.0}, {a, b}).ok());
  ASSERT_TRUE(problem.MakeHessian().ok());
  const std::vector<AnyVertex> all = problem.FreeVertices();
  std::vector<int> columns = problem.FreeOffsets();
  columns.pop_back();
  EXPECT_EQ(all.size(), known.size() + 2);
  EXPECT_TRUE(IsOrder(problem, all, columns));
  EXPECT_FALSE(IsOrder(problem, all, ColumnsByTypeName(problem, all)));
}

}  // namespace
}  // namespace glissade
