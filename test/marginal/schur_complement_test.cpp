// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/schur_complement.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "common/random_states.h"

namespace glissade {
namespace {

Eigen::MatrixXd RandomJacobian(int rows, int cols, std::uint64_t seed) {
  test::Random random(seed);
  Eigen::MatrixXd J(rows, cols);
  for (int c = 0; c < cols; ++c) {
    for (int r = 0; r < rows; ++r)
      J(r, c) = random.Uniform(-1, 1);
  }
  return J;
}

Eigen::MatrixXd Pick(const Eigen::MatrixXd& H, const std::vector<int>& rows,
                     const std::vector<int>& cols) {
  return H(rows, cols);
}

TEST(SchurComplement, KeepsTheSolutionAndTheCovarianceOfWhatIsKept) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Eigen::MatrixXd J = RandomJacobian(20, 12, seed);
    const Eigen::MatrixXd H = J.transpose() * J;
    const Eigen::VectorXd b = RandomJacobian(12, 1, seed + 100);
    const std::vector<int> keep{7, 1, 3, 10, 0}, out{2, 11, 4, 5, 6, 8, 9};
    const auto schur = SchurComplement(H, b, keep, out);
    ASSERT_TRUE(schur.ok()) << schur.status().message();
    EXPECT_EQ(schur->rank, 7);
    const Eigen::MatrixXd covariance = H.inverse();
    EXPECT_LT((schur->H.inverse() - Pick(covariance, keep, keep)).norm(),
              1e-10 * covariance.norm());
    const Eigen::VectorXd x = H.ldlt().solve(b), y = schur->H.ldlt().solve(schur->b);
    for (std::size_t k = 0; k < keep.size(); ++k)
      EXPECT_NEAR(y[static_cast<Eigen::Index>(k)], x[keep[k]], 1e-10 * x.norm());
  }
}

TEST(SchurComplement, DoesNotDependOnUnits) {
  const Eigen::MatrixXd J = RandomJacobian(20, 8, 1);
  Eigen::VectorXd unit(8);
  unit << 1e-6, 1, 1e5, 1e-3, 1e6, 1, 1e-5, 10;
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::MatrixXd scaled = unit.asDiagonal() * H * unit.asDiagonal();
  const Eigen::VectorXd b = RandomJacobian(8, 1, 2);
  const std::vector<int> keep{5, 6, 7}, out{0, 1, 2, 3, 4};
  const auto a = SchurComplement(H, b, keep, out);
  const auto c = SchurComplement(scaled, unit.asDiagonal() * b, keep, out);
  ASSERT_TRUE(a.ok() && c.ok());
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(c->H(i, j) / unit[5 + i] / unit[5 + j], a->H(i, j), 1e-11);
    EXPECT_NEAR(c->b[i] / unit[5 + i], a->b[i], 1e-11);
  }
}

TEST(SchurComplement, ASingularBlockTakesThePseudoInverse) {
  // Columns 0 and 1 are seen in their sum only, column 2 not at all.
  Eigen::MatrixXd J = RandomJacobian(9, 6, 3);
  J.col(1) = J.col(0);
  J.col(2).setZero();
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::VectorXd r = RandomJacobian(9, 1, 4);
  const Eigen::VectorXd b = -J.transpose() * r;
  const auto schur = SchurComplement(H, b, {3, 4, 5}, {0, 1, 2});
  ASSERT_TRUE(schur.ok()) << schur.status().message();
  EXPECT_EQ(schur->rank, 1);
  const auto reduced = SchurComplement(H, b, {3, 4, 5}, {0});
  ASSERT_TRUE(reduced.ok());
  EXPECT_LT((schur->H - reduced->H).norm(), 1e-12 * H.norm());
  EXPECT_LT((schur->b - reduced->b).norm(), 1e-12 * H.norm());
}

TEST(SchurComplement, TheEndsOfTheRange) {
  const Eigen::MatrixXd J = RandomJacobian(9, 4, 5);
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::VectorXd b = RandomJacobian(4, 1, 6);
  const auto all = SchurComplement(H, b, {3, 1}, {});
  ASSERT_TRUE(all.ok());
  EXPECT_EQ(all->H(0, 1), H(3, 1));
  EXPECT_EQ(all->b[1], b[1]);
  const auto nothing = SchurComplement(H, b, {}, {0, 1, 2, 3});
  ASSERT_TRUE(nothing.ok());
  EXPECT_EQ(nothing->H.size(), 0);
  EXPECT_EQ(nothing->rank, 4);
}

TEST(SchurComplement, Refusals) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(3);
  const auto code = [&](const std::vector<int>& keep, const std::vector<int>& out) {
    return SchurComplement(H, b, keep, out).status().code();
  };
  EXPECT_EQ(code({0, 1}, {2}), StatusCode::kOk);
  EXPECT_EQ(code({0, 1}, {1}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({0, 3}, {1}), StatusCode::kInvalidArgument);
  EXPECT_EQ(SchurComplement(H, Eigen::VectorXd(2), {0}, {1}).status().code(),
            StatusCode::kInvalidArgument);
  H(0, 1) = 0.1;
  EXPECT_EQ(code({0, 1}, {2}), StatusCode::kInvalidArgument);
  H(1, 0) = 0.1;
  EXPECT_EQ(code({0, 1}, {2}), StatusCode::kOk);
  H(2, 1) = H(1, 2) = 5.0;
  EXPECT_EQ(code({0}, {1, 2}), StatusCode::kNotPositive);
  H(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code({0}, {1, 2}), StatusCode::kNotFinite);
}

}  // namespace
}  // namespace glissade
