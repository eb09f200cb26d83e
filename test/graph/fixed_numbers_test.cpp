// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Additive vertices that are held in part.

#include <gtest/gtest.h>

#include <bit>

#include "graph/toy_graphs.h"
#include "support/dense_reference.h"

namespace glissade::test {
namespace {

/// r = A x - c: draws all numbers of x.
struct EdgePull {
  using Vertices = VertexList<VertexVector<8>>;
  static constexpr int kResidualDim = 9;
  Matrix<9, 8> A = Matrix<9, 8>::Zero();
  Vector<9> c = Vector<9>::Zero();

  bool Evaluate(const VertexVector<8>& x, Vector<9>& r, Jacobian<9, 8>* d_r_d_x) const {
    r = A * Eigen::Map<const Vector<8>>(x.Data()) - c;
    if (d_r_d_x != nullptr) *d_r_d_x = A;
    return true;
  }
};

class FixedNumbers : public ::testing::Test {
 protected:
  FixedNumbers() {
    Random random(3);
    for (int k = 0; k < 9; ++k) {
      for (int c = 0; c < 8; ++c)
        edge_.A(k, c) = random.Uniform(-1, 1);
      edge_.c[k] = random.Uniform(-1, 1);
    }
    for (double& x : start_.value)
      x = random.Uniform(-1, 1);
    x_ = problem_.AddVertex(start_);
    y_ = problem_.AddVertex(start_);
    EXPECT_TRUE(problem_.AddEdge(edge_, {x_}).ok());
    EXPECT_TRUE(problem_.AddEdge(edge_, {y_}).ok());
  }

  /// The minimum over the numbers that are not held.
  Vector<8> Expected(std::uint32_t held) const {
    Eigen::MatrixXd free(9, 0);
    Eigen::VectorXd rhs = edge_.c;
    for (int k = 0; k < 8; ++k) {
      if ((held >> k & 1u) != 0) {
        rhs -= edge_.A.col(k) * start_.value[static_cast<std::size_t>(k)];
      } else {
        free.conservativeResize(9, free.cols() + 1);
        free.col(free.cols() - 1) = edge_.A.col(k);
      }
    }
    const Eigen::VectorXd best = free.householderQr().solve(rhs);
    Vector<8> x = Eigen::Map<const Vector<8>>(start_.Data());
    for (int k = 0, next = 0; k < 8; ++k) {
      if ((held >> k & 1u) == 0) x[k] = best[next++];
    }
    return x;
  }

