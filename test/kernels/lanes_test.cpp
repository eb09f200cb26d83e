// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs of edges in lanes against loops over one edge at a time.

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

size_t At(int row, int cols, int col, int lanes, int lane) {
  return static_cast<size_t>((row * cols + col) * lanes + lane);
}

class LanesTest : public KernelTest {
 protected:
  static Guarded Lanes(int rows, int cols, int lanes, Random& random) {
    Guarded x(static_cast<size_t>(rows * cols * lanes));
    x.FillRandom(random);
    return x;
  }
};
GLISSADE_INSTANTIATE_KERNEL_TEST(LanesTest);

TEST_P(LanesTest, ProductsAreThoseOfLoops) {
  Random random(1);
  for (const int rows : {1, 2, 3, 6}) {
    for (const int lanes : {8, 24, 64}) {
      for (const int dim_a : {1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 17}) {
        for (const int dim_b : {0, 1, 2, 3, 4, 6, 9}) {  // 0: with itself
          const Guarded a = Lanes(rows, dim_a, lanes, random);
          const int cols = dim_b > 0 ? dim_b : dim_a;
          const Guarded b = dim_b > 0 ? Lanes(rows, dim_b, lanes, random) : a;
          Guarded out = Lanes(dim_a, cols, 1, random);
          const Guarded before = out;
          k().lane_products(rows, lanes, dim_a, a.data(), cols, dim_b > 0 ? b.data() : a.data(),
                            -0.5, out.data());
          for (int i = 0; i < dim_a; ++i) {
            for (int j = 0; j < cols; ++j) {
              Wide sum = 0.0;
              for (int r = 0; r < rows; ++r) {
                for (int s = 0; s < lanes; ++s)
                  sum += Wide{a[At(r, dim_a, i, lanes, s)]} * b[At(r, cols, j, lanes, s)];
              }
              const size_t at = static_cast<size_t>(i * cols + j);
              ASSERT_NEAR(out[at], static_cast<double>(before[at] - 0.5L * sum), 1e-12)
                  << rows << " rows, " << lanes << " lanes, " << dim_a << " x " << dim_b;
            }
          }
          ASSERT_TRUE(out.GuardsIntact());
        }
      }
    }
  }
}

TEST_P(LanesTest, CouplingsGoWhereTheirLaneSays) {
  Random random(2);
  for (const int rows : {1, 2, 3, 6}) {
    for (const int count : {1, 7, 8, 19, 64}) {
      const int lanes = (count + 7) / 8 * 8;
      for (const int dim_a : {1, 2, 3, 6, 9, 15, 17, 33}) {
        for (const int dim_b : {1, 2, 3, 4}) {
          const Guarded a = Lanes(rows, dim_a, lanes, random);
          const Guarded b = Lanes(rows, dim_b, lanes, random);
          const int size = dim_a * dim_b;
          // Two lanes share a place; the first ones are last in memory.
          std::vector<int64_t> offset(static_cast<size_t>(lanes));
          for (int s = 0; s < lanes; ++s)
            offset[static_cast<size_t>(s)] = int64_t{size} * (lanes - 1 - s / 2);
          Guarded base = Lanes(lanes, size, 1, random);
          Guarded expected = base, set = base;
          k().lane_couplings(rows, lanes, count, dim_a, a.data(), dim_b, b.data(), offset.data(),
                             false, base.data());
          k().lane_couplings(rows, lanes, count, dim_a, a.data(), dim_b, b.data(), offset.data(),
                             true, set.data());
          for (int s = 0; s < count; ++s) {
            for (int i = 0; i < dim_a; ++i) {
              for (int j = 0; j < dim_b; ++j) {
                double sum = 0.0;
                for (int r = 0; r < rows; ++r)
                  sum += a[At(r, dim_a, i, lanes, s)] * b[At(r, dim_b, j, lanes, s)];
                const size_t to =
                    static_cast<size_t>(offset[static_cast<size_t>(s)] + i * dim_b + j);
                expected[to] += sum;
                // The second lane of a place is the one that stays.
                if (s % 2 == 1 || s == count - 1) {
                  ASSERT_NEAR(set[to], sum, 1e-14);
                }
              }
            }
          }
          for (size_t i = 0; i < static_cast<size_t>(size * lanes); ++i)
            ASSERT_NEAR(base[i], expected[i], 1e-14) << dim_a << " x " << dim_b << " at " << i;
          ASSERT_TRUE(base.GuardsIntact() && set.GuardsIntact());
        }
      }
    }
  }
}

