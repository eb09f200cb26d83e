// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class TriangularTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(TriangularTest);

/// A well-conditioned lower triangular matrix; the upper triangle is NaN: it must not be read.
GuardedMatrix RandomLower(int n, int ld, Random& random) {
  GuardedMatrix l(n, n, ld);
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r)
      l(r, c) = random.Uniform() / std::sqrt(n);
    l(c, c) = 1.5 + 0.5 * random.Uniform();
  }
  l.FillUpper(kNan);
  return l;
}

/// b - L x (or b - L' x), the largest entry.
double Residual(const GuardedMatrix& l, bool transposed, const double* x, const double* b) {
  long double worst = 0.0;
  const int n = l.rows();
  for (int r = 0; r < n; ++r) {
    long double s = b[r];
    for (int c = 0; c < n; ++c) {
      if (transposed ? c >= r : c <= r) s -= (transposed ? l(c, r) : l(r, c)) * Wide{x[c]};
    }
    worst = std::max(worst, std::abs(s));
  }
  return static_cast<double>(worst);
}

TEST_P(TriangularTest, OneRightHandSide) {
  Random random(11);
  for (const int n : TestSizes()) {
    for (const int ld : TestLeadingDimensions(n)) {
      const GuardedMatrix l = RandomLower(n, ld, random);
      Guarded b(static_cast<size_t>(n));
      b.FillRandom(random);
      Guarded forward = b;
      Guarded both = b;
      k().forward_solve(n, l.data(), ld, forward.data());
      k().cholesky_solve(n, l.data(), ld, both.data());
      EXPECT_LT(Residual(l, false, forward.data(), b.data()), 1e-13) << "n " << n << " ld " << ld;
      EXPECT_LT(Residual(l, true, both.data(), forward.data()), 1e-13) << "n " << n;
      EXPECT_TRUE(forward.GuardsIntact() && both.GuardsIntact());
      Guarded again = b;
      k().cholesky_solve(n, l.data(), ld, again.data());
      EXPECT_TRUE(again.SameBits(both));
    }
  }
}

TEST_P(TriangularTest, ManyRightHandSides) {
  Random random(12);
  for (const int n :
       {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33, 60, 100, 191, 192, 193, 224, 300, 401}) {
    for (const int nrhs : {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 33}) {
      const int ld = n + n % 3;
      const GuardedMatrix l = RandomLower(n, ld, random);
      GuardedMatrix b(n, nrhs, n + nrhs % 4);
      b.FillRandom(random);
      GuardedMatrix forward = b;
      k().forward_solve_many(n, l.data(), ld, nrhs, forward.data(), b.ld());
      for (int c = 0; c < nrhs; ++c) {
        ASSERT_LT(Residual(l, false, &forward(0, c), &b(0, c)), 1e-13) << n << " x " << nrhs;
      }
      EXPECT_TRUE(forward.GuardsIntact());
      GuardedMatrix again = b;
      k().forward_solve_many(n, l.data(), ld, nrhs, again.data(), b.ld());
      EXPECT_TRUE(again.SameBits(forward));
    }
  }
}

TEST_P(TriangularTest, NothingToDo) {
  k().cholesky_solve(0, nullptr, 0, nullptr);
  k().forward_solve_many(0, nullptr, 0, 3, nullptr, 0);
  const double l = 2.0;
  k().forward_solve_many(1, &l, 1, 0, nullptr, 1);
}

TEST_P(TriangularTest, FactorAndSolve) {
  Random random(13);
  for (const int n : {1, 6, 30, 60, 126, 300}) {
    GuardedMatrix a = RandomSpd(n, n, 0.0, random);
    const GuardedMatrix original = a;
    Guarded x(static_cast<size_t>(n));
    x.FillRandom(random);
    Guarded b(static_cast<size_t>(n));
    k().symv_lower(n, original.data(), n, x.data(), b.data());
    ASSERT_EQ(k().cholesky(n, a.data(), n), 0);
    k().cholesky_solve(n, a.data(), n, b.data());
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(b[static_cast<size_t>(i)], x[static_cast<size_t>(i)], 1e-11);
    }
  }
}

}  // namespace
}  // namespace glissade::kernels
