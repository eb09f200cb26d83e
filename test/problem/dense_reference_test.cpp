// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/dense_reference.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <tuple>

#include "common/sanitized.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/linear_solver.h"
#include "glissade/problem/problem.h"
#include "support/random_graph.h"

// H, b and the damped step of Problem against dense matrices that are put together edge by edge,
// on random graphs of every kind and of several sizes: an error in the layout of blocks can be
// exact at one size and 96 % off at another.

namespace glissade::test {
namespace {

struct Size {
  int num_poses;
  int num_landmarks;
};

/// A solver of a user's own: takes blocks, and factors by other means than the library's.
class OwnSolver final : public LinearSolver {
 public:
  explicit OwnSolver(SchurForm form) : form_(form) {}
  [[nodiscard]] SchurForm Form(const SchurLayout& all_blocks) override {
    num_vertices = all_blocks.num_vertices();
    return form_;
  }
  LinearSolverResult Prepare(const SchurOperator& S) override {
    ++prepared;
    const SchurLayout& layout = S.layout();
    const auto n = static_cast<Eigen::Index>(layout.size());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
      const auto row = static_cast<std::size_t>(layout.blocks[k].row);
      const auto col = static_cast<std::size_t>(layout.blocks[k].col);
      const bool whole = form_ == SchurForm::kDense;
      const Eigen::Index rows = whole ? n : layout.offsets[row + 1] - layout.offsets[row];
      const Eigen::Index cols = whole ? n : layout.offsets[col + 1] - layout.offsets[col];
      const BlockView view = S.Block(k);
      dense.block(layout.offsets[row], layout.offsets[col], rows, cols) =
          Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
              view.data, rows, cols, Eigen::OuterStride<>(view.stride));
    }
    factor_.compute(dense);  // reads the lower triangle
    LinearSolverResult result;
    result.ok = factor_.info() == Eigen::Success && factor_.isPositive();
    return result;
  }
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest&) override {
    const auto n = static_cast<Eigen::Index>(S.layout().size());
    Eigen::Map<Eigen::VectorXd>(x, n) = factor_.solve(Eigen::Map<const Eigen::VectorXd>(b, n));
    LinearSolverResult result;
    result.ok = true;
    return result;
  }

  int prepared = 0;
  std::size_t num_vertices = 0;

 private:
  SchurForm form_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

class DenseReferenceTest : public testing::TestWithParam<std::tuple<GraphKind, Size>> {
 protected:
  static RandomGraphOptions Options(std::uint64_t seed) {
    RandomGraphOptions options;
    options.num_poses = std::get<1>(GetParam()).num_poses;
    options.num_landmarks = std::get<1>(GetParam()).num_landmarks;
    options.fixes = seed % 3 != 0;
    options.losses = seed % 4 != 1;
    options.information = seed % 5 != 2;
    options.removals = seed % 2 == 1 && options.num_poses > 4;
    return options;
  }
  static int NumSeeds() {
    const int num_poses = std::get<1>(GetParam()).num_poses;
    if (kSanitized) return num_poses <= 12 ? 2 : 1;
    return num_poses <= 12 ? 12 : num_poses <= 30 ? 4 : 2;
  }
  static Problem MakeProblem(std::uint64_t seed) {
    return Problem(MakeRandomGraph(std::get<0>(GetParam()), seed, Options(seed)));
  }
};

TEST_P(DenseReferenceTest, HessianAndGradient) {
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem = MakeProblem(static_cast<std::uint64_t>(seed));
    const Status status = problem.MakeHessian();
    ASSERT_TRUE(status.ok()) << status.message();
    const DenseReference dense(problem, problem.FreeVertices());
    ASSERT_EQ(problem.FreeOffsets().back(), dense.J.cols());
    EXPECT_NEAR(problem.Cost().value(), dense.cost, 1e-12 * dense.cost);
    EXPECT_LT(HessianError(problem.Hessian(), dense.H()), 1e-11);
    const Eigen::VectorXd b = problem.Rhs(), expected = dense.b();
    EXPECT_LT(RelativeError(b, expected), 1e-10);
    // No entry of b hides behind a large one.
    const Eigen::VectorXd scale =
        dense.J.colwise().norm().transpose() * std::sqrt(2.0 * dense.cost);
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
      EXPECT_NEAR(b[i], expected[i], 1e-12 * scale[i]) << "row " << i;
    }
  }
}

