// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Weights: what is accepted as information, and that r' Omega r comes out of it.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Six numbers measured directly: r = x.
struct EdgeSix {
  using Vertices = VertexList<VertexVector<6>>;
  static constexpr int kResidualDim = 6;
  bool Evaluate(const VertexVector<6>& x, Vector6& r, Jacobian<6, 6>* J) const {
    r = Vector6(x.value.data());
    if (J) J->setIdentity();
    return true;
  }
};

class Information : public ::testing::Test {
 protected:
  Information() {
    Random random(3);
    for (double& v : r_.value)
      v = random.Uniform(-1.0, 1.0);
    x_ = graph_.AddVertex(r_);
  }
  Result<EdgeHandle<EdgeSix>> Add(const Matrix6& omega) {
    EdgeOptions<EdgeSix> options;
    options.information = omega;
    return graph_.AddEdge(EdgeSix(), {x_}, options);
  }
  /// r' Omega r straight from the definition, in long double.
  double Expected(const Matrix6& omega) const {
    long double sum = 0;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j)
        sum += (long double)(r_.value[std::size_t(i)]) * omega(i, j) * r_.value[std::size_t(j)];
    }
    return double(sum);
  }
  void ExpectAccepted(const Matrix6& omega, double tolerance = 1e-12) {
    const auto edge = Add(omega);
    ASSERT_TRUE(edge.ok()) << edge.status().message() << "\n" << omega;
    const double scale = omega.diagonal().sum();
    EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge.value()))), Expected(omega), tolerance * scale);
  }

  Graph graph_;
  VertexVector<6> r_;
  VertexHandle<VertexVector<6>> x_;
};

Matrix6 RandomFactor(Random* random, int rank) {
  Matrix6 L = Matrix6::Zero();
  for (int i = 0; i < rank; ++i) {
    for (int j = 0; j < 6; ++j)
      L(i, j) = random->Uniform(-1.0, 1.0);
  }
  return L;
}

TEST_F(Information, OfAnyRankIsAccepted) {
  Random random(8);
  for (int rank = 0; rank <= 6; ++rank) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix6 L = RandomFactor(&random, rank);
      ExpectAccepted(L.transpose() * L);
    }
  }
}

TEST_F(Information, OfMixedUnitsIsAccepted) {
  // Metres and radians, or worse: sigmas from 1e-5 to 1e5 in one matrix, correlated.
  Random random(9);
  const double sigmas[] = {1e-5, 1e-3, 1.0, 1e2, 1e5, 1e-4};
  for (const int rank : {1, 3, 5, 6}) {
    Matrix6 L = RandomFactor(&random, rank);
    for (int j = 0; j < 6; ++j)
      L.col(j) /= sigmas[j];
    const Matrix6 omega = L.transpose() * L;
    const auto edge = Add(omega);
    ASSERT_TRUE(edge.ok()) << "rank " << rank;
    EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge.value()))) / Expected(omega), 1.0, 1e-10);
  }
}

TEST_F(Information, WithRowsOfZerosIsAccepted) {
  Matrix6 omega = Matrix6::Zero();
  ExpectAccepted(omega);
  omega(2, 2) = 4.0;
  omega(5, 5) = 9.0;
  omega(2, 5) = omega(5, 2) = 6.0;  // rank 1
  ExpectAccepted(omega);
}

TEST_F(Information, AsymmetryOfRoundingIsAcceptedMoreIsNot) {
  Random random(10);
  const Matrix6 L = RandomFactor(&random, 6);
  Matrix6 omega = L.transpose() * L;
  omega(1, 4) *= 1.0 + 1e-12;
  ExpectAccepted(omega);
  omega(1, 4) += 1e-3;
  EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotPositive);
}

TEST_F(Information, IndefiniteIsRefused) {
  Matrix6 omega = Matrix6::Identity();
  omega(3, 3) = -1e-3;
  EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotPositive) << "negative diagonal";
  omega = Matrix6::Identity();
  omega(0, 5) = omega(5, 0) = 1.01;
  EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotPositive) << "correlation above 1";
  omega = Matrix6::Zero();
  omega(0, 1) = omega(1, 0) = 1.0;
  EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotPositive) << "zero diagonal";
  // One slightly negative eigenvalue in a full matrix.
  Random random(11);
  Matrix6 Q = Eigen::HouseholderQR<Matrix6>(RandomFactor(&random, 6)).householderQ();
  Vector6 eigenvalues;
  eigenvalues << 1.0, 2.0, 3.0, 4.0, 5.0, -1e-6;
  omega = Q * eigenvalues.asDiagonal() * Q.transpose();
  omega = (0.5 * (omega + omega.transpose())).eval();
  EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotPositive) << "eigenvalue -1e-6";
  EXPECT_EQ(graph_.NumEdges(), 0);
}

