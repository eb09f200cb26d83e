// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A marginal prior without first estimates: its Hessian in the tangent at x is taken from the
// constant one. Building J'J anew in each iteration made kOff slower than kPriorOnly.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "common/random_states.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/problem/problem.h"

namespace glissade {
namespace {

/// The same residual, without a constant Hessian: the way of any dynamic edge.
class PlainPrior final : public DynamicEdge {
 public:
  explicit PlainPrior(const EdgeMarginalPrior& prior) : prior_(prior) {}
  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> v) const override {
    return prior_.CheckVertices(v);
  }
  [[nodiscard]] int ResidualDim() const override { return prior_.ResidualDim(); }
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override {
    return prior_.Evaluate(vertices, residual, jacobians);
  }
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<PlainPrior>(*this);
  }

 private:
  EdgeMarginalPrior prior_;
};

TEST(PriorLinearization, WithoutFirstEstimatesIsThatOfTheExactDerivative) {
  test::Random random(3);
  Problem constant, plain;
  constant.SetFirstEstimates(FirstEstimates::kOff);
  plain.SetFirstEstimates(FirstEstimates::kOff);
  std::vector<const VertexOps*> types;
  std::vector<double> x0;
  std::vector<AnyVertex> in_constant, in_plain;
  int dim = 0;
  for (int k = 0; k < 4; ++k) {
    VertexPose pose{random.RandomPose(2.0)};
    types.push_back(&kVertexOps<VertexPose>);
    x0.insert(x0.end(), pose.Data(), pose.Data() + 7);
    double delta[6];
    for (double& d : delta)
      d = 0.3 * random.Uniform(-1.0, 1.0);
    pose.Plus(delta);
    in_constant.emplace_back(constant.AddVertex(pose).value());
    in_plain.emplace_back(plain.AddVertex(pose).value());
    VertexSpeedBias speed;
    for (int i = 0; i < 9; ++i)
      speed.Data()[i] = random.Uniform(-1.0, 1.0);
    types.push_back(&kVertexOps<VertexSpeedBias>);
    x0.insert(x0.end(), speed.Data(), speed.Data() + 9);
    speed.Data()[2] += 0.5;
    in_constant.emplace_back(constant.AddVertex(speed).value());
    in_plain.emplace_back(plain.AddVertex(speed).value());
    dim += 15;
  }
  std::vector<double> r0, J;
  for (int row = 0; row < dim; ++row) {
    r0.push_back(random.Uniform(-1.0, 1.0));
    for (int c = 0; c < dim; ++c)
      J.push_back(random.Uniform(-1.0, 1.0));
  }
  auto prior = EdgeMarginalPrior::Create(types, x0, r0, J);
  ASSERT_TRUE(prior.ok());
  auto copy = std::make_unique<PlainPrior>(**prior);
  ASSERT_TRUE(
      constant.AddEdge(std::unique_ptr<DynamicEdge>(std::move(prior).value()), in_constant).ok());
  ASSERT_TRUE(plain.AddEdge(std::unique_ptr<DynamicEdge>(std::move(copy)), in_plain).ok());
  ASSERT_TRUE(constant.MakeHessian().ok());
  ASSERT_TRUE(plain.MakeHessian().ok());
  const Eigen::MatrixXd H = constant.Hessian(), expected = plain.Hessian();
  ASSERT_EQ(H.rows(), dim);
  EXPECT_LT((H - expected).norm(), 1e-13 * expected.norm());
  EXPECT_LT((constant.Rhs() - plain.Rhs()).norm(), 1e-13 * plain.Rhs().norm());
  EXPECT_NEAR(constant.Cost().value(), plain.Cost().value(), 1e-13 * plain.Cost().value());
  constant.SetFirstEstimates(FirstEstimates::kPriorOnly);
  ASSERT_TRUE(constant.MakeHessian().ok());
  EXPECT_GT((constant.Hessian() - expected).norm(), 1e-3 * expected.norm())
      << "or nothing is shown";
}

}  // namespace
}  // namespace glissade