TEST_P(DenseReferenceTest, DampedStep) {
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem = MakeProblem(static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(problem.MakeHessian().ok());
    const DenseReference dense(problem, problem.FreeVertices());
    for (const double lambda : {1e-3, 1.0}) {
      SCOPED_TRACE("lambda " + std::to_string(lambda));
      const Eigen::VectorXd damping = MarquardtDamping(dense.J, lambda);
      const Eigen::VectorXd expected = DampedStep(dense.J, dense.r, damping);
      const Eigen::VectorXd curvature =
          (dense.J.colwise().squaredNorm().transpose() + damping).cwiseSqrt();
      const auto expect_step = [&](double tolerance) {
        const Eigen::VectorXd step = problem.Step();
        EXPECT_LT(RelativeError(step, expected), tolerance);
        EXPECT_LT(RelativeError(curvature.asDiagonal() * step, curvature.asDiagonal() * expected),
                  tolerance);
      };
      Status status = problem.SolveLinearSystem(lambda);
      ASSERT_TRUE(status.ok()) << status.message();
      expect_step(1e-9);

      const auto solve = [&](const SolveOptions& options) {
        status = problem.SolveLinearSystem(lambda, options);
        ASSERT_TRUE(status.ok()) << status.message();
        expect_step(1e-9);
      };
      for (const LinearSolverType type :
           {LinearSolverType::kDenseCholesky, LinearSolverType::kSparseCholesky}) {
        SolveOptions options;
        options.linear_solver_type = type;
        solve(options);
      }
      for (const LinearSolverType type : {LinearSolverType::kPcg, LinearSolverType::kImplicitPcg}) {
        for (const Preconditioner preconditioner :
             {Preconditioner::kBlockJacobi, Preconditioner::kJacobi}) {
          SolveOptions options;
          options.linear_solver_type = type;
          options.pcg.preconditioner = preconditioner;
          options.pcg.tolerance = 1e-14;
          options.pcg.max_iterations = 20000;
          solve(options);
        }
      }
      for (const SchurForm form : {SchurForm::kDense, SchurForm::kBlocks}) {
        OwnSolver own(form);
        SolveOptions options;
        options.linear_solver = &own;
        solve(options);
        EXPECT_EQ(own.prepared, own.num_vertices > 0 ? 1 : 0);
      }
    }
  }
}

TEST_P(DenseReferenceTest, DampedStepWithIdentity) {
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem = MakeProblem(static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(problem.MakeHessian().ok());
    const DenseReference dense(problem, problem.FreeVertices());
    SolveOptions options;
    options.damping = Damping::kIdentity;
    const double lambda = 1e-4 * dense.J.colwise().squaredNorm().maxCoeff();
    const Status status = problem.SolveLinearSystem(lambda, options);
    ASSERT_TRUE(status.ok()) << status.message();
    const Eigen::VectorXd expected =
        DampedStep(dense.J, dense.r, Eigen::VectorXd::Constant(dense.J.cols(), lambda));
    EXPECT_LT(RelativeError(problem.Step(), expected), 1e-9);
  }
}

// The step in states: what UpdateStates() does is Plus, vertex by vertex, or the chart's.
TEST_P(DenseReferenceTest, UpdateAndRollback) {
  Problem problem = MakeProblem(3);
  ASSERT_TRUE(problem.MakeHessian().ok());
  ASSERT_TRUE(problem.SolveLinearSystem(1e-3).ok());
  const Eigen::VectorXd step = problem.Step();
  const std::vector<AnyVertex> vertices = problem.FreeVertices();
  const std::vector<int> offsets = problem.FreeOffsets();
  const Snapshot before = problem.GetSnapshot();
  std::vector<FreeTangent> charts = problem.free_tangents();
  ASSERT_TRUE(problem.UpdateStates().ok());
  const Snapshot after = problem.GetSnapshot();

  std::size_t state = 0;
  for (const AnyVertex& vertex : before.vertices) {
    const VertexPoolBase& pool = *problem.PoolOf(vertex.type);
    const auto dim = static_cast<std::size_t>(pool.ops().ambient_dim);
    std::vector<double> expected(before.states.begin() + static_cast<std::ptrdiff_t>(state),
                                 before.states.begin() + static_cast<std::ptrdiff_t>(state + dim));
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      if (vertices[k] != vertex) continue;
      const double* d = step.data() + offsets[k];
      const int free_dim = offsets[k + 1] - offsets[k];
      if (free_dim == pool.ops().tangent_dim) {
        std::vector<double> moved(dim);
        pool.ops().plus(expected.data(), d, moved.data());
        expected = moved;
      } else {
        for (FreeTangent& chart : charts) {
          if (chart.vertex == vertex) chart.Plus(d, expected.data());
        }
      }
    }
    for (std::size_t i = 0; i < dim; ++i)
      EXPECT_EQ(after.states[state + i], expected[i]) << ToString(vertex);
    state += dim;
  }
  ASSERT_TRUE(problem.RollbackStates().ok());
  EXPECT_EQ(problem.GetSnapshot().states, before.states);
}

std::string NameOf(const testing::TestParamInfo<std::tuple<GraphKind, Size>>& info) {
  return ToString(std::get<0>(info.param)) + std::to_string(std::get<1>(info.param).num_poses) +
         "x" + std::to_string(std::get<1>(info.param).num_landmarks);
}

std::vector<Size> Sizes() {
  std::vector<Size> sizes{{1, 6}, {2, 5}, {3, 1}, {6, 20}, {12, 60}, {30, 90}, {60, 150}};
  // Dense matrices of a thousand columns take minutes under a sanitizer.
  if (kSanitized) sizes.pop_back();
  return sizes;
}

INSTANTIATE_TEST_SUITE_P(AllKinds, DenseReferenceTest,
                         testing::Combine(testing::ValuesIn(kAllGraphKinds),
                                          testing::ValuesIn(Sizes())),
                         NameOf);

}  // namespace
}  // namespace glissade::test