TEST_F(Information, NotFiniteIsRefused) {
  for (int k = 0; k < 36; k += 5) {
    Matrix6 omega = Matrix6::Identity();
    omega.data()[k] = kNan;
    EXPECT_EQ(Add(omega).status().code(), StatusCode::kNotFinite);
    EdgeOptions<EdgeSix> options;
    options.sqrt_information = omega;
    EXPECT_EQ(graph_.AddEdge(EdgeSix(), {x_}, options).status().code(), StatusCode::kNotFinite);
  }
  EXPECT_EQ(graph_.NumEdges(), 0);
}

TEST_F(Information, BothAtOnceIsRefused) {
  EdgeOptions<EdgeSix> options;
  options.information = Matrix6::Identity();
  options.sqrt_information = Matrix6::Identity();
  EXPECT_EQ(graph_.AddEdge(EdgeSix(), {x_}, options).status().code(), StatusCode::kInvalidArgument);
}

TEST_F(Information, AnySquareRootIsAccepted) {
  // Not triangular, not symmetric, singular: Omega = L' L.
  Random random(12);
  for (const int rank : {0, 2, 6}) {
    EdgeOptions<EdgeSix> options;
    options.sqrt_information = RandomFactor(&random, rank);
    const auto edge = Must(graph_.AddEdge(EdgeSix(), {x_}, options));
    const Matrix6 omega = options.sqrt_information->transpose() * *options.sqrt_information;
    EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge))), Expected(omega), 1e-13);
  }
}

TEST_F(Information, IsReplacedOrKept) {
  const auto edge = Must(Add(Matrix6::Identity()));
  Random random(13);
  const Matrix6 L = RandomFactor(&random, 4);
  const std::uint64_t version = graph_.structure_version();
  Must(graph_.SetInformation(edge, L.transpose() * L));
  const double chi2 = Must(graph_.Chi2(AnyEdge(edge)));
  EXPECT_NEAR(chi2, Expected(L.transpose() * L), 1e-13);
  Must(graph_.SetSqrtInformation(edge, L));
  EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge))), chi2, 1e-13);
  EXPECT_EQ(graph_.structure_version(), version) << "a weight is no structure";

  Matrix6 bad = Matrix6::Identity();
  bad(0, 0) = -1.0;
  const double before = Must(graph_.Chi2(AnyEdge(edge)));
  const Status refused = graph_.SetInformation(edge, bad);
  EXPECT_EQ(refused.code(), StatusCode::kNotPositive);
  EXPECT_EQ(refused.edge(), AnyEdge(edge));
  bad(0, 0) = kNan;
  EXPECT_EQ(graph_.SetInformation(edge, bad).code(), StatusCode::kNotFinite);
  EXPECT_EQ(graph_.SetSqrtInformation(edge, bad).code(), StatusCode::kNotFinite);
  EXPECT_EQ(Must(graph_.Chi2(AnyEdge(edge))), before);
  // And back to the identity, which is a path of its own.
  Must(graph_.SetSqrtInformation(edge, Matrix6::Identity()));
  EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge))), Expected(Matrix6::Identity()), 1e-14);
}

TEST_F(Information, WeightsOneEdgeOnly) {
  const auto a = Must(Add(Matrix6::Identity()));
  const auto b = Must(Add(Matrix6::Identity()));
  const double before = Must(graph_.Chi2(AnyEdge(b)));
  Must(graph_.SetInformation(a, Matrix6(4.0 * Matrix6::Identity())));
  EXPECT_EQ(Must(graph_.Chi2(AnyEdge(b))), before);
  EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(a))), 4.0 * before, 1e-13);
}

TEST_F(Information, LossIsReplacedForOneEdgeOnly) {
  const auto a = Must(Add(Matrix6(100.0 * Matrix6::Identity())));
  const auto b = Must(Add(Matrix6(100.0 * Matrix6::Identity())));
  const double s = Must(graph_.Chi2(AnyEdge(a)));
  ASSERT_GT(s, 1.0);
  EXPECT_NEAR(Must(graph_.Cost()), s, 1e-12 * s);
  Must(graph_.SetLoss(a, Huber{1.0}));
  double rho[3];
  Huber{1.0}.Evaluate(s, rho);
  EXPECT_NEAR(Must(graph_.Cost()), 0.5 * rho[0] + 0.5 * s, 1e-12 * s);
  EXPECT_EQ(Must(graph_.Chi2(AnyEdge(a))), s) << "Chi2 is without the loss";
  Must(graph_.SetLoss(b, Cauchy{2.0}));
  double rho_b[3];
  Cauchy{2.0}.Evaluate(s, rho_b);
  EXPECT_NEAR(Must(graph_.Cost()), 0.5 * (rho[0] + rho_b[0]), 1e-12 * s);
  Must(graph_.SetLoss(a, Loss()));
  EXPECT_NEAR(Must(graph_.Cost()), 0.5 * s + 0.5 * rho_b[0], 1e-12 * s);
  Must(graph_.SetLoss(b, Trivial()));
  EXPECT_NEAR(Must(graph_.Cost()), s, 1e-12 * s);
}

}  // namespace
}  // namespace glissade::test
