// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

/// How S is stored.
enum class Storage { kSquare, kColumns, kDiagonal };

class SchurTest : public KernelTest {
 protected:
  /// One landmark of tangent dl on vertices of these dimensions, numbered 0, 2, 4, ...; `gap[a]`
  /// rows are left free before vertex a.
  void Check(const std::vector<int>& dims, const std::vector<int>& gaps, int dl, Random& random) {
    for (const Storage storage : {Storage::kSquare, Storage::kColumns, Storage::kDiagonal})
      Check(storage, dims, gaps, dl, random);
  }

  void Check(Storage storage, const std::vector<int>& dims, const std::vector<int>& gaps, int dl,
             Random& random) {
    const int m = static_cast<int>(dims.size());
    std::vector<int32_t> vertex, row, dim(dims.begin(), dims.end());
    int rows = 0, touched = 0;
    for (size_t a = 0; a < dims.size(); ++a) {
      rows += gaps[a];
      vertex.push_back(static_cast<int32_t>(2 * a));
      row.push_back(rows);
      rows += dims[a];
      touched += dims[a];
    }
    // Block columns, and where the blocks of the landmark are in them.
    std::vector<int64_t> column(2 * dims.size(), -1);
    std::vector<int32_t> stride(2 * dims.size(), -1), place;
    int64_t size = 0;
    for (size_t c = 0; c < dims.size(); ++c) {
      if (storage == Storage::kSquare) {
        column[2 * c] = int64_t{row[c]} * (rows + 1);
        stride[2 * c] = rows + 1;
        place.push_back(row[c]);
        size = int64_t{rows} * (rows + 1);
        continue;
      }
      column[2 * c] = size;
      int32_t height = 0;
      for (size_t a = c; a < dims.size(); ++a) {
        if (storage == Storage::kDiagonal && a > c) break;
        height += gaps[a] > 0 ? gaps[a] : 0;
        place.push_back(storage == Storage::kDiagonal ? 0 : height);
        height += dims[a];
      }
      stride[2 * c] = height + 3;
      size += int64_t{stride[2 * c]} * dims[c];
    }
    const SchurRows at{storage == Storage::kDiagonal ? nullptr : place.data(),
                       storage == Storage::kColumns};

    Guarded w(static_cast<size_t>(touched * dl)), inverse(static_cast<size_t>(dl * dl)),
        b_l(static_cast<size_t>(dl)), x(static_cast<size_t>(rows)), b(static_cast<size_t>(rows)),
        s(static_cast<size_t>(size));
    for (Guarded* g : {&w, &inverse, &b_l, &x, &b, &s})
      g->FillRandom(random);
    for (int i = 0; i < dl; ++i) {
      for (int k = 0; k < i; ++k)
        inverse[static_cast<size_t>(i * dl + k)] = inverse[static_cast<size_t>(k * dl + i)];
    }
    const SchurLandmark landmark{m,          dl,       vertex.data(),  row.data(),
                                 dim.data(), w.data(), inverse.data(), b_l.data()};

    // Y = W H^-1, then every block.
    std::vector<Wide> y(w.size());
    for (int r = 0; r < touched; ++r) {
      for (int k = 0; k < dl; ++k) {
        for (int i = 0; i < dl; ++i) {
          y[static_cast<size_t>(r * dl + k)] +=
              Wide{w[static_cast<size_t>(r * dl + i)]} * inverse[static_cast<size_t>(i * dl + k)];
        }
      }
    }
    Guarded s_expected = s, b_expected = b, product = x, product_expected = x;
    std::vector<Wide> Wx(static_cast<size_t>(dl));
    size_t packed = 0, yc = 0;
    for (size_t c = 0; c < dims.size(); ++c) {
      size_t wa = yc;
      for (size_t a = c; a < dims.size(); ++a, ++packed) {
        const int32_t first = storage == Storage::kSquare    ? row[a]
                              : storage == Storage::kColumns ? place[packed]
                                                             : 0;
        for (int r = 0; r < dims[a] && (storage != Storage::kDiagonal || a == c); ++r) {
          for (int i = 0; i < dims[c]; ++i) {
            Wide p = 0.0;
            for (int k = 0; k < dl; ++k)
              p += Wide{w[wa + static_cast<size_t>(r * dl + k)]} *
                   y[yc + static_cast<size_t>(i * dl + k)];
            double& to = s_expected[static_cast<size_t>(column[2 * c] + first + r +
                                                        int64_t{i} * stride[2 * c])];
            to = static_cast<double>(to - p);
          }
        }
        wa += static_cast<size_t>(dims[a] * dl);
      }
      for (int i = 0; i < dims[c]; ++i) {
        Wide p = 0.0;
        for (int k = 0; k < dl; ++k) {
          p += y[yc + static_cast<size_t>(i * dl + k)] * b_l[static_cast<size_t>(k)];
          Wx[static_cast<size_t>(k)] +=
              Wide{w[yc + static_cast<size_t>(i * dl + k)]} * x[static_cast<size_t>(row[c] + i)];
        }
        double& to = b_expected[static_cast<size_t>(row[c] + i)];
        to = static_cast<double>(to - p);
      }
      yc += static_cast<size_t>(dims[c] * dl);
    }

    // In one go, and block columns range by range, in any order.
    Guarded scratch(static_cast<size_t>(SchurScratch(touched)));
    Guarded s_whole = s, b_whole = b;
    SchurTarget target{s_whole.data(), b_whole.data(), column.data(), stride.data()};
    k().schur_update(&landmark, at, 0, m, &target, scratch.data());
    for (size_t i = 0; i < s.size(); ++i) {
      if (s_expected[i] == s[i]) {
        ASSERT_EQ(s_whole[i], s[i]) << "written at " << i << " dl " << dl;
      }
      ASSERT_NEAR(s_whole[i], s_expected[i], 2e-14) << i << " dl " << dl;
    }
    for (size_t i = 0; i < b.size(); ++i)
      ASSERT_NEAR(b_whole[i], b_expected[i], 2e-14);
    Guarded s_parts = s, b_parts = b;
    target = {s_parts.data(), b_parts.data(), column.data(), stride.data()};
    const int cut = random.Below(m + 1);
    k().schur_update(&landmark, at, cut, m, &target, scratch.data());
    k().schur_update(&landmark, at, 0, cut, &target, scratch.data());
    EXPECT_TRUE(s_parts.SameBits(s_whole) && b_parts.SameBits(b_whole));
    EXPECT_TRUE(scratch.GuardsIntact() && w.GuardsIntact());

    // The same without S: products, and the landmark's own step.
    Guarded step(static_cast<size_t>(dl));
    k().landmark_step(&landmark, x.data(), step.data());
    for (int i = 0; i < dl; ++i) {
      Wide expected = 0.0;
      for (int k2 = 0; k2 < dl; ++k2) {
        expected += Wide{inverse[static_cast<size_t>(i * dl + k2)]} *
                    (b_l[static_cast<size_t>(k2)] - Wx[static_cast<size_t>(k2)]);
      }
      ASSERT_NEAR(step[static_cast<size_t>(i)], static_cast<double>(expected), 2e-13);
    }
    k().schur_multiply(&landmark, x.data(), product.data());
    size_t at_y = 0;
    for (size_t c = 0; c < dims.size(); ++c) {
      for (int i = 0; i < dims[c]; ++i) {
        Wide p = 0.0;
        for (int k2 = 0; k2 < dl; ++k2)
          p += y[at_y++] * Wx[static_cast<size_t>(k2)];
        double& to = product_expected[static_cast<size_t>(row[c] + i)];
        to = static_cast<double>(to - p);
      }
    }
    for (size_t i = 0; i < product.size(); ++i)
      ASSERT_NEAR(product[i], product_expected[i], 2e-13) << i << " dl " << dl;
    EXPECT_TRUE(step.GuardsIntact() && product.GuardsIntact());
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

TEST_P(SchurTest, LongRuns) {
  Random random(33);
  for (int dl = 1; dl <= 4; ++dl) {
    Check(std::vector<int>(40, 6), std::vector<int>(40, 0), dl, random);
    Check(std::vector<int>(33, 9), std::vector<int>(33, 0), dl, random);
  }
}

TEST_P(SchurTest, NoBlocks) {
  const SchurLandmark landmark{};
  const SchurTarget target{};
  k().schur_update(&landmark, {}, 0, 0, &target, nullptr);
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
