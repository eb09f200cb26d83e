// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Dynamic edges against typed ones that say the same, with both kinds of linearization.

#include <gtest/gtest.h>

#include <limits>

#include "glissade/edges/edge_batch.h"

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

/// EdgeLinearSpot as a dynamic edge; with a constant Hessian if asked.
class DynamicLinear final : public DynamicEdge {
 public:
  DynamicLinear(const EdgeLinearSpot& edge, bool constant) : edge_(edge), constant_(constant) {
    Matrix<4, 5> J;
    J << edge.A, edge.B;
    const Matrix<5, 5> H = J.transpose() * J;
    std::copy_n(H.data(), 25, H_);
  }
  Status CheckVertices(std::span<const VertexOps* const> v) const override {
    if (v.size() == 2 && v[0]->type == &kTypeInfo<VertexVector<3>> &&
        v[1]->type == &kTypeInfo<Spot>) {
      return {};
    }
    return {StatusCode::kInvalidArgument, "needs a VertexVector<3> and a Spot"};
  }
  int ResidualDim() const override { return residual_dim; }
  bool Evaluate(std::span<const VertexRef> v, double* residual,
                double* const* jacobians) const override {
    Vector<4> r;
    Jacobian<4, 3> A;
    Jacobian<4, 2> B;
    VertexVector<3> x;
    Spot y;
    std::copy_n(v[0].data, 3, x.Data());
    std::copy_n(v[1].data, 2, y.Data());
    const bool ok = edge_.Evaluate(x, y, r, &A, &B);
    std::copy_n(r.data(), 4, residual);
    if (jacobians != nullptr && jacobians[0] != nullptr) std::copy_n(A.data(), 12, jacobians[0]);
    if (jacobians != nullptr && jacobians[1] != nullptr) std::copy_n(B.data(), 8, jacobians[1]);
    return ok;
  }
  const double* ConstantHessian() const override { return constant_ ? H_ : nullptr; }
  bool LinearizeQuadratic(std::span<const VertexRef> v, double* gradient,
                          double* squared_norm) const override {
    double r[4], A[12], B[8];
    double* jacobians[] = {A, B};
    Evaluate(v, r, jacobians);
    *squared_norm = 0.0;
    for (int k = 0; k < 4; ++k)
      *squared_norm += r[k] * r[k];
    for (int c = 0; gradient != nullptr && c < 5; ++c) {
      gradient[c] = 0.0;
      for (int k = 0; k < 4; ++k)
        gradient[c] += r[k] * (c < 3 ? A[3 * k + c] : B[2 * k + c - 3]);
    }
    return true;
  }
  std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<DynamicLinear>(*this);
  }
  const EdgeBatch* batch() const override { return batch_of; }
  int residual_dim = 4;
  const EdgeBatch* batch_of = nullptr;

 private:
  EdgeLinearSpot edge_;
  bool constant_;
  double H_[25];
};

/// Counts its calls, and the edges in them, and asks each edge.
class CountingBatch final : public EdgeBatch {
 public:
  void Evaluate(std::span<BatchedEdge> edges) const override {
    ++calls;
    num_edges = edges.size();
    for (BatchedEdge& e : edges)
      e.has_value = e.edge->Evaluate(e.vertices, e.residual, e.jacobians) && !fails;
  }
  mutable int calls = 0;
  mutable std::size_t num_edges = 0;
  bool fails = false;
};

EdgeLinearSpot SomeEdge(std::uint64_t seed) {
  Random random(seed);
  EdgeLinearSpot edge;
  for (double* p : {edge.A.data(), edge.B.data(), edge.c.data()}) {
    for (int k = 0; k < (p == edge.A.data() ? 12 : p == edge.B.data() ? 8 : 4); ++k)
      p[k] = random.Uniform(-1.0, 1.0);
  }
  return edge;
}

enum class Kind { kTyped, kDynamic, kConstant };

struct Built {
  Problem problem;
  VertexHandle<VertexVector<3>> x;
  VertexHandle<Spot> y;
  std::vector<AnyEdge> edges;
};
Built Build(Kind kind, const Loss& loss = {}, const EdgeBatch* batch = nullptr) {
  Built b;
  b.x = b.problem.AddVertex(VertexVector<3>{{0.3, -0.2, 0.9}});
  b.y = b.problem.AddVertex(Spot{{0.1, 0.7}});
  for (int k = 0; k < 3; ++k) {
    const EdgeLinearSpot edge = SomeEdge(std::uint64_t(40 + k));
    if (kind == Kind::kTyped) {
      EdgeOptions<EdgeLinearSpot> options;
      options.loss = loss;
      b.edges.push_back(Must(b.problem.AddEdge(edge, {b.x, b.y}, options)));
    } else {
      const AnyVertex vertices[] = {b.x, b.y};
      auto dynamic = std::make_unique<DynamicLinear>(edge, kind == Kind::kConstant);
      dynamic->batch_of = batch;
      b.edges.push_back(Must(b.problem.AddEdge(std::move(dynamic), vertices, loss)));
    }
  }
  return b;
}

