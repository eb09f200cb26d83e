// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Linear graphs: whatever is marginalized, in whatever order and with whatever values in between,
// the optimum and the covariance of what is left are those of the full problem.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/marginal/marginalize.h"
#include "marginal/linear_graph.h"
#include "support/dense_reference.h"

namespace glissade {
namespace {

struct Gaussian {
  Eigen::VectorXd optimum;
  Eigen::MatrixXd covariance;
};

/// Of the given vertices, by a dense inverse of everything.
Gaussian Solve(const Graph& graph, const std::vector<AnyVertex>& of) {
  std::vector<AnyVertex> order = of;
  for (const AnyVertex& vertex : graph.Vertices()) {
    if (std::find(of.begin(), of.end(), vertex) == of.end()) order.push_back(vertex);
  }
  const test::DenseReference reference(graph, order);
  const Eigen::MatrixXd covariance =
      reference.H().ldlt().solve(Eigen::MatrixXd::Identity(reference.J.cols(), reference.J.cols()));
  const Eigen::VectorXd step = reference.J.colPivHouseholderQr().solve(-reference.r);
  Gaussian gaussian;
  Eigen::Index dim = 0;
  std::vector<double> x;
  for (const AnyVertex& vertex : of) {
    const VertexPoolBase* pool = graph.PoolOf(vertex.type);
    const double* data = pool->Data(pool->slots().IndexOf(vertex.slot));
    x.insert(x.end(), data, data + pool->ops().ambient_dim);
    dim += pool->ops().tangent_dim;
  }
  gaussian.optimum = Eigen::Map<Eigen::VectorXd>(x.data(), dim) + step.head(dim);
  gaussian.covariance = covariance.topLeftCorner(dim, dim);
  return gaussian;
}

struct Case {
  FirstEstimates mode;
  MarginalizeOptions options;
};

class LinearGaussian : public ::testing::TestWithParam<int> {
 protected:
  static Case GetCase(int k) {
    Case c;
    c.mode = static_cast<FirstEstimates>(k % 3);
    if (k / 3 > 0) c.options.form = MarginalForm::kSchur;
    if (k / 3 > 1) c.options.root = InformationRoot::kEigen;
    return c;
  }
};

TEST_P(LinearGaussian, AnySubsetInAnyOrderLeavesOptimumAndCovarianceOfTheRest) {
  const Case c = GetCase(GetParam());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::LinearGraph problem(seed);
    problem.graph.SetFirstEstimates(c.mode);
    // A random order of everything; some of it stays.
    std::vector<AnyVertex> vertices = problem.graph.Vertices();
    for (std::size_t k = vertices.size(); k > 1; --k) {
      std::swap(vertices[k - 1],
                vertices[static_cast<std::size_t>(problem.random.Uniform(0, 1) * double(k))]);
    }
    const std::size_t stay = 2 + seed % 5;
    const std::vector<AnyVertex> left(vertices.begin(), vertices.begin() + long(stay));
    const Gaussian expected = Solve(problem.graph, left);
    MarginalWorkspace workspace;
    for (std::size_t k = stay; k < vertices.size();) {
      const std::size_t count =
          std::min(vertices.size() - k, std::size_t(problem.random.Uniform(1, 5)));
      const auto result =
          Marginalize(&problem.graph, {vertices.data() + k, count}, c.options, &workspace);
      ASSERT_TRUE(result.ok()) << result.status().message();
      EXPECT_EQ(result->report.rank_deficiency, 0);
      problem.Scatter();
      k += count;
    }
    EXPECT_EQ(problem.graph.NumVertices(), static_cast<int>(stay));
    const Gaussian actual = Solve(problem.graph, left);
    EXPECT_LT((actual.optimum - expected.optimum).norm(), 1e-10 * expected.optimum.norm())
        << "seed " << seed;
    EXPECT_LT((actual.covariance - expected.covariance).norm(), 1e-10 * expected.covariance.norm())
        << "seed " << seed;
  }
}

/// The minimum over what goes of the cost is the cost that is left, its constant part included.
TEST_P(LinearGaussian, CostAtTheOptimumIsThatOfThePriorAndItsConstantPart) {
  const Case c = GetCase(GetParam());
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::LinearGraph problem(seed);
    problem.graph.SetFirstEstimates(c.mode);
    const std::vector<AnyVertex> vertices = problem.graph.Vertices();
    const test::DenseReference before(problem.graph, vertices);
    const Eigen::VectorXd step = before.J.colPivHouseholderQr().solve(-before.r);
    const double expected = 0.5 * (before.r + before.J * step).squaredNorm();
    const std::vector<AnyVertex> out{problem.states[0], problem.smalls[0], problem.points[0],
                                     problem.depths[0], problem.states[1]};
    const auto result = Marginalize(&problem.graph, out, c.options);
    ASSERT_TRUE(result.ok());
    const test::DenseReference after(problem.graph, problem.graph.Vertices());
    const Eigen::VectorXd step_after = after.J.colPivHouseholderQr().solve(-after.r);
    const double actual = 0.5 * (after.r + after.J * step_after).squaredNorm();
    EXPECT_NEAR(actual + result->report.constant_cost, expected, 1e-10 * (1.0 + expected));
    EXPECT_GT(result->report.constant_cost, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(ModesAndForms, LinearGaussian, ::testing::Range(0, 9));

}  // namespace
}  // namespace glissade
