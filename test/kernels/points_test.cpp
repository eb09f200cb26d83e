// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points in the world, poses as twists, against loops over one row at a time.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

class PointsTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(PointsTest);

/// F += f f', g -= r f.
void AddRow(const double* f, double r, double* F, double* g) {
  for (int i = 0, term = 0; i < 3; ++i) {
    g[i] -= r * f[i];
    for (int j = 0; j <= i; ++j, ++term)
      F[term] += f[i] * f[j];
  }
}

TEST_P(PointsTest, SumsAreThoseOfLoops) {
  Random random(1);
  for (const int rows : {1, 2, 3}) {
    for (const int variant : {0, 1, 2, 3, 4, 5, 6, 7}) {
      const bool turned = (variant & 1) != 0, weighted = (variant & 2) != 0;
      const bool sets = (variant & 4) != 0;
      const int lanes = 24, stride = 32;
      const Guarded r = Numbers(rows * lanes, random), J = Numbers(3 * rows * lanes, random);
      const Guarded weight = Numbers(lanes, random), turn = Numbers(9, random);
      Guarded F = Numbers(6 * stride, random), g = Numbers(3 * stride, random);
      const Guarded F0 = F, g0 = g;
      TwistRun run{};
      run.rows = rows;
      run.lanes = lanes;
      run.r = r.data();
      run.J_l = J.data();
      run.scale = 0.7;
      run.weight = weighted ? weight.data() : nullptr;
      const PointTotals to{F.data(), g.data(), stride, sets, turned ? turn.data() : nullptr};
      ASSERT_EQ(k().point_sums(&run, &to), 1);
      for (int s = 0; s < lanes; ++s) {
        double F_s[6] = {}, g_s[3] = {};
        for (int row = 0; row < rows; ++row) {
          const double w = weighted ? weight[I(s)] : 1.0;
          double x[3], f[3];
          for (int i = 0; i < 3; ++i)
            f[i] = x[i] = 0.7 * w * J[I((3 * row + i) * lanes + s)];
          for (int i = 0; i < 3 && turned; ++i)
            f[i] = turn[I(3 * i)] * x[0] + turn[I(3 * i + 1)] * x[1] + turn[I(3 * i + 2)] * x[2];
          AddRow(f, w * r[I(row * lanes + s)], F_s, g_s);
        }
        for (int i = 0; i < 6; ++i) {
          const size_t at = I(i * stride + s);
          ASSERT_NEAR(F[at], F_s[i] + (sets ? 0.0 : F0[at]), 1e-13);
        }
        for (int i = 0; i < 3; ++i) {
          const size_t at = I(i * stride + s);
          ASSERT_NEAR(g[at], g_s[i] + (sets ? 0.0 : g0[at]), 1e-13);
        }
      }
      for (int s = lanes; s < stride; ++s)
        ASSERT_EQ(F[I(s)], F0[I(s)]);
      ASSERT_TRUE(F.GuardsIntact() && g.GuardsIntact());
    }
  }
}

/// Observations of points before a camera, some of which do not count.
struct Scene {
  static constexpr int kLanes = 40, kStride = 48;
  TwoViewCamera camera{};
  Guarded X{I(3 * kStride)}, uv{I(2 * kLanes)}, mask{I(kLanes)}, width{I(kLanes)}, turn{9};

  explicit Scene(uint64_t seed) {
    Random random(seed);
    // A rotation by 0.6 about z, then one by 0.3 about x.
    const double c = std::cos(0.6), s = std::sin(0.6), d = std::cos(0.3), e = std::sin(0.3);
    const double R[9] = {c, -s, 0.0, d * s, d * c, -e, e * s, e * c, d};
    std::copy_n(R, 9, camera.R_wc);
    turn.FillRandom(random);
    for (double& x : camera.c)
      x = random.Uniform();
    for (int lane = 0; lane < kLanes; ++lane) {
      const double q[3] = {random.Uniform(), random.Uniform(), 3.0 + random.Uniform()};
      for (int i = 0; i < 3; ++i) {
        X[I(i * kStride + lane)] =
            camera.c[i] + R[3 * i] * q[0] + R[3 * i + 1] * q[1] + R[3 * i + 2] * q[2];
      }
      uv[I(lane)] = q[0] / q[2] + 0.01 * random.Uniform();
      uv[I(kLanes + lane)] = q[1] / q[2] + 0.01 * random.Uniform();
      mask[I(lane)] = lane % 5 == 3 ? 0.0 : 1.0;
      width[I(lane)] = lane % 4 == 1 ? std::numeric_limits<double>::infinity() : 0.5;
    }
  }
  [[nodiscard]] PointViewRun Run(bool masked) const {
    return {kLanes, uv.data(), X.data(), kStride, masked ? mask.data() : nullptr, &camera};
  }
};

