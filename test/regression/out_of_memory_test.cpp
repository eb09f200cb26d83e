// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// std::bad_alloc came out of Solve and Marginalize, with a graph half changed. Each allocation that
// they make is made to fail here, alone and with all after it: the status says so, the graph is as
// it was, to the bit, and the next call does what it would have done.
#include <gtest/gtest.h>

#include <cmath>
#include <new>
#include <vector>

#include "glissade/glissade.h"
#include "regression/malloc_count.h"

namespace glissade {
namespace {

/// Frames along x; inverse depths of both paths, XYZ points, relative poses, a dynamic prior.
Problem MakeProblem() {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> frames;
  for (int k = 0; k < 6; ++k) {
    Pose start(Quaternion::Identity(), Vector3(0.3 * k, 0.02 * std::sin(5 * k), 0.0));
    frames.push_back(problem.AddVertex(VertexPose{start}));
  }
  const auto frame = [&](int k) { return frames[static_cast<std::size_t>(k)]; };
  EXPECT_TRUE(problem.SetFixed(frame(0)).ok());
  EXPECT_TRUE(problem.SetFixed(frame(1), Fix::kPosition).ok());
  for (int h = 0; h < 5; ++h) {
    for (int l = 0; l < 6; ++l) {
      const auto depth = problem.AddVertex(VertexInverseDepth{0.2 + 0.01 * l});
      for (int t = h + 1; t < 6; ++t) {
        EdgeReprojection edge;
        edge.uv_host = Vector2(0.4 * std::sin(3 * l), 0.3 * std::cos(2 * l));
        edge.uv_target = edge.uv_host + Vector2(-0.06 * (t - h), 0.002 * std::sin(7 * l + t));
        EdgeOptions<EdgeReprojection> options;
        options.sqrt_information = Matrix2(300.0 * Matrix2::Identity());
        if (l % 2 == 0) options.loss = Cauchy{3.0};  // a loss without a kernel
        EXPECT_TRUE(problem.AddEdge(edge, {frame(h), frame(t), depth}, options).ok());
      }
    }
    EXPECT_TRUE(problem
                    .AddEdge(EdgeRelativePose{Pose(Quaternion::Identity(), Vector3(0.3, 0, 0))},
                             {frame(h), frame(h + 1)})
                    .ok());
  }
  return problem;
}

/// Everything that a call which fails must leave as it is.
void ExpectSameGraph(const Problem& problem, const Snapshot& before, int edges,
                     const std::vector<AnyVertex>& vertices) {
  const Snapshot now = problem.GetSnapshot();
  EXPECT_EQ(now.states, before.states);
  EXPECT_EQ(now.first_estimates, before.first_estimates);
  EXPECT_EQ(problem.NumEdges(), edges);
  EXPECT_EQ(problem.Vertices(), vertices);
  EXPECT_FALSE(problem.IsHolding());
}

class OutOfMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::MallocCount() < 0) GTEST_SKIP() << "malloc cannot be made to fail in this build";
  }
};

/// Makes each allocation of call(problem) -> Status fail in turn, and checks what is left; stops
/// after the first call that needs no more. Returns how many failed.
template <class Call, class Later>
int FailEach(const Problem& original, bool on, Call&& call, Later&& later) {
  int failures = 0;
  for (int number = 0; number < 20000; ++number) {
    Problem problem = original.Clone();
    const Snapshot before = problem.GetSnapshot();
    const int edges = problem.NumEdges();
    const std::vector<AnyVertex> vertices = problem.Vertices();
    Status status;
    bool failed = false;
    {
      const test::FailingMalloc failing(number, on);
      status = call(&problem);
      failed = failing.failed();
    }
    if (!failed) {
      EXPECT_TRUE(status.ok()) << status.message();
      return failures;
    }
    ++failures;
    if (status.ok()) continue;  // done without: a thread, say
    EXPECT_EQ(status.code(), StatusCode::kOutOfMemory) << number << ": " << status.message();
    ExpectSameGraph(problem, before, edges, vertices);
    static_cast<void>(problem.AcknowledgeRefusal());
    later(&problem);
    if (testing::Test::HasFailure()) {
      ADD_FAILURE() << "at allocation " << number;
      return failures;
    }
  }
  ADD_FAILURE() << "no end of allocations";
  return failures;
}