TEST_P(LanesTest, LandmarksGetTheirBlockAndRightHandSide) {
  Random random(9);
  for (const int rows : {1, 2, 3, 6}) {
    for (const int count : {1, 7, 8, 19, 64}) {
      const int lanes = (count + 7) / 8 * 8;
      for (int dl = 1; dl <= 4; ++dl) {
        const Guarded J = Lanes(rows, dl, lanes, random), r = Lanes(rows, 1, lanes, random);
        const int size = dl * dl + dl;
        std::vector<int64_t> offset(static_cast<size_t>(lanes));
        for (int s = 0; s < lanes; ++s)
          offset[static_cast<size_t>(s)] = int64_t{size} * (s / 2);
        Guarded base = Lanes(lanes, size, 1, random);
        Guarded expected = base;
        k().lane_landmarks(rows, lanes, count, dl, J.data(), r.data(), offset.data(), base.data());
        for (int s = 0; s < count; ++s) {
          double* const to = expected.data() + offset[static_cast<size_t>(s)];
          for (int k = 0; k < rows; ++k) {
            for (int i = 0; i < dl; ++i) {
              const double J_i = J[At(k, dl, i, lanes, s)];
              for (int j = 0; j < dl; ++j)
                to[i * dl + j] += J_i * J[At(k, dl, j, lanes, s)];
              to[dl * dl + i] -= J_i * r[At(k, 1, 0, lanes, s)];
            }
          }
        }
        for (size_t i = 0; i < static_cast<size_t>(size * lanes); ++i)
          ASSERT_NEAR(base[i], expected[i], 1e-14) << "dl " << dl << " at " << i;
        ASSERT_TRUE(base.GuardsIntact());
      }
    }
  }
}

TEST_P(LanesTest, WhitensWithOneMatrixOrOneALane) {
  Random random(3);
  for (const int rows : {1, 2, 3, 4, 6}) {
    for (const int cols : {1, 3, 6}) {
      for (const int per_lane : {0, 1}) {
        const int lanes = 24;
        Guarded x = Lanes(rows, cols, lanes, random);
        const Guarded l = Lanes(rows, rows, per_lane != 0 ? lanes : 1, random);
        Guarded work = Lanes(rows, 1, lanes, random);
        const Guarded before = x;
        k().whiten_lanes(rows, cols, lanes, l.data(), per_lane, x.data(), work.data());
        for (int s = 0; s < lanes; ++s) {
          for (int r = 0; r < rows; ++r) {
            for (int c = 0; c < cols; ++c) {
              double sum = 0.0;
              for (int m = 0; m < rows; ++m) {
                sum += (per_lane != 0 ? l[At(r, rows, m, lanes, s)]
                                      : l[static_cast<size_t>(r * rows + m)]) *
                       before[At(m, cols, c, lanes, s)];
              }
              ASSERT_NEAR(x[At(r, cols, c, lanes, s)], sum, 1e-14);
            }
          }
        }
        ASSERT_TRUE(x.GuardsIntact() && work.GuardsIntact());
      }
    }
  }
}

TEST_P(LanesTest, CorrectsJacobiansAndScalesResiduals) {
  Random random(4);
  const int rows = 3, cols = 4, lanes = 16;
  Guarded r = Lanes(rows, 1, lanes, random);
  Guarded J = Lanes(rows, cols, lanes, random);
  const Guarded scale = Lanes(1, 1, lanes, random), alpha = Lanes(1, 1, lanes, random);
  Guarded squares = Lanes(1, 1, lanes, random);
  const double total = k().lane_squares(rows, lanes, 1.0, nullptr, r.data(), squares.data());
  const Guarded J_before = J, r_before = r;
  k().correct_lanes(rows, cols, lanes, r.data(), scale.data(), alpha.data(), J.data());
  k().scale_lanes(rows, lanes, scale.data(), r.data());
  double expected_total = 0.0;
  for (int s = 0; s < lanes; ++s) {
    const auto lane = static_cast<size_t>(s);
    double square = 0.0;
    for (int i = 0; i < rows; ++i)
      square += r_before[At(i, 1, 0, lanes, s)] * r_before[At(i, 1, 0, lanes, s)];
    expected_total += square;
    EXPECT_NEAR(squares[lane], square, 1e-15);
    for (int c = 0; c < cols; ++c) {
      double projection = 0.0;
      for (int i = 0; i < rows; ++i)
        projection += r_before[At(i, 1, 0, lanes, s)] * J_before[At(i, cols, c, lanes, s)];
      for (int i = 0; i < rows; ++i) {
        EXPECT_NEAR(J[At(i, cols, c, lanes, s)],
                    scale[lane] * (J_before[At(i, cols, c, lanes, s)] -
                                   alpha[lane] * projection * r_before[At(i, 1, 0, lanes, s)]),
                    1e-14);
      }
    }
    for (int i = 0; i < rows; ++i)
      EXPECT_EQ(r[At(i, 1, 0, lanes, s)], scale[lane] * r_before[At(i, 1, 0, lanes, s)]);
  }
  EXPECT_NEAR(total, expected_total, 1e-13);
  EXPECT_TRUE(J.GuardsIntact() && r.GuardsIntact() && squares.GuardsIntact());
}

TEST_P(LanesTest, SeesWhatIsNotFinite) {
  Random random(5);
  for (const int count : {8, 24, 40, 136}) {
    Guarded x = Lanes(count, 1, 1, random);
    EXPECT_EQ(k().lanes_finite(count, x.data()), 1);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
      for (int i = 0; i < count; ++i) {
        const double good = x[static_cast<size_t>(i)];
        x[static_cast<size_t>(i)] = bad;
        ASSERT_EQ(k().lanes_finite(count, x.data()), 0) << i << " of " << count;
        x[static_cast<size_t>(i)] = good;
      }
    }
  }
}

}  // namespace
}  // namespace glissade::kernels