TEST_P(PointsTest, ViewsInOnePassAreThoseOfTheirValues) {
  constexpr int kLanes = Scene::kLanes;
  const Scene scene(2);
  for (const bool masked : {false, true}) {
    for (const LaneLoss loss :
         {LaneLoss::kNone, LaneLoss::kHuber, LaneLoss::kCauchy, LaneLoss::kTukey}) {
      for (const bool sets : {false, true}) {
        const PointViewRun run = scene.Run(masked);
        const TwoViewWeights weights{{100.0, 80.0}, loss, scene.width.data()};
        Random random(3);
        Guarded F = Numbers(6 * kLanes, random), g = Numbers(3 * kLanes, random);
        Guarded F_other = F, g_other = g;
        double cost = -1.0;
        const PointTotals to{F.data(), g.data(), kLanes, sets, scene.turn.data()};
        ASSERT_EQ(k().point_view_sums(&run, &weights, &to, &cost), 1);

        Guarded r(I(2 * kLanes)), J(I(6 * kLanes)), squares(I(kLanes)), factor(I(kLanes));
        double expected = 0.0;
        for (int s = 0; s < kLanes; ++s) {
          double q[3] = {};
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
              q[i] += scene.camera.R_wc[3 * j + i] *
                      (scene.X[I(j * Scene::kStride + s)] - scene.camera.c[j]);
            }
          }
          const double u = q[0] / q[2], v = q[1] / q[2];
          r[I(s)] = 100.0 * (u - scene.uv[I(s)]);
          r[I(kLanes + s)] = 80.0 * (v - scene.uv[I(kLanes + s)]);
          const double f[2][3] = {{1.0 / q[2], 0.0, -u / q[2]}, {0.0, 1.0 / q[2], -v / q[2]}};
          for (int row = 0; row < 2; ++row) {
            for (int i = 0; i < 3; ++i)
              J[I((3 * row + i) * kLanes + s)] = weights.scale[row] * f[row][i];
          }
          const double counts = masked ? scene.mask[I(s)] : 1.0;
          squares[I(s)] = counts * (r[I(s)] * r[I(s)] + r[I(kLanes + s)] * r[I(kLanes + s)]);
          expected += 0.5 * squares[I(s)];
          factor[I(s)] = 1.0;
        }
        if (loss != LaneLoss::kNone) {
          expected =
              k().loss_lanes(loss, kLanes, squares.data(), scene.width.data(), factor.data());
        }
        for (int s = 0; s < kLanes && masked; ++s)
          factor[I(s)] *= scene.mask[I(s)];
        TwistRun same{2, kLanes, r.data(), J.data(), nullptr, 1.0, factor.data()};
        const PointTotals to_other{F_other.data(), g_other.data(), kLanes, sets, scene.turn.data()};
        ASSERT_EQ(k().point_sums(&same, &to_other), 1);
        EXPECT_NEAR(cost, expected, 1e-12 * expected);
        EXPECT_EQ(k().point_view_cost(&run, &weights), cost)
            << "costs are compared to the last bit";
        for (int i = 0; i < 6 * kLanes; ++i)
          ASSERT_NEAR(F[I(i)], F_other[I(i)], 1e-9) << i;
        for (int i = 0; i < 3 * kLanes; ++i)
          ASSERT_NEAR(g[I(i)], g_other[I(i)], 1e-9) << i;
        EXPECT_TRUE(F.GuardsIntact() && g.GuardsIntact());
      }
    }
  }
}

