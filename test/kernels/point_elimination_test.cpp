// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Groups of points in the world: factors of H_ll, panels and products, against loops.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

class PointEliminationTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(PointEliminationTest);

void Cross(const double* a, const double* b, double* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/// A group of points with positive definite H_ll.
struct Group {
  static constexpr int kUsed = 21, kLanes = 24, kTargets = 4, kRows = 1 + 6 * kTargets,
                       kStride = 32;
  static constexpr int used[kTargets] = {21, 15, 9, 2}, lanes[kTargets] = {24, 16, 16, 8};
  std::vector<Guarded> F;
  TwistTarget targets[kTargets];
  Guarded X{I(3 * kLanes)}, h{I(6 * kLanes)}, b{I(3 * kLanes)};
  TwistGroup group{};

  explicit Group(uint64_t seed) {
    Random random(seed);
    X.FillRandom(random);
    b.FillRandom(random);
    std::fill_n(h.data(), h.size(), 0.0);
    F.reserve(kTargets);
    for (int t = 0; t < kTargets; ++t) {
      F.emplace_back(I(6 * lanes[t]));
      std::fill_n(F.back().data(), F.back().size(), 0.0);
      for (int s = 0; s < used[t]; ++s) {
        double sum[6] = {};
        for (int row = 0; row < 3; ++row) {
          const double f[3] = {random.Uniform(), random.Uniform(), random.Uniform()};
          for (int i = 0, term = 0; i < 3; ++i) {
            for (int j = 0; j <= i; ++j, ++term)
              sum[term] += f[i] * f[j];
          }
        }
        for (int i = 0; i < 6; ++i) {
          F.back()[I(i * lanes[t] + s)] = sum[i];
          h[I(i * kLanes + s)] += sum[i];
        }
      }
      targets[t] = {used[t], lanes[t], F.back().data()};
    }
    group = {3, kUsed, kLanes, kTargets, targets, X.data()};
  }
  Group(const Group&) = delete;

  /// Row of W (6 per target) of a lane, three numbers.
  void RowOfW(int row, int s, double* w) const {
    const int t = row / 6, r = row % 6;
    std::fill_n(w, 3, 0.0);
    if (s >= used[t]) return;
    double full[3][3];
    for (int i = 0, term = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++term)
        full[i][j] = full[j][i] = F[I(t)][I(term * lanes[t] + s)];
    }
    const double x[3] = {X[I(s)], X[I(kLanes + s)], X[I(2 * kLanes + s)]};
    for (int j = 0; j < 3; ++j) {
      double q[3];
      Cross(x, full[j], q);
      w[j] = r < 3 ? -full[r][j] : -q[r - 3];
    }
  }
};
constexpr int Group::used[];
constexpr int Group::lanes[];

TEST_P(PointEliminationTest, FactorsAreThoseOfTheDampedBlocks) {
  const Group g(7);
  for (const double lambda : {0.0, 0.3}) {
    Guarded C(I(6 * Group::kLanes)), beta(I(3 * Group::kLanes));
    ASSERT_EQ(k().landmark_pivots(&g.group, g.h.data(), g.b.data(), lambda, 0.8, 2.0, C.data(),
                                  beta.data()),
              -1);
    for (int s = 0; s < Group::kUsed; ++s) {
      double H[3][3], c[3][3] = {};
      for (int i = 0, term = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j, ++term) {
          H[i][j] = H[j][i] = g.h[I(term * Group::kLanes + s)];
          c[i][j] = C[I(term * Group::kLanes + s)];
        }
        H[i][i] += lambda * std::clamp(H[i][i], 0.8, 2.0);
      }
      for (int i = 0; i < 3; ++i) {
        double of_b = 0.0;
        for (int j = 0; j < 3; ++j) {
          of_b += c[i][j] * g.b[I(j * Group::kLanes + s)];
          // C H C' = I.
          double product = 0.0;
          for (int m = 0; m < 3; ++m) {
            for (int n = 0; n < 3; ++n)
              product += c[i][m] * H[m][n] * c[j][n];
          }
          ASSERT_NEAR(product, i == j ? 1.0 : 0.0, 1e-10) << s;
        }
        ASSERT_NEAR(beta[I(i * Group::kLanes + s)], of_b, 1e-10 * (1.0 + std::abs(of_b)));
      }
    }
    EXPECT_TRUE(C.GuardsIntact() && beta.GuardsIntact());
  }
}

TEST_P(PointEliminationTest, LandmarksThatHaveNoFactorAreTold) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int lane : {0, 5, 20}) {
    for (const double bad : {-1.0, 0.0, infinity, nan}) {
      for (const int entry : {0, 2, 5}) {
        Group g(8);
        g.h[I(entry * Group::kLanes + lane)] = bad;
        Guarded C(I(6 * Group::kLanes)), beta(I(3 * Group::kLanes));
        EXPECT_EQ(k().landmark_pivots(&g.group, g.h.data(), g.b.data(), 0.0, 1.0, 1.0, C.data(),
                                      beta.data()),
                  lane)
            << bad << " " << entry;
      }
    }
  }
}