TEST_F(OutOfMemory, OfASolveIsAStatusAndTheNextSolveWorks) {
  const Problem original = MakeProblem();
  const AnyVertex anchor = original.Vertices()[2];
  const VertexHandle<VertexPose> pose = *anchor.As<VertexPose>();
  std::vector<SolveOptions> all(9);
  all[1].num_threads = 2;
  all[2].method = Method::kDogleg;
  all[3].linear_solver_type = LinearSolverType::kSparseCholesky;
  all[3].gauge = Gauge::Fixed{pose};
  all[4].gauge = Gauge::Prior{pose};
  all[4].linear_solver_type = LinearSolverType::kPcg;
  all[6].linear_solver_type = LinearSolverType::kImplicitPcg;
  all[7].linear_solver_type = LinearSolverType::kImplicitPcg;
  all[7].pcg.preconditioner = Preconditioner::kClusterJacobi;
  all[8].linear_solver_type = LinearSolverType::kPcg;
  all[8].pcg.preconditioner = Preconditioner::kPowerSeries;
  all[8].memory_limit = 100'000'000;
  all[5].callback = [](const IterationSummary&) { return CallbackAction::kContinue; };
  for (const SolveOptions& options : all) {
    Problem reference = original.Clone();
    const double cost = reference.Solve(options).final_cost;
    for (const bool on : {false, true}) {
      const int failures = FailEach(
          original, on, [&](Problem* problem) { return problem->Solve(options).status; },
          [&](Problem* problem) {
            const SolveSummary& summary = problem->Solve(options);
            EXPECT_TRUE(summary.converged()) << summary.BriefReport();
            EXPECT_EQ(summary.final_cost, cost);
          });
      EXPECT_GT(failures, 50);
    }
  }
}

TEST_F(OutOfMemory, OfAMarginalizationIsAStatusAndTheNextOneWorks) {
  Problem original = MakeProblem();
  // A prior of before, so that one is folded in.
  const std::vector<AnyVertex> frames = original.Vertices();
  ASSERT_TRUE(original.SetFixed(frames[0], Fix::kFree).ok());
  ASSERT_TRUE(original.AddEdge(EdgeSE3Prior{}, {*frames[0].As<VertexPose>()}).ok());
  ASSERT_TRUE(original.Marginalize({frames[0]}).ok());
  for (const MarginalForm form : {MarginalForm::kSquareRootQr, MarginalForm::kSchur}) {
    MarginalizeOptions options;
    options.form = form;
    Problem reference = original.Clone();
    ASSERT_TRUE(reference.Marginalize({frames[1]}, options).ok());
    const double cost = reference.Cost().value();
    for (const bool on : {false, true}) {
      const int failures = FailEach(
          original, on,
          [&](Problem* problem) { return problem->Marginalize({frames[1]}, options).status(); },
          [&](Problem* problem) {
            EXPECT_TRUE(problem->Marginalize({frames[1]}, options).ok());
            EXPECT_EQ(problem->Cost().value(), cost);
            EXPECT_TRUE(problem->Solve().ok());
          });
      EXPECT_GT(failures, 30);
    }
  }
}