TEST_P(PointsTest, WhatIsNotFiniteIsSaid) {
  Scene scene(4);
  const TwoViewWeights weights{{1.0, 1.0}, LaneLoss::kCauchy, scene.width.data()};
  Guarded F(I(6 * Scene::kLanes)), g(I(3 * Scene::kLanes));
  const PointTotals to{F.data(), g.data(), Scene::kLanes, true, scene.turn.data()};
  const PointViewRun run = scene.Run(true);
  double cost = 0.0;
  for (int s = 0; s < Scene::kLanes; ++s) {
    const bool counts = scene.mask[I(s)] != 0.0;
    for (int i = 0; i < 3; ++i) {
      double& x = scene.X[I(i * Scene::kStride + s)];
      const double good = x;
      x = std::numeric_limits<double>::quiet_NaN();
      EXPECT_EQ(k().point_view_sums(&run, &weights, &to, &cost), counts ? 0 : 1) << s;
      EXPECT_EQ(std::isfinite(k().point_view_cost(&run, &weights)), !counts) << s;
      x = good;
    }
    // At the camera: z = 0.
    double at[3];
    for (int i = 0; i < 3; ++i) {
      at[i] = scene.X[I(i * Scene::kStride + s)];
      scene.X[I(i * Scene::kStride + s)] = scene.camera.c[i];
    }
    EXPECT_EQ(k().point_view_sums(&run, &weights, &to, &cost), counts ? 0 : 1) << s;
    for (int i = 0; i < 3; ++i)
      scene.X[I(i * Scene::kStride + s)] = at[i];
  }
  Random random(5);
  Guarded r = Numbers(16, random), J = Numbers(48, random);
  const TwistRun rows{2, 8, r.data(), J.data(), nullptr, 1.0, nullptr};
  for (Guarded* numbers : {&r, &J}) {
    for (size_t i = 0; i < numbers->size(); ++i) {
      const double good = (*numbers)[i];
      (*numbers)[i] = std::numeric_limits<double>::infinity();
      EXPECT_EQ(k().point_sums(&rows, &to), 0) << i;
      (*numbers)[i] = good;
    }
  }
  EXPECT_EQ(k().point_sums(&rows, &to), 1);
}

TEST_P(PointsTest, FrameSumsAreThoseOfLoops) {
  Random random(6);
  const int lanes = 16, stride = 24;
  const Guarded F = Numbers(6 * lanes, random), g = Numbers(3 * lanes, random);
  const Guarded X = Numbers(3 * stride, random);
  Guarded h = Numbers(6 * stride, random), b = Numbers(3 * stride, random);
  Guarded sums = Numbers(kTwistSums, random);
  const Guarded h0 = h, b0 = b, sums0 = sums;
  const PointFrame frame{lanes,    F.data(), g.data(), X.data(),
                         h.data(), b.data(), stride,   sums.data()};
  ASSERT_EQ(k().point_frame_sums(&frame), 1);
  double expected[27] = {};
  for (int s = 0; s < lanes; ++s) {
    const double x[3] = {X[I(s)], X[I(stride + s)], X[I(2 * stride + s)]};
    // [f; X x f] of the columns of F, and of their moments.
    double T[6][3] = {{1, 0, 0},        {0, 1, 0},        {0, 0, 1},
                      {0, -x[2], x[1]}, {x[2], 0, -x[0]}, {-x[1], x[0], 0}};
    double full[3][3];
    for (int i = 0, term = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++term) {
        full[i][j] = full[j][i] = F[I(term * lanes + s)];
        ASSERT_NEAR(h[I(term * stride + s)], h0[I(term * stride + s)] + full[i][j], 1e-14);
      }
      ASSERT_NEAR(b[I(i * stride + s)], b0[I(i * stride + s)] + g[I(i * lanes + s)], 1e-14);
    }
    for (int r = 0, term = 0; r < 6; ++r) {
      for (int i = 0; i < 3; ++i)
        expected[21 + r] -= T[r][i] * g[I(i * lanes + s)];
      for (int c = 0; c <= r; ++c, ++term) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j)
            expected[term] += T[r][i] * full[i][j] * T[c][j];
        }
      }
    }
  }
  for (int i = 0; i < 27; ++i)
    EXPECT_NEAR(sums[I(i)], sums0[I(i)] + expected[i], 1e-13) << i;
  EXPECT_TRUE(h.GuardsIntact() && b.GuardsIntact() && sums.GuardsIntact());
}

}  // namespace
}  // namespace glissade::kernels
