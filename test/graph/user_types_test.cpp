// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Vertices, landmarks, edges and losses of a user's own, as plain structs; and what the concepts
// say about those that are not quite right.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "glissade/testing.h"
#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

/// A direction in the plane, as a unit vector: two numbers, one degree of freedom.
struct Heading {
  static constexpr int kAmbientDim = 2;
  static constexpr int kTangentDim = 1;
  double cs[2] = {1.0, 0.0};
  double* Data() { return cs; }
  const double* Data() const { return cs; }
  void Plus(const double* delta) {
    const double c = std::cos(*delta), s = std::sin(*delta), x = cs[0], y = cs[1];
    cs[0] = c * x - s * y;
    cs[1] = s * x + c * y;
  }
  void Minus(const Heading& x0, double* delta) const {
    *delta = std::atan2(x0.cs[0] * cs[1] - x0.cs[1] * cs[0], x0.cs[0] * cs[0] + x0.cs[1] * cs[1]);
  }
  Status Validate() const {
    if (std::abs(std::hypot(cs[0], cs[1]) - 1.0) < 1e-9) return {};
    return {StatusCode::kInvalidArgument, "not a unit vector"};
  }
};

/// Sees a spot under a bearing.
struct EdgeSees {
  using Vertices = VertexList<Heading, Spot>;
  static constexpr int kResidualDim = 1;
  static constexpr bool kIsObservation = true;
  double at[2] = {};
  double bearing = 0.0;

  bool Evaluate(const Heading& h, const Spot& p, Vector<1>& r, Jacobian<1, 1>* J_h,
                Jacobian<1, 2>* J_p) const {
    const double dx = p.xy[0] - at[0], dy = p.xy[1] - at[1], n2 = dx * dx + dy * dy;
    if (n2 == 0.0) return false;
    r[0] = std::remainder(std::atan2(dy, dx) - std::atan2(h.cs[1], h.cs[0]) - bearing, 2.0 * M_PI);
    if (J_h) (*J_h)(0, 0) = -1.0;
    if (J_p) *J_p << -dy / n2, dx / n2;
    return true;
  }
  Status Validate() const { return ValidateFinite(&bearing, 1, "bearing"); }
};

struct EdgeNorth {
  using Vertices = VertexList<Heading>;
  static constexpr int kResidualDim = 1;
  double angle = 0.0;
  bool Evaluate(const Heading& h, Vector<1>& r, Jacobian<1, 1>* J) const {
    r[0] = std::remainder(std::atan2(h.cs[1], h.cs[0]) - angle, 2.0 * M_PI);
    if (J) (*J)(0, 0) = 1.0;
    return true;
  }
};

/// L1-L2, as ceres would have it if it had it; counts nothing, holds nothing but a width.
struct SoftL1 {
  double width = 1.0;
  void Evaluate(double s, double rho[3]) const {
    const double b = width * width, root = std::sqrt(1.0 + s / b);
    rho[0] = 2.0 * b * (root - 1.0);
    rho[1] = 1.0 / root;
    rho[2] = -0.5 / (b * root * root * root);
  }
};

TEST(UserTypes, AreSolvedLikeOurs) {
  Problem problem;
  const double truth_heading[] = {0.3, -0.9, 2.0, -2.5};
  const double truth_spot[][2] = {{2.0, 1.0}, {-1.0, 3.0}, {0.5, -2.0}, {4.0, 4.0}, {-3.0, -1.0}};
  std::vector<VertexHandle<Heading>> headings;
  std::vector<VertexHandle<Spot>> spots;
  for (const double h : truth_heading) {
    headings.push_back(problem.AddVertex(Heading{{std::cos(h + 0.1), std::sin(h + 0.1)}}));
    Must(problem.AddEdge(EdgeNorth{h}, {headings.back()}));
  }
  for (const auto& s : truth_spot)
    spots.push_back(problem.AddVertex(Spot{{s[0] + 0.2, s[1] - 0.1}}));
  for (std::size_t i = 0; i < 4; ++i) {
    const double at[] = {std::cos(double(i)) * 5.0, std::sin(1.3 * double(i)) * 5.0};
    for (std::size_t k = 0; k < 5; ++k) {
      EdgeSees edge{{at[0], at[1]}, 0.0};
      edge.bearing =
          std::atan2(truth_spot[k][1] - at[1], truth_spot[k][0] - at[0]) - truth_heading[i];
      EdgeOptions<EdgeSees> options;
      options.loss = SoftL1{0.5};
      options.sqrt_information = SquareMatrix<1>::Constant(50.0);
      Must(problem.AddEdge(edge, {headings[i], spots[k]}, options));
    }
  }
  const SolveSummary& summary = problem.Solve();
  ASSERT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_EQ(summary.num_poses, 4);
  EXPECT_EQ(summary.num_landmarks, 5) << "spots are eliminated: their type says so";
  EXPECT_LT(summary.final_cost, 1e-15);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(problem.Get(spots[k]).xy[0], truth_spot[k][0], 1e-7);
    EXPECT_NEAR(problem.Get(spots[k]).xy[1], truth_spot[k][1], 1e-7);
  }
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(problem.Get(headings[i]).cs[0], std::cos(truth_heading[i]), 1e-8);
}

