// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

constexpr double kUpper = 1.25e55;

class CholeskyTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(CholeskyTest);

/// Textbook factorization in long double.
std::vector<long double> ReferenceFactor(const GuardedMatrix& a) {
  const size_t n = static_cast<size_t>(a.rows());
  std::vector<long double> l(n * n);
  for (size_t c = 0; c < n; ++c) {
    for (size_t r = c; r < n; ++r) {
      long double s = a(static_cast<int>(r), static_cast<int>(c));
      for (size_t k = 0; k < c; ++k)
        s -= l[r + k * n] * l[c + k * n];
      l[r + c * n] = r == c ? std::sqrt(s) : s / l[c + c * n];
    }
  }
  return l;
}

TEST_P(CholeskyTest, EqualsReferenceOnEverySize) {
  Random random(1);
  for (const int n : TestSizes()) {
    for (const int ld : TestLeadingDimensions(n)) {
      GuardedMatrix a = RandomSpd(n, ld, kUpper, random);
      const std::vector<long double> expected = ReferenceFactor(a);
      ASSERT_EQ(k().cholesky(n, a.data(), ld), 0) << "n " << n << " ld " << ld;
      double worst = 0.0;
      for (int c = 0; c < n; ++c) {
        for (int r = c; r < n; ++r) {
          const size_t i = static_cast<size_t>(r) + static_cast<size_t>(c) * static_cast<size_t>(n);
          worst = std::max(worst, std::abs(static_cast<double>(a(r, c) - expected[i])));
        }
      }
      // Entries are of order sqrt(n / 3); the condition number is below 1e3.
      EXPECT_LT(worst, 1e-12) << "n " << n << " ld " << ld;
      EXPECT_TRUE(a.UpperIs(kUpper)) << "n " << n << " ld " << ld;
      EXPECT_TRUE(a.GuardsIntact()) << "n " << n << " ld " << ld;
    }
  }
}

TEST_P(CholeskyTest, EmptyMatrix) {
  EXPECT_EQ(k().cholesky(0, nullptr, 0), 0);
}

TEST_P(CholeskyTest, ReportsTheFirstPivotThatIsNotPositive) {
  Random random(2);
  for (const int n : {1, 2, 5, 8, 9, 23, 24, 25, 60, 61, 97, 200, 300}) {
    for (int trial = 0; trial < 8; ++trial) {
      const int bad = trial == 0 ? 0 : trial == 1 ? n - 1 : random.Below(n);
      for (const double value : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(),
                                 -std::numeric_limits<double>::infinity()}) {
        GuardedMatrix a = RandomSpd(n, n + 1, kUpper, random);
        // A zero row and column: the pivot is `value` exactly.
        for (int i = 0; i < n; ++i)
          (i <= bad ? a(bad, i) : a(i, bad)) = 0.0;
        a(bad, bad) = value;
        EXPECT_EQ(k().cholesky(n, a.data(), n + 1), bad + 1) << "n " << n << " pivot " << value;
        EXPECT_TRUE(a.GuardsIntact());
      }
    }
  }
}

TEST_P(CholeskyTest, AnyNanOrInfinityIsAFailure) {
  Random random(3);
  for (const int n : {1, 2, 3, 7, 8, 9, 17, 31, 60, 100, 250}) {
    for (int trial = 0; trial < 20; ++trial) {
      GuardedMatrix a = RandomSpd(n, n, kUpper, random);
      const int r = random.Below(n);
      const int c = random.Below(r + 1);
      a(r, c) = std::numeric_limits<double>::quiet_NaN();
      const int info = k().cholesky(n, a.data(), n);
      // The entry reaches the pivot of its row, and none before the column's own.
      EXPECT_EQ(info, r + 1) << "n " << n << " at " << r << "," << c;
    }
  }
}

TEST_P(CholeskyTest, SameBitsTwiceWhateverThePaddingHolds) {
  Random random(4);
  for (const int n : {1, 7, 13, 60, 150, 301}) {
    GuardedMatrix a = RandomSpd(n, n + 5, kUpper, random);
    GuardedMatrix b = a;
    GuardedMatrix c = a;
    c.FillUpper(std::numeric_limits<double>::quiet_NaN());
    ASSERT_EQ(k().cholesky(n, a.data(), a.ld()), 0);
    ASSERT_EQ(k().cholesky(n, b.data(), b.ld()), 0);
    ASSERT_EQ(k().cholesky(n, c.data(), c.ld()), 0);
    EXPECT_TRUE(a.SameBits(b));
    c.FillUpper(kUpper);
    EXPECT_TRUE(a.SameBits(c));
  }
}

TEST_P(CholeskyTest, WideRangeOfScales) {
  // H of bundle adjustment mixes information 1e16 (anchors) with 1e-6 (damping).
  Random random(5);
  for (const int n : {6, 30, 60, 126}) {
    GuardedMatrix a = RandomSpd(n, n, kUpper, random);
    std::vector<double> scale(static_cast<size_t>(n));
    for (double& s : scale)
      s = std::pow(10.0, 9.0 * random.Uniform());
    GuardedMatrix b = a;
    for (int c = 0; c < n; ++c) {
      for (int r = c; r < n; ++r) {
        b(r, c) = a(r, c) * scale[static_cast<size_t>(r)] * scale[static_cast<size_t>(c)];
      }
    }
    ASSERT_EQ(k().cholesky(n, a.data(), n), 0);
    ASSERT_EQ(k().cholesky(n, b.data(), n), 0);
    for (int c = 0; c < n; ++c) {
      for (int r = c; r < n; ++r) {
        EXPECT_NEAR(b(r, c) / scale[static_cast<size_t>(r)], a(r, c), 1e-11);
      }
    }
  }
}

}  // namespace
}  // namespace glissade::kernels