  EdgePull edge_;
  VertexVector<8> start_;
  Problem problem_;
  VertexHandle<VertexVector<8>> x_, y_;
};

TEST_F(FixedNumbers, StayToTheBitAndTheRestFindsItsMinimum) {
  for (const std::uint32_t held : {0b00000001u, 0b10000000u, 0b00101100u, 0b01111111u}) {
    SCOPED_TRACE(held);
    Must(problem_.Set(x_, start_));
    Must(problem_.Set(y_, start_));
    Must(problem_.SetFixedNumbers(x_, held));
    EXPECT_EQ(problem_.GetFixed(x_), Fix::kNumbers);
    EXPECT_EQ(problem_.FixedNumbers(x_), held);
    ASSERT_EQ(problem_.free_tangents().size(), 1u);
    Must(problem_.MakeHessian());
    EXPECT_EQ(problem_.FreeOffsets().back(), 16 - std::popcount(held));
    const DenseReference dense(problem_, problem_.FreeVertices());
    EXPECT_LT(HessianError(problem_.Hessian(), dense.H()), 1e-13);
    ASSERT_TRUE(problem_.Solve({.max_iterations = 50}).ok());
    const Vector<8> expected = Expected(held), all = Expected(0);
    for (std::size_t k = 0; k < 8; ++k) {
      const double x = problem_.Get(x_).value[k];
      if ((held >> k & 1u) != 0) {
        EXPECT_EQ(x, start_.value[k]);
      } else {
        EXPECT_NEAR(x, expected[static_cast<int>(k)], 1e-6);
      }
      EXPECT_NEAR(problem_.Get(y_).value[k], all[static_cast<int>(k)], 1e-6);
    }
  }
}

TEST_F(FixedNumbers, NoneIsFreeAndAllAreWhole) {
  Must(problem_.SetFixedNumbers(x_, 0b11));
  Must(problem_.SetFixedNumbers(y_, 0b100));
  Must(problem_.SetFixedNumbers(x_, 0b1));  // another choice replaces the first
  EXPECT_EQ(problem_.free_tangents().size(), 2u);
  EXPECT_EQ(problem_.FixedNumbers(x_), 0b1u);
  EXPECT_EQ(problem_.FixedNumbers(y_), 0b100u);
  Must(problem_.SetFixedNumbers(x_, 0xFF));
  EXPECT_EQ(problem_.GetFixed(x_), Fix::kWhole);
  EXPECT_EQ(problem_.FixedNumbers(x_), 0u);
  Must(problem_.SetFixedNumbers(x_, 0));
  EXPECT_EQ(problem_.GetFixed(x_), Fix::kFree);
  EXPECT_EQ(problem_.free_tangents().size(), 1u);
  Must(problem_.SetFixed(y_, Fix::kFree));
  EXPECT_TRUE(problem_.free_tangents().empty());
  Must(problem_.SetFixedNumbers(y_, 0b100));
  Must(problem_.RemoveVertex(y_));
  EXPECT_TRUE(problem_.free_tangents().empty());
}

TEST_F(FixedNumbers, GoAlongWithClonesAndSnapshots) {
  Must(problem_.SetFixedNumbers(x_, 0b101));
  const Snapshot snapshot = problem_.GetSnapshot();
  Problem clone = problem_.Clone();
  EXPECT_EQ(clone.FixedNumbers(x_), 0b101u);
  ASSERT_TRUE(problem_.Solve({.max_iterations = 20}).ok());
  Must(problem_.RestoreSnapshot(snapshot));
  EXPECT_EQ(problem_.Get(x_).value, start_.value);
  EXPECT_EQ(problem_.FixedNumbers(x_), 0b101u);
  ASSERT_TRUE(clone.Solve({.max_iterations = 20}).ok());
  ASSERT_TRUE(problem_.Solve({.max_iterations = 20}).ok());
  EXPECT_EQ(clone.Get(x_).value, problem_.Get(x_).value);
}

TEST_F(FixedNumbers, Refusals) {
  const auto pose = problem_.AddVertex(VertexPose{});
  const auto point = problem_.AddVertex(VertexPointXYZ(1, 2, 3));
  const auto small = problem_.AddVertex(VertexVector<3>{});
  const auto large = problem_.AddVertex(VertexVector<10>{});
  const auto expect = [&](AnyVertex vertex, std::uint32_t held, StatusCode code) {
    EXPECT_EQ(problem_.SetFixedNumbers(vertex, held).code(), code);
    EXPECT_EQ(problem_.AcknowledgeRefusal().code(), code);
  };
  expect(pose.value(), 1, StatusCode::kInvalidArgument);
  expect(point.value(), 1, StatusCode::kInvalidArgument);
  expect(large.value(), 1, StatusCode::kInvalidArgument);
  expect(small.value(), 8, StatusCode::kInvalidArgument);
  expect(AnyVertex(), 1, StatusCode::kUnknownHandle);
  EXPECT_EQ(problem_.SetFixed(small, Fix::kNumbers).code(), StatusCode::kInvalidArgument);
  Must(problem_.SetFixedNumbers(small.value(), 2));
  EXPECT_EQ(problem_.SetEliminated(small, true).code(), StatusCode::kInvalidArgument);
  Must(problem_.SetFixedNumbers(small.value(), 0));
  Must(problem_.SetEliminated(small, true));
  EXPECT_EQ(problem_.SetFixedNumbers(small.value(), 2).code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(problem_.free_tangents().empty());
}

}  // namespace
}  // namespace glissade::test