void ExpectSameSystem(Built* a, Built* b) {
  Must(a->problem.MakeHessian());
  Must(b->problem.MakeHessian());
  ASSERT_EQ(a->problem.Hessian().rows(), b->problem.Hessian().rows());
  EXPECT_LT((a->problem.Hessian() - b->problem.Hessian()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((a->problem.Rhs() - b->problem.Rhs()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_NEAR(Must(a->problem.Cost()), Must(b->problem.Cost()), 1e-14);
  for (std::size_t k = 0; k < a->edges.size(); ++k) {
    EXPECT_NEAR(Must(a->problem.Chi2(a->edges[k])), Must(b->problem.Chi2(b->edges[k])), 1e-14);
  }
  EXPECT_NEAR(a->problem.Solve().final_cost, b->problem.Solve().final_cost, 1e-13);
}

TEST(DynamicEdge, SaysTheSameAsATypedOne) {
  for (const Kind kind : {Kind::kDynamic, Kind::kConstant}) {
    for (int held = 0; held < 4; ++held) {
      Built typed = Build(Kind::kTyped), dynamic = Build(kind);
      for (Built* b : {&typed, &dynamic}) {
        if (held == 1) Must(b->problem.SetFixed(b->x));
        if (held == 2) Must(b->problem.SetFixed(b->y));
        if (held == 3) Must(b->problem.SetEliminated(b->y, false));
      }
      SCOPED_TRACE(held);
      ExpectSameSystem(&typed, &dynamic);
    }
  }
}

TEST(DynamicEdge, TakesALossUnlessItsHessianIsConstant) {
  for (const Loss& loss : {Loss(Huber{0.5}), Loss(Cauchy{0.8})}) {
    Built typed = Build(Kind::kTyped, loss), dynamic = Build(Kind::kDynamic, loss);
    ExpectSameSystem(&typed, &dynamic);
  }
  Built constant = Build(Kind::kConstant);
  const GraphRecord before(constant.problem);
  const AnyVertex vertices[] = {constant.x, constant.y};
  EXPECT_EQ(constant.problem
                .AddEdge(std::make_unique<DynamicLinear>(SomeEdge(1), true), vertices, Huber{1.0})
                .status()
                .code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(constant.problem.SetLoss(constant.edges[0], Huber{1.0}).code(),
            StatusCode::kInvalidArgument);
  EXPECT_TRUE(GraphRecord(constant.problem) == before);
  Must(constant.problem.SetLoss(constant.edges[0], Loss()));
}

TEST(DynamicEdge, BatchesAreAskedOnceAPass) {
  for (const Loss& loss : {Loss(), Loss(Huber{0.3})}) {
    for (const auto mode : {FirstEstimates::kOff, FirstEstimates::kFull}) {
      for (int held = 0; held < 3; ++held) {
        CountingBatch batch;
        Built alone = Build(Kind::kDynamic, loss), batched = Build(Kind::kDynamic, loss, &batch);
        for (Built* b : {&alone, &batched}) {
          Must(b->problem.SetFirstEstimates(mode));
          if (held == 1) Must(b->problem.SetFixed(b->x));
          if (held == 2) Must(b->problem.SetFixed(b->y));
        }
        ExpectSameSystem(&alone, &batched);
        batch.calls = 0;
        Must(batched.problem.MakeHessian());
        EXPECT_EQ(batch.calls, mode == FirstEstimates::kFull ? 2 : 1);
        EXPECT_EQ(batch.num_edges, 3u);
        batch.calls = 0;
        Must(batched.problem.Cost());
        EXPECT_EQ(batch.calls, 1);
      }
    }
  }
}

TEST(DynamicEdge, SeveralBatchesAndEdgesWithoutOne) {
  CountingBatch batches[3];
  Built typed = Build(Kind::kTyped), mixed = Build(Kind::kDynamic);
  for (int k = 0; k < 12; ++k) {
    const EdgeLinearSpot edge = SomeEdge(std::uint64_t(70 + k));
    typed.edges.push_back(Must(typed.problem.AddEdge(edge, {typed.x, typed.y})));
    auto dynamic = std::make_unique<DynamicLinear>(edge, false);
    if (k % 4 < 3) dynamic->batch_of = &batches[k % 4];
    const AnyVertex vertices[] = {mixed.x, mixed.y};
    mixed.edges.push_back(Must(mixed.problem.AddEdge(std::move(dynamic), vertices)));
  }
  ExpectSameSystem(&typed, &mixed);
  for (const CountingBatch& batch : batches)
    EXPECT_EQ(batch.num_edges, 3u);
}

TEST(DynamicEdge, ABatchWithoutValuesNamesItsEdge) {
  CountingBatch batch;
  Built b = Build(Kind::kDynamic, {}, &batch);
  Must(b.problem.RemoveEdge(b.edges[0]));
  Must(b.problem.Cost());
  EXPECT_EQ(batch.num_edges, 2u);
  batch.fails = true;
  EXPECT_EQ(b.problem.MakeHessian().edge(), b.edges[1]);
  EXPECT_EQ(b.problem.Solve().status.code(), StatusCode::kEvaluationFailed);
  batch.fails = false;
  EXPECT_TRUE(b.problem.Solve().converged());
}

TEST(DynamicEdge, WhatIsRefused) {
  Built b = Build(Kind::kDynamic);
  const GraphRecord before(b.problem);
  const auto add = [&](std::unique_ptr<DynamicEdge> edge, std::vector<AnyVertex> vertices,
                       const Loss& loss = {}) {
    return b.problem.AddEdge(std::move(edge), vertices, loss).status().code();
  };
  const auto make = [] { return std::make_unique<DynamicLinear>(SomeEdge(1), false); };
  EXPECT_EQ(add(nullptr, {b.x, b.y}), StatusCode::kInvalidArgument);
  EXPECT_EQ(add(make(), {}), StatusCode::kInvalidArgument);
  EXPECT_EQ(add(make(), {b.y, b.x}), StatusCode::kInvalidArgument) << "the edge's own check";
  EXPECT_EQ(add(make(), {b.x, AnyVertex()}), StatusCode::kUnknownHandle);
  EXPECT_EQ(add(make(), {b.x, b.x}), StatusCode::kRepeatedVertex);
  EXPECT_EQ(add(make(), {b.x, b.y}, Huber{-1.0}), StatusCode::kNotPositive);
  auto empty = make();
  empty->residual_dim = 0;
  EXPECT_EQ(add(std::move(empty), {b.x, b.y}), StatusCode::kInvalidArgument);
  EXPECT_TRUE(GraphRecord(b.problem) == before);
}

TEST(DynamicEdge, GoesWithItsVerticesAndSurvivesOthers) {
  Built b = Build(Kind::kDynamic);
  const VertexHandle<Spot> other = b.problem.AddVertex(Spot{{1.0, 2.0}});
  const AnyVertex on_other[] = {b.x, other};
  const auto edge =
      Must(b.problem.AddEdge(std::make_unique<DynamicLinear>(SomeEdge(9), true), on_other));
  const double chi2 = Must(b.problem.Chi2(AnyEdge(edge)));
  Must(b.problem.RemoveVertex(b.y));
  EXPECT_EQ(b.problem.NumEdges(), 1);
  b.problem.Compact();
  EXPECT_EQ(Must(b.problem.Chi2(AnyEdge(edge))), chi2);
  EXPECT_EQ(Must(b.problem.VerticesOf(edge)), (std::vector<AnyVertex>{b.x, other}));
  // A copy has its own vertices.
  Problem copy = b.problem.Clone();
  Must(b.problem.Set(other, Spot{{5.0, 5.0}}));
  EXPECT_EQ(Must(copy.Chi2(AnyEdge(edge))), chi2);
  ASSERT_TRUE(copy.Solve().ok());
  ASSERT_TRUE(b.problem.Solve().ok());
  // Linear, so both ends are the same minimum.
  EXPECT_NEAR(Must(copy.Chi2()), Must(b.problem.Chi2()), 1e-12);
  Must(b.problem.RemoveEdge(edge));
  EXPECT_EQ(b.problem.NumEdges(), 0);
  EXPECT_EQ(b.problem.Solve().status.code(), StatusCode::kNothingToSolve);
}

TEST(DynamicEdge, NextToTypedOnesOnTheSameVertices) {
  Built mixed = Build(Kind::kTyped), typed = Build(Kind::kTyped);
  for (int k = 0; k < 4; ++k) {
    const AnyVertex vertices[] = {mixed.x, mixed.y};
    const EdgeLinearSpot edge = SomeEdge(std::uint64_t(60 + k));
    mixed.edges.push_back(
        Must(mixed.problem.AddEdge(std::make_unique<DynamicLinear>(edge, k % 2 == 0), vertices)));
    typed.edges.push_back(Must(typed.problem.AddEdge(edge, {typed.x, typed.y})));
  }
  ExpectSameSystem(&mixed, &typed);
}

}  // namespace
}  // namespace glissade::test