TEST_P(PointEliminationTest, PanelAndProductsAreThoseOfW) {
  const Group g(9);
  Random random(10);
  Guarded C(I(6 * Group::kLanes)), beta(I(3 * Group::kLanes));
  ASSERT_EQ(
      k().landmark_pivots(&g.group, g.h.data(), g.b.data(), 0.1, 1.0, 1.0, C.data(), beta.data()),
      -1);
  // What is not written is not read.
  Guarded panel(I(3 * Group::kLanes * Group::kStride)), reduced(I(Group::kStride * Group::kStride));
  for (size_t i = 0; i < panel.size(); ++i)
    panel[i] = std::numeric_limits<double>::quiet_NaN();
  k().twist_panel(&g.group, C.data(), beta.data(), panel.data());
  k().twist_reduce(&g.group, panel.data(), reduced.data());
  // [beta'; W C'] by loops.
  std::vector<double> Z(I(Group::kRows * 3 * Group::kUsed));
  const auto z = [&](int row, int column) -> double& {
    return Z[I(row * 3 * Group::kUsed + column)];
  };
  for (int s = 0; s < Group::kUsed; ++s) {
    for (int m = 0; m < 3; ++m) {
      z(0, 3 * s + m) = beta[I(m * Group::kLanes + s)];
      for (int row = 1; row < Group::kRows; ++row) {
        double w[3], sum = 0.0;
        g.RowOfW(row - 1, s, w);
        for (int i = 0; i <= m; ++i)
          sum += w[i] * C[I((m * (m + 1) / 2 + i) * Group::kLanes + s)];
        z(row, 3 * s + m) = sum;
        if (s < Group::used[(row - 1) / 6]) {
          ASSERT_NEAR(panel[I(row + (3 * s + m) * Group::kStride)], sum,
                      1e-12 * (1.0 + std::abs(sum)));
        }
      }
    }
  }
  for (int c = 0; c < Group::kRows; ++c) {
    for (int r = c; r < Group::kRows; ++r) {
      double sum = 0.0, scale = 1.0;
      for (int i = 0; i < 3 * Group::kUsed; ++i) {
        sum += z(r, i) * z(c, i);
        scale += std::abs(z(r, i) * z(c, i));
      }
      ASSERT_NEAR(reduced[I(r + c * Group::kStride)], -sum, 1e-12 * scale) << r << " " << c;
    }
  }
  EXPECT_TRUE(panel.GuardsIntact() && reduced.GuardsIntact());

  const Guarded twists = Numbers(6 * Group::kTargets, random);
  Guarded product(I(3 * Group::kLanes)), sums(I(6 * Group::kTargets)), u(I(3 * Group::kLanes));
  Guarded step(I(3 * Group::kLanes));
  u.FillRandom(random);
  k().twist_transpose_product(&g.group, twists.data(), product.data());
  k().twist_product(&g.group, u.data(), sums.data());
  k().landmark_steps(&g.group, C.data(), g.b.data(), product.data(), step.data());
  std::vector<double> expected(I(6 * Group::kTargets));
  for (int s = 0; s < Group::kUsed; ++s) {
    double of_twists[3] = {};
    for (int row = 0; row < 6 * Group::kTargets; ++row) {
      double w[3];
      g.RowOfW(row, s, w);
      for (int i = 0; i < 3; ++i) {
        of_twists[i] += w[i] * twists[I(row)];
        expected[I(row)] += w[i] * u[I(i * Group::kLanes + s)];
      }
    }
    // (H + damping) step = b - product, by C H C' = I: step = C' C (b - product).
    double half[3] = {};
    const auto c = [&](int i, int j) { return C[I((i * (i + 1) / 2 + j) * Group::kLanes + s)]; };
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(product[I(i * Group::kLanes + s)], of_twists[i], 1e-12);
      for (int j = 0; j <= i; ++j)
        half[i] += c(i, j) * (g.b[I(j * Group::kLanes + s)] - of_twists[j]);
    }
    for (int i = 0; i < 3; ++i) {
      double sum = 0.0;
      for (int j = i; j < 3; ++j)
        sum += c(j, i) * half[j];
      ASSERT_NEAR(step[I(i * Group::kLanes + s)], sum, 1e-10 * (1.0 + std::abs(sum)));
    }
  }
  for (int i = 0; i < 6 * Group::kTargets; ++i)
    EXPECT_NEAR(sums[I(i)], expected[I(i)], 1e-11) << i;
  EXPECT_TRUE(product.GuardsIntact() && sums.GuardsIntact() && step.GuardsIntact());
}

}  // namespace
}  // namespace glissade::kernels