/// Each allocation of add(graph) fails in turn. What it throws leaves the graph as it was, and
/// adding again does what it would have done.
template <class Add>
void FailEachAdd(const Problem& original, Add&& add) {
  for (int number = 0; number < 200; ++number) {
    Problem problem = original.Clone(), reference = original.Clone();
    const Snapshot before = problem.GetSnapshot();
    const int edges = problem.NumEdges();
    const std::vector<AnyVertex> vertices = problem.Vertices();
    bool thrown = false;
    {
      const test::FailingMalloc failing(number);
      try {
        static_cast<void>(add(&problem));
      } catch (const std::bad_alloc&) {
        thrown = true;
      }
      if (!failing.failed()) return;
    }
    if (thrown) {
      ExpectSameGraph(problem, before, edges, vertices);
      EXPECT_TRUE(add(&problem).ok());
    }
    EXPECT_TRUE(add(&reference).ok());
    EXPECT_EQ(problem.NumEdges(), reference.NumEdges());
    EXPECT_EQ(problem.NumVertices(), reference.NumVertices());
    EXPECT_EQ(problem.Cost().value(), reference.Cost().value());
    EXPECT_EQ(problem.NumEdgesOf(vertices[0]).value(), reference.NumEdgesOf(vertices[0]).value());
    if (testing::Test::HasFailure()) {
      ADD_FAILURE() << "at allocation " << number;
      return;
    }
  }
  ADD_FAILURE() << "no end of allocations";
}

// Of a typed edge or a vertex, a part was there where memory had run out between two of its arrays.
TEST_F(OutOfMemory, OfAddingLeavesTheGraphAsItWas) {
  const Problem original = MakeProblem();
  const std::vector<AnyVertex> vertices = original.Vertices();
  const auto pose = [&](std::size_t k) { return *vertices[k].As<VertexPose>(); };
  const auto depth = *vertices[7].As<VertexInverseDepth>();
  // Enough of them that every array has to grow.
  FailEachAdd(original, [](Problem* p) {
    return p->AddVertices(std::span<const VertexPose>(std::vector<VertexPose>(100))).status();
  });
  FailEachAdd(original, [](Problem* p) {
    return p->AddVertices(std::span<const VertexPointXYZ>(std::vector<VertexPointXYZ>(5))).status();
  });
  FailEachAdd(original, [&](Problem* p) {
    const std::vector<EdgeReprojection> edges(500);
    const std::vector<EdgeVertexHandles<EdgeReprojection>> on(500, {pose(0), pose(1), depth});
    return p
        ->AddEdges(std::span<const EdgeReprojection>(edges),
                   std::span<const EdgeVertexHandles<EdgeReprojection>>(on))
        .status();
  });
  FailEachAdd(original, [&](Problem* p) {
    return p->AddEdge(EdgeReprojection(), {pose(0), pose(1), depth}).status();
  });
  FailEachAdd(original, [&](Problem* p) { return p->AddEdge(EdgeSE3Prior(), {pose(1)}).status(); });
  FailEachAdd(original, [](Problem* p) { return p->AddVertex(VertexPose()).status(); });
}

TEST_F(OutOfMemory, OfTheStepApiAndOfACovarianceIsAStatus) {
  const Problem original = MakeProblem();
  const std::vector<AnyVertex> vertices = original.Vertices();
  const auto steps = [](Problem* problem) {
    Status status = problem->MakeHessian();
    if (status.ok()) status = problem->SolveLinearSystem(1e-4);
    return status;
  };
  const auto covariance = [&](Problem* problem) {
    return problem->ComputeCovariance(std::span(vertices.data() + 2, 2)).status();
  };
  const auto nullspace = [](Problem* problem) { return problem->CheckNullspace().status(); };
  for (const bool on : {false, true}) {
    FailEach(original, on, steps, [&](Problem* problem) { EXPECT_TRUE(steps(problem).ok()); });
    FailEach(original, on, covariance,
             [&](Problem* problem) { EXPECT_TRUE(covariance(problem).ok()); });
    FailEach(original, on, nullspace,
             [&](Problem* problem) { EXPECT_TRUE(nullspace(problem).ok()); });
  }
}

}  // namespace
}  // namespace glissade
