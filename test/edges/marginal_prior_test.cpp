// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/marginal_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "common/random_states.h"
#include "glissade/problem/problem.h"
#include "glissade/testing/numeric_derivative.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"

namespace glissade {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Two poses, speed and biases, a depth, and a type the edge does not know.
const std::vector<const VertexOps*> kTypes{&kVertexOps<VertexPose>, &kVertexOps<VertexSpeedBias>,
                                           &kVertexOps<VertexPose>, &kVertexOps<VertexInverseDepth>,
                                           &kVertexOps<VertexVector<2>>};
constexpr int kRows = 20;
constexpr int kTangent = 6 + 9 + 6 + 1 + 2;
constexpr int kAmbient = 7 + 9 + 7 + 1 + 2;

struct Prior {
  std::vector<double> x0, r0, J;
  std::unique_ptr<EdgeMarginalPrior> edge;
};

Prior MakePrior(std::uint64_t seed) {
  test::Random random(seed);
  Prior p;
  for (const VertexOps* ops : kTypes) {
    if (ops->type == &kTypeInfo<VertexPose>) {
      const Pose pose = random.RandomPose(2.0);
      p.x0.insert(p.x0.end(), pose.data, pose.data + 7);
    } else {
      for (int k = 0; k < ops->ambient_dim; ++k)
        p.x0.push_back(random.Uniform(-1, 1));
    }
  }
  for (int k = 0; k < kRows; ++k)
    p.r0.push_back(random.Uniform(-1, 1));
  for (int k = 0; k < kRows * kTangent; ++k)
    p.J.push_back(random.Uniform(-1, 1));
  p.edge = std::move(EdgeMarginalPrior::Create(kTypes, p.x0, p.r0, p.J)).value();
  return p;
}

/// x0 moved by the tangent vector d, vertex by vertex.
std::vector<double> Moved(const std::vector<double>& x, const double* d) {
  std::vector<double> moved(x.size());
  std::size_t at = 0;
  for (const VertexOps* ops : kTypes) {
    ops->plus(x.data() + at, d, moved.data() + at);
    at += static_cast<std::size_t>(ops->ambient_dim);
    d += ops->tangent_dim;
  }
  return moved;
}

std::vector<VertexRef> Refs(const std::vector<double>& x) {
  std::vector<VertexRef> refs;
  const double* at = x.data();
  for (const VertexOps* ops : kTypes) {
    refs.push_back({ops, at});
    at += ops->ambient_dim;
  }
  return refs;
}

/// The Jacobians of Evaluate side by side.
RowMajor AllJacobians(const EdgeMarginalPrior& edge, const std::vector<double>& x, double* r) {
  RowMajor J(kRows, kTangent);
  std::vector<std::vector<double>> blocks;
  std::vector<double*> pointers;
  for (const VertexOps* ops : kTypes)
    blocks.emplace_back(static_cast<std::size_t>(kRows * ops->tangent_dim), NAN);
  for (auto& block : blocks)
    pointers.push_back(block.data());
  EXPECT_TRUE(edge.Evaluate(Refs(x), r, pointers.data()));
  int col = 0;
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    const int d = kTypes[i]->tangent_dim;
    J.middleCols(col, d) = Eigen::Map<RowMajor>(blocks[i].data(), kRows, d);
    col += d;
  }
  return J;
}

// Vectors were differentiated by differences, as types that the library does not know.
TEST(MarginalPrior, TheDerivativeOfAVectorIsTheIdentityToTheBit) {
  const double x[3] = {0.1, 1e6, -0.3}, x0[3] = {3.0, -7.0, 1e-3};
  double D[9];
  internal::MinusJacobian(kVertexOps<VertexVector<3>>, x, x0, D);
  for (int k = 0; k < 9; ++k)
    EXPECT_EQ(D[k], k % 4 == 0 ? 1.0 : 0.0);
}

TEST(MarginalPrior, TheDerivativeOfAPoseIsItsDifferences) {
  test::Random random(5);
  const VertexPose x{random.RandomPose(1.0)}, x0{random.RandomPose(1.0)};
  VertexOps unknown = kVertexOps<VertexPose>;
  unknown.minus_jacobian = nullptr;
  double D[36], differences[36];
  internal::MinusJacobian(kVertexOps<VertexPose>, x.Data(), x0.Data(), D);
  internal::MinusJacobian(unknown, x.Data(), x0.Data(), differences);
  for (int k = 0; k < 36; ++k)
    EXPECT_NEAR(D[k], differences[k], 1e-9);
}

TEST(MarginalPrior, JacobiansAreThoseOfTheResidual) {
  test::Random random(11);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Prior p = MakePrior(seed);
    for (const double size : {0.0, 1e-5, 0.1, 1.5}) {
      double d[kTangent];
      for (double& x : d)
        x = random.Uniform(-size, size);
      const std::vector<double> x = Moved(p.x0, d);
      double r[kRows];
      const RowMajor J = AllJacobians(*p.edge, x, r);
      for (int c = 0; c < kTangent; ++c) {
        const auto numeric = Differentiate(
            [&](double t, double* y) {
              double step[kTangent] = {};
              step[c] = t;
              const auto moved = Moved(x, step);
              return p.edge->Evaluate(Refs(moved), y, nullptr);
            },
            kRows, 1e-2);
        for (int k = 0; k < kRows; ++k)
          EXPECT_NEAR(J(k, c), numeric.value[static_cast<std::size_t>(k)], 1e-8)
              << "row " << k << ", column " << c << ", moved by " << size;
      }
    }
  }
}

