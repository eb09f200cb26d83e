// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/threaded_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <random>
#include <vector>

#include "common/sanitized.h"

namespace glissade {
namespace {

/// Positive definite, lower triangle, columns `stride` apart.
std::vector<double> MakeMatrix(int n, int stride) {
  std::mt19937_64 engine(static_cast<unsigned>(n));
  std::vector<double> a(static_cast<std::size_t>(stride) * static_cast<std::size_t>(n), 0.0);
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r) {
      a[static_cast<std::size_t>(r) +
        static_cast<std::size_t>(c) * static_cast<std::size_t>(stride)] =
          (r == c ? 2.0 * n : 0.0) + static_cast<double>(engine() >> 11) * 0x1.0p-53;
    }
  }
  return a;
}

class ThreadedCholeskyTest : public ::testing::TestWithParam<int> {};

TEST_P(ThreadedCholeskyTest, IsTheFactorAndTheComplementForAnyNumberOfThreads) {
  const int n = GetParam(), stride = (n + 7) / 8 * 8;
  const std::vector<double> original = MakeMatrix(n, stride);
  using Strided = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  for (const int nb : {n, n / 3, n / 3 / 8 * 8, 1}) {
    std::vector<double> first;
    for (const int count : {1, 2, 3}) {
      ThreadPool threads(count);
      std::vector<double> a = original, scratch;
      ASSERT_EQ(ThreadedCholesky(n, nb, a.data(), stride, &threads, &scratch), 0);
      if (first.empty()) first = a;
      EXPECT_EQ(std::memcmp(a.data(), first.data(), a.size() * sizeof(double)), 0)
          << n << " " << nb << " " << count;
    }
    // A = [L11; L21] [L11; L21]' + [0 0; 0 rest].
    const Strided L(first.data(), n, n, Eigen::OuterStride<>(stride));
    Eigen::MatrixXd back = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd columns = L.leftCols(nb);
    columns.topRows(nb).triangularView<Eigen::StrictlyUpper>().setZero();
    back.selfadjointView<Eigen::Lower>().rankUpdate(columns);
    back.bottomRightCorner(n - nb, n - nb) += L.bottomRightCorner(n - nb, n - nb);
    std::vector<double> copy = original;
    const Strided A(copy.data(), n, n, Eigen::OuterStride<>(stride));
    const Eigen::MatrixXd difference = (back - A).triangularView<Eigen::Lower>();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12 * n) << n << " " << nb;
  }
}

TEST_P(ThreadedCholeskyTest, NamesThePivotThatIsNotPositive) {
  const int n = GetParam(), stride = (n + 7) / 8 * 8, bad = n - 2;
  std::vector<double> a = MakeMatrix(n, stride);
  a[static_cast<std::size_t>(bad) * static_cast<std::size_t>(stride + 1)] = -1.0;
  for (const int count : {1, 2}) {
    ThreadPool threads(count);
    std::vector<double> factor = a, scratch;
    EXPECT_EQ(ThreadedCholesky(n, n, factor.data(), stride, &threads, &scratch), bad + 1);
  }
}

// Both sides of where panels are two, where rows are packed, and where panels are wider.
INSTANTIATE_TEST_SUITE_P(Sizes, ThreadedCholeskyTest,
                         ::testing::Values(5, 190, 447, 460, test::kSanitized ? 500 : 1250));

}  // namespace
}  // namespace glissade