TEST(UserTypes, HaveTheirValidateAsked) {
  Graph graph;
  EXPECT_EQ(graph.AddVertex(Heading{{1.0, 1.0}}).status().code(), StatusCode::kInvalidArgument);
  const VertexHandle<Heading> h = graph.AddVertex(Heading());
  const VertexHandle<Spot> s = graph.AddVertex(Spot{{1.0, 1.0}});
  EXPECT_EQ(graph.AddEdge(EdgeSees{{0.0, 0.0}, NAN}, {h, s}).status().code(),
            StatusCode::kNotFinite);
  graph.AcknowledgeRefusal();
  // Duplicates: without SameSensor, two on the same vertices are one observation twice.
  const auto first = Must(graph.AddEdge(EdgeSees{{0.0, 0.0}, 0.1}, {h, s}));
  const auto second = Must(graph.AddEdge(EdgeSees{{1.0, 0.0}, 0.1}, {h, s}));
  Problem problem(std::move(graph));
  const SolveSummary& summary = problem.Solve();
  EXPECT_EQ(summary.status.code(), StatusCode::kDuplicate);
  EXPECT_EQ(summary.status.edge(), AnyEdge(first));
  EXPECT_EQ(summary.status.other_edge(), AnyEdge(second));
}

TEST(UserTypes, PassOurPublicChecks) {
  EXPECT_TRUE(CheckJacobians(EdgeSees{{5.0, 1.0}, 0.3}, Heading(), Spot{{1.0, 2.0}}).ok);
}

/// A state that does not lie in the value: pools could not reach it.
struct Elsewhere {
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;
  std::vector<double> x = {0.0};
  double* Data() { return x.data(); }
  const double* Data() const { return x.data(); }
  void Plus(const double* delta) { x[0] += *delta; }
  void Minus(const Elsewhere& x0, double* delta) const { *delta = x[0] - x0.x[0]; }
};

TEST(UserTypes, WithTheirStateElsewhereAreRefused) {
  Graph graph;
  const auto added = graph.AddVertex(Elsewhere());
  EXPECT_EQ(added.status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(added.status().message().find("Data()"), std::string::npos);
}

// ---- What is not quite right -------------------------------------------------------------------

struct NoData : Heading {
  double* Data() = delete;
};
struct NoTangent {
  static constexpr int kAmbientDim = 2;
  double* Data();
  const double* Data() const;
  void Plus(const double*);
  void Minus(const NoTangent&, double*) const;
};
struct MoreTangentThanState : Heading {
  static constexpr int kTangentDim = 3;
};
static_assert(VertexType<Heading> && VertexType<Spot>);
static_assert(!VertexHasData<NoData> && !VertexType<NoData>);
static_assert(!VertexHasDimensions<NoTangent> && VertexHasData<NoTangent>);
static_assert(!VertexHasDimensions<MoreTangentThanState>);

struct WrongJacobian : EdgeNorth {
  bool Evaluate(const Heading&, Vector<1>&, Jacobian<1, 2>*) const;
};
struct VoidEvaluate : EdgeNorth {
  void Evaluate(const Heading&, Vector<1>&, Jacobian<1, 1>*) const;
};
struct NotConst : EdgeNorth {
  bool Evaluate(const Heading&, Vector<1>&, Jacobian<1, 1>*);
};
struct NoVertices {
  static constexpr int kResidualDim = 1;
};
struct NoResidual {
  using Vertices = VertexList<Heading>;
};
static_assert(EdgeType<EdgeSees> && EdgeType<EdgeNorth>);
static_assert(!EdgeHasEvaluate<WrongJacobian> && EdgeHasVertices<WrongJacobian>);
static_assert(!EdgeHasEvaluate<VoidEvaluate>);
static_assert(!EdgeHasEvaluate<NotConst>);
static_assert(!EdgeHasVertices<NoVertices> && EdgeHasResidualDim<NoVertices>);
static_assert(!EdgeHasResidualDim<NoResidual> && EdgeHasVertices<NoResidual>);

struct BigLoss {
  double x[5];
  void Evaluate(double s, double rho[3]) const;
};
static_assert(LossType<SoftL1> && !LossType<BigLoss>);

}  // namespace
}  // namespace glissade::test