TEST(MarginalPrior, TheResidualIsExactFarFromX0) {
  const Prior p = MakePrior(1);
  test::Random random(5);
  Eigen::VectorXd d(kTangent);
  for (int k = 0; k < kTangent; ++k)
    d[k] = random.Uniform(-1, 1);
  double r[kRows], s = 0.0;
  const auto x = Moved(p.x0, d.data());
  ASSERT_TRUE(p.edge->Evaluate(Refs(x), r, nullptr));
  const Eigen::VectorXd expected = Eigen::Map<const Eigen::VectorXd>(p.r0.data(), kRows) +
                                   Eigen::Map<const RowMajor>(p.J.data(), kRows, kTangent) * d;
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(r, kRows) - expected).norm(), 1e-12);
  ASSERT_TRUE(p.edge->LinearizeQuadratic(Refs(x), nullptr, &s));
  EXPECT_NEAR(s, expected.squaredNorm(), 1e-11);
}

TEST(MarginalPrior, AtX0TheConstantDerivativeIsTheExactOne) {
  const Prior p = MakePrior(2);
  double r[kRows], s = 0.0;
  const RowMajor J = AllJacobians(*p.edge, p.x0, r);
  Eigen::VectorXd gradient(kTangent);
  ASSERT_TRUE(p.edge->LinearizeQuadratic(Refs(p.x0), gradient.data(), &s));
  EXPECT_LT((gradient - J.transpose() * Eigen::Map<Eigen::VectorXd>(r, kRows)).norm(), 1e-10);
  const Eigen::Map<const RowMajor> H(p.edge->ConstantHessian(), kTangent, kTangent);
  EXPECT_LT((H - J.transpose() * J).norm(), 1e-9);
  // And away from it the solve's gradient keeps the J of x0.
  double d[kTangent];
  for (double& x : d)
    x = 0.5;
  const auto x = Moved(p.x0, d);
  ASSERT_TRUE(p.edge->LinearizeQuadratic(Refs(x), gradient.data(), &s));
  const RowMajor exact = AllJacobians(*p.edge, x, r);
  const Eigen::Map<Eigen::VectorXd> residual(r, kRows);
  const Eigen::Map<const RowMajor> J0(p.J.data(), kRows, kTangent);
  EXPECT_LT((gradient - J0.transpose() * residual).norm(), 1e-11);
  EXPECT_GT((gradient - exact.transpose() * residual).norm(), 1e-2);
}

TEST(MarginalPrior, CopiesAndAccessors) {
  const Prior p = MakePrior(3);
  EXPECT_EQ(p.edge->TangentDim(), kTangent);
  EXPECT_EQ(p.edge->ResidualDim(), kRows);
  const auto copy = p.edge->Clone();
  EXPECT_EQ(copy->ConstantHessian(), p.edge->ConstantHessian());  // shared, not copied
  EXPECT_TRUE(std::equal(p.x0.begin(), p.x0.end(), p.edge->x0().begin()));
  EXPECT_TRUE(std::equal(p.r0.begin(), p.r0.end(), p.edge->r0().begin()));
  EXPECT_TRUE(std::equal(p.J.begin(), p.J.end(), p.edge->jacobian().begin()));
  EXPECT_TRUE(std::equal(kTypes.begin(), kTypes.end(), p.edge->vertex_types().begin()));
}

TEST(MarginalPrior, Refusals) {
  Prior p = MakePrior(4);
  const auto create = [&] { return EdgeMarginalPrior::Create(kTypes, p.x0, p.r0, p.J).status(); };
  EXPECT_TRUE(create().ok());
  p.J[3] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(create().code(), StatusCode::kNotFinite);
  p.J.pop_back();
  EXPECT_EQ(create().code(), StatusCode::kInvalidArgument);
  ASSERT_EQ(p.x0.size(), static_cast<std::size_t>(kAmbient));
  p.x0.pop_back();
  EXPECT_EQ(create().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(EdgeMarginalPrior::Create({}, {}, p.r0, {}).status().code(),
            StatusCode::kInvalidArgument);
  auto wrong = kTypes;
  std::swap(wrong[0], wrong[1]);
  EXPECT_EQ(p.edge->CheckVertices(wrong).code(), StatusCode::kInvalidArgument);
  wrong.pop_back();
  EXPECT_EQ(p.edge->CheckVertices(wrong).code(), StatusCode::kInvalidArgument);
}

/// A pose under a prior at the minimum of which r = 0: a solve goes there in spite of the constant
/// J, because the residual is exact.
TEST(MarginalPrior, ASolveEndsWhereTheResidualIsZero) {
  test::Random random(9);
  const Pose pose0 = random.RandomPose(1.0);
  std::vector<double> J(36), r0(6);
  for (int k = 0; k < 36; ++k)
    J[static_cast<std::size_t>(k)] = (k % 7 == 0 ? 2.0 : 0.0) + random.Uniform(-0.3, 0.3);
  for (double& x : r0)
    x = random.Uniform(-0.5, 0.5);
  const std::vector<const VertexOps*> types{&kVertexOps<VertexPose>};
  auto edge = EdgeMarginalPrior::Create(types, {pose0.data, 7}, r0, J);
  ASSERT_TRUE(edge.ok());
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose{pose0});
  const auto added = problem.AddEdge(std::move(edge).value(), std::vector<AnyVertex>{pose.value()});
  ASSERT_TRUE(added.ok()) << added.status().message();
  const SolveSummary& summary = problem.Solve({.max_iterations = 100, .cost_tolerance = 0.0});
  EXPECT_TRUE(summary.ok());
  EXPECT_LT(summary.final_cost, 1e-18);
}

}  // namespace
}  // namespace glissade
