// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ProductTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(ProductTest);

TEST_P(ProductTest, DotAndAxpy) {
  Random random(21);
  std::vector<int> sizes = TestSizes();
  sizes.push_back(0);
  for (const int n : sizes) {
    Guarded x(static_cast<size_t>(n));
    Guarded y(static_cast<size_t>(n));
    x.FillRandom(random);
    y.FillRandom(random);
    long double expected = 0.0;
    for (size_t i = 0; i < x.size(); ++i)
      expected += Wide{x[i]} * y[i];
    const double dot = k().dot(n, x.data(), y.data());
    EXPECT_NEAR(dot, static_cast<double>(expected), 1e-15 * (n + 1)) << n;
    EXPECT_EQ(dot, k().dot(n, x.data(), y.data()));

    Guarded z = y;
    k().axpy(n, -0.75, x.data(), z.data());
    for (size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(z[i], y[i] - 0.75 * x[i], 4e-16) << n << " " << i;
    }
    EXPECT_TRUE(z.GuardsIntact());
  }
}

TEST_P(ProductTest, SymmetricMatrixVector) {
  Random random(22);
  for (const int n : TestSizes()) {
    for (const int ld : TestLeadingDimensions(n)) {
      GuardedMatrix a(n, n, ld);
      a.FillRandom(random);
      a.FillUpper(kNan);
      Guarded x(static_cast<size_t>(n));
      x.FillRandom(random);
      Guarded y(static_cast<size_t>(n));
      for (size_t i = 0; i < y.size(); ++i)
        y[i] = kNan;
      k().symv_lower(n, a.data(), ld, x.data(), y.data());
      for (int r = 0; r < n; ++r) {
        long double s = 0.0;
        for (int c = 0; c < n; ++c) {
          s += Wide{r >= c ? a(r, c) : a(c, r)} * x[static_cast<size_t>(c)];
        }
        ASSERT_NEAR(y[static_cast<size_t>(r)], static_cast<double>(s), 1e-15 * (n + 1)) << n;
      }
      EXPECT_TRUE(y.GuardsIntact());
    }
  }
}

TEST_P(ProductTest, SymmetricVectorByColumns) {
  Random random(29);
  for (const int n : {1, 2, 5, 9, 16, 33, 60}) {
    GuardedMatrix a(n, n, n + 3);
    a.FillRandom(random);
    Guarded x(static_cast<size_t>(n)), whole(static_cast<size_t>(n));
    x.FillRandom(random);
    k().symv_lower(n, a.data(), n + 3, x.data(), whole.data());
    // Any cut: the columns up to it, then the matrix behind it.
    for (int cut = 0; cut <= n; ++cut) {
      Guarded y(static_cast<size_t>(n));
      for (size_t i = 0; i < y.size(); ++i)
        y[i] = 0.0;
      k().symv_lower_columns(n, cut, a.data(), n + 3, x.data(), y.data());
      k().symv_lower_columns(n - cut, n - cut, a.data() + cut * (n + 4), n + 3, x.data() + cut,
                             y.data() + cut);
      for (size_t i = 0; i < y.size(); ++i)
        ASSERT_NEAR(y[i], whole[i], 1e-15 * (n + 1)) << n << " cut at " << cut;
      EXPECT_TRUE(y.GuardsIntact());
    }
  }
}

TEST_P(ProductTest, SymmetricRankK) {
  Random random(23);
  for (const int n : {1,  2,  3,  4,  5,  6,  7,  8,  9,  12, 15, 16,  17, 23,
                      24, 25, 31, 33, 47, 49, 60, 70, 95, 96, 97, 130, 200}) {
    for (const int depth : {0, 1, 2, 5, 16, 63, 127, 128, 129, 250}) {
      GuardedMatrix w(n, depth, n + depth % 3);
      w.FillRandom(random);
      GuardedMatrix s(n, n, n + 1);
      s.FillRandom(random);
      s.FillUpper(kNan);
      GuardedMatrix sub = s;
      GuardedMatrix add = s;
      k().syrk_lower_sub(n, depth, w.data(), w.ld(), sub.data(), s.ld());
      k().syrk_lower_add(n, depth, w.data(), w.ld(), add.data(), s.ld());
      for (int c = 0; c < n; ++c) {
        for (int r = c; r < n; ++r) {
          long double p = 0.0;
          for (int i = 0; i < depth; ++i)
            p += Wide{w(r, i)} * w(c, i);
          ASSERT_NEAR(sub(r, c), static_cast<double>(s(r, c) - p), 1e-15 * (depth + 8)) << n;
          ASSERT_NEAR(add(r, c), static_cast<double>(s(r, c) + p), 1e-15 * (depth + 8)) << n;
        }
      }
      EXPECT_TRUE(sub.UpperIs(kNan) && add.UpperIs(kNan));
      EXPECT_TRUE(sub.GuardsIntact() && add.GuardsIntact() && w.GuardsIntact());
      GuardedMatrix again = s;
      k().syrk_lower_sub(n, depth, w.data(), w.ld(), again.data(), s.ld());
      EXPECT_TRUE(again.SameBits(sub));
    }
  }
}

}  // namespace
}  // namespace glissade::kernels
