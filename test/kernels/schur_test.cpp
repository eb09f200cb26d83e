// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

class SchurTest : public KernelTest {
 protected:
  /// One landmark of tangent dl on blocks of these dimensions; `gap[a]` rows are left free before
  /// block a.
  void Check(const std::vector<int>& dims, const std::vector<int>& gaps, int dl, Random& random) {
    const int m = static_cast<int>(dims.size());
    std::vector<int32_t> row(dims.size());
    std::vector<int32_t> dim(dims.size());
    int rows = 0;
    int scalars = 0;
    for (size_t a = 0; a < dims.size(); ++a) {
      rows += gaps[a];
      row[a] = rows;
      dim[a] = dims[a];
      rows += dims[a];
      scalars += dims[a] * dl;
    }
    Guarded y(static_cast<size_t>(scalars));
    Guarded w(static_cast<size_t>(scalars));
    y.FillRandom(random);
    w.FillRandom(random);
    GuardedMatrix s(rows, rows, rows + 1);
    s.FillRandom(random);
    GuardedMatrix expected = s;
    size_t ya = 0;
    for (size_t a = 0; a < dims.size(); ++a) {
      size_t wb = 0;
      for (size_t b = 0; b <= a; ++b) {
        for (int r = 0; r < dims[a]; ++r) {
          for (int c = 0; c < dims[b]; ++c) {
            long double p = 0.0;
            for (int i = 0; i < dl; ++i) {
              p += Wide{y[ya + static_cast<size_t>(r * dl + i)]} *
                   w[wb + static_cast<size_t>(c * dl + i)];
            }
            double& x = expected(row[a] + r, row[b] + c);
            x = static_cast<double>(x - p);
          }
        }
        wb += static_cast<size_t>(dims[b] * dl);
      }
      ya += static_cast<size_t>(dims[a] * dl);
    }
    GuardedMatrix result = s;
    k().schur_update(m, row.data(), dim.data(), dl, y.data(), w.data(), result.data(), s.ld());
    for (int c = 0; c < rows; ++c) {
      for (int r = 0; r < rows; ++r) {
        if (expected(r, c) == s(r, c)) {
          ASSERT_EQ(result(r, c), s(r, c)) << "written at " << r << "," << c << " dl " << dl;
        }
        ASSERT_NEAR(result(r, c), expected(r, c), 4e-15) << r << "," << c << " dl " << dl;
      }
    }
    EXPECT_TRUE(result.GuardsIntact() && y.GuardsIntact() && w.GuardsIntact());
    GuardedMatrix again = s;
    k().schur_update(m, row.data(), dim.data(), dl, y.data(), w.data(), again.data(), s.ld());
    EXPECT_TRUE(again.SameBits(result));
  }
};
GLISSADE_INSTANTIATE_KERNEL_TEST(SchurTest);

TEST_P(SchurTest, UniformBlocks) {
  Random random(31);
  for (const int d : {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16}) {
    for (int dl = 1; dl <= 4; ++dl) {
      for (const int m : {1, 2, 3, 5, 8, 20}) {
        Check(std::vector<int>(static_cast<size_t>(m), d),
              std::vector<int>(static_cast<size_t>(m), 0), dl, random);
        std::vector<int> gaps(static_cast<size_t>(m));
        for (int trial = 0; trial < 3; ++trial) {
          for (int& g : gaps)
            g = random.Below(3) == 0 ? d * (1 + random.Below(2)) : 0;
          Check(std::vector<int>(static_cast<size_t>(m), d), gaps, dl, random);
        }
      }
    }
  }
}

TEST_P(SchurTest, MixedBlocks) {
  Random random(32);
  const int kinds[] = {6, 9, 1, 3, 15, 2};
  for (int dl = 1; dl <= 4; ++dl) {
    for (int trial = 0; trial < 40; ++trial) {
      const size_t m = 1 + static_cast<size_t>(random.Below(12));
      std::vector<int> dims(m);
      std::vector<int> gaps(m);
      for (int& d : dims)
        d = kinds[random.Below(6)];
      for (int& g : gaps)
        g = random.Below(2) * random.Below(10);
      Check(dims, gaps, dl, random);
    }
  }
}

TEST_P(SchurTest, RunsLongerThanTheTransposeBuffer) {
  Random random(33);
  for (int dl = 1; dl <= 4; ++dl) {
    Check(std::vector<int>(40, 6), std::vector<int>(40, 0), dl, random);
    Check(std::vector<int>(33, 9), std::vector<int>(33, 0), dl, random);
  }
}

TEST_P(SchurTest, NoBlocks) {
  k().schur_update(0, nullptr, nullptr, 1, nullptr, nullptr, nullptr, 0);
}

TEST_P(SchurTest, SmallInverse) {
  Random random(34);
  for (int n = 1; n <= 4; ++n) {
    for (int trial = 0; trial < 200; ++trial) {
      const size_t size = static_cast<size_t>(n * n);
      const GuardedMatrix a = RandomSpd(n, n, 0.0, random);
      const double scale = std::pow(10.0, 6.0 * random.Uniform());
      Guarded h(size);
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          h[static_cast<size_t>(r * n + c)] = scale * (r >= c ? a(r, c) : a(c, r));
        }
      }
      const Guarded original = h;
      ASSERT_EQ(k().invert_spd_small(n, h.data()), 0);
      EXPECT_TRUE(h.GuardsIntact());
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          long double s = 0.0;
          for (int i = 0; i < n; ++i) {
            s += Wide{original[static_cast<size_t>(r * n + i)]} * h[static_cast<size_t>(i * n + c)];
          }
          EXPECT_NEAR(static_cast<double>(s), r == c ? 1.0 : 0.0, 1e-13);
          EXPECT_EQ(h[static_cast<size_t>(r * n + c)], h[static_cast<size_t>(c * n + r)]);
        }
      }
      // The upper triangle is not read.
      Guarded lower = original;
      for (int r = 0; r < n; ++r) {
        for (int c = r + 1; c < n; ++c) {
          lower[static_cast<size_t>(r * n + c)] = std::numeric_limits<double>::quiet_NaN();
        }
      }
      ASSERT_EQ(k().invert_spd_small(n, lower.data()), 0);
      EXPECT_TRUE(lower.SameBits(h));
    }
  }
}

TEST_P(SchurTest, SmallInverseRefusesWhatHasNone) {
  const double bad_values[] = {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e-320};
  for (int n = 1; n <= 4; ++n) {
    for (int at = 0; at < n; ++at) {
      for (const double value : bad_values) {
        Guarded h(static_cast<size_t>(n * n));
        for (int r = 0; r < n; ++r) {
          for (int c = 0; c < n; ++c)
            h[static_cast<size_t>(r * n + c)] = r == c ? 2.0 : 0.0;
        }
        h[static_cast<size_t>(at * n + at)] = value;
        const Guarded original = h;
        EXPECT_EQ(k().invert_spd_small(n, h.data()), 1) << "n " << n << " value " << value;
        EXPECT_TRUE(h.SameBits(original));
      }
    }
  }
  double rank_one[4] = {1.0, 2.0, 2.0, 4.0};
  EXPECT_EQ(k().invert_spd_small(2, rank_one), 1);
  EXPECT_EQ(k().invert_spd_small(0, rank_one), 1);
  EXPECT_EQ(k().invert_spd_small(5, rank_one), 1);
}

}  // namespace
}  // namespace glissade::kernels
