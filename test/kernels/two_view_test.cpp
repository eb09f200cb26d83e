// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections between two cameras: values against differences, and the sums that are made in one
// pass against those that are made of the values.

#include <cmath>
#include <limits>
#include <vector>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

/// R = Exp(w), row-major.
void Rotation(const double (&w)[3], double* R) {
  const double angle = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const double a = std::sin(angle) / angle, b = (1.0 - std::cos(angle)) / (angle * angle);
  const double W[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double square = 0.0;
      for (int k = 0; k < 3; ++k)
        square += W[3 * i + k] * W[3 * k + j];
      R[3 * i + j] = (i == j ? 1.0 : 0.0) + a * W[3 * i + j] + b * square;
    }
  }
}

/// Lanes of two cameras a step apart, with weights, in which some lanes do not count.
struct Scene {
  static constexpr int kLanes = 136;  // more than the sums take at a time
  TwoViewCamera host{}, target{};
  TwistFrame frame{};
  Guarded uv{I(4 * kLanes)}, depth{I(kLanes)}, mask{I(kLanes)}, width{I(kLanes)};

  explicit Scene(uint64_t seed) {
    Random random(seed);
    const auto number = [&] { return random.Uniform(); };
    Rotation({0.1 * number(), 0.2 * number(), 0.1 * number()}, host.R_wc);
    Rotation({0.1 * number(), 0.1 * number(), 0.2 * number()}, target.R_wc);
    for (int i = 0; i < 3; ++i) {
      host.c[i] = number();
      target.c[i] = host.c[i] + 0.3 * number();
    }
    Rotation({number(), number(), 1.0}, frame.R);
    for (int i = 0; i < 9; ++i)
      frame.turn[i] = frame.R[i];
    frame.turned = true;
    for (int i = 0; i < 3; ++i)
      frame.p[i] = 2.0 * number();
    for (int s = 0; s < kLanes; ++s) {
      for (int k = 0; k < 4; ++k)
        uv[I(k * kLanes + s)] = 0.5 * number();
      depth[I(s)] = s % 7 == 0 ? 0.0 : 0.3 + 0.2 * number();
      mask[I(s)] = s % 5 == 3 ? 0.0 : 1.0;
      width[I(s)] = s % 3 == 0 ? std::numeric_limits<double>::infinity() : 1.0 + 0.5 * number();
    }
  }
  [[nodiscard]] TwoViewRun Run(bool masked) const {
    return {kLanes, uv.data(), depth.data(), masked ? mask.data() : nullptr, &host, &target};
  }
};

/// What a run adds to.
struct Totals {
  static constexpr int kLanes = Scene::kLanes, kForceLanes = kLanes + 8;
  Guarded h{I(kLanes)}, b{I(kLanes)}, force{I(6 * kForceLanes)}, sums{I(kTwistSums)};

  Totals() {
    Random random(9);
    for (auto* array : {&h, &b, &force, &sums})
      array->FillRandom(random);
  }
  TwistTotals To(const TwistFrame& frame, bool sets_force) {
    return {&frame, h.data(), b.data(), force.data(), kForceLanes, sets_force, sums.data()};
  }
  [[nodiscard]] bool GuardsIntact() const {
    return h.GuardsIntact() && b.GuardsIntact() && force.GuardsIntact() && sums.GuardsIntact();
  }
};

class TwoViewTest : public KernelTest {};
GLISSADE_INSTANTIATE_KERNEL_TEST(TwoViewTest);

TEST_P(TwoViewTest, JacobiansAreThoseOfDifferences) {
  constexpr int kLanes = Scene::kLanes;
  constexpr double kStep = 1e-6;
  Scene scene(1);
  Guarded r(I(2 * kLanes)), J_l(I(2 * kLanes)), J(I(12 * kLanes));
  const TwoViewRun run = scene.Run(false);
  const TwoViewValues all{r.data(), J_l.data(), J.data()};
  k().two_view_lanes(&run, &all);
  Guarded plus(I(2 * kLanes)), minus(I(2 * kLanes));
  const TwoViewValues up{plus.data(), nullptr, nullptr}, down{minus.data(), nullptr, nullptr};
  const TwoViewCamera target = scene.target;
  for (int column = 0; column < 7; ++column) {
    for (const double step : {kStep, -kStep}) {
      scene.target = target;
      if (column == 6) {
        for (int s = 0; s < kLanes; ++s)
          scene.depth[I(s)] += step;
      } else if (column < 3) {  // along the camera's axes
        for (int i = 0; i < 3; ++i)
          scene.target.c[i] += step * target.R_wc[3 * i + column];
      } else {
        double w[3] = {}, turn[9];
        w[column - 3] = step;
        Rotation(w, turn);
        for (int i = 0; i < 9; ++i) {
          scene.target.R_wc[i] = 0.0;
          for (int m = 0; m < 3; ++m)
            scene.target.R_wc[i] += target.R_wc[i / 3 * 3 + m] * turn[3 * m + i % 3];
        }
      }
      k().two_view_lanes(&run, step > 0.0 ? &up : &down);
      for (int s = 0; s < kLanes && column == 6; ++s)
        scene.depth[I(s)] -= step;
    }
    for (int row = 0; row < 2; ++row) {
      for (int s = 0; s < kLanes; ++s) {
        const size_t at = I(row * kLanes + s);
        const double expected = (plus[at] - minus[at]) / (2.0 * kStep);
        const double value = column == 6 ? J_l[at] : J[I((6 * row + column) * kLanes + s)];
        ASSERT_NEAR(value, expected, 2e-8) << column << " " << row << " " << s;
      }
    }
  }
  EXPECT_TRUE(r.GuardsIntact() && J_l.GuardsIntact() && J.GuardsIntact());
}

TEST_P(TwoViewTest, SumsInOnePassAreThoseOfTheValues) {
  constexpr int kLanes = Scene::kLanes;
  const Scene scene(2);
  for (const bool masked : {false, true}) {
    for (const LaneLoss loss :
         {LaneLoss::kNone, LaneLoss::kHuber, LaneLoss::kCauchy, LaneLoss::kTukey}) {
      for (const bool by_row : {false, true}) {
        const bool sets = masked != by_row;
        const TwoViewRun run = scene.Run(masked);
        // Of each row; the run that is compared with has them in its values.
        const double scale[2] = {3.0, by_row ? 2.0 : 3.0};
        const TwoViewWeights weights{{scale[0], scale[1]}, loss, scene.width.data()};
        Totals in_one, in_turn;
        const TwistTotals to = in_one.To(scene.frame, sets);
        double cost = -1.0;
        ASSERT_EQ(k().two_view_sums(&run, &weights, &to, &cost), 1);

        Guarded r(I(2 * kLanes)), J_l(I(2 * kLanes)), J(I(12 * kLanes));
        const TwoViewValues values{r.data(), J_l.data(), J.data()};
        k().two_view_lanes(&run, &values);
        Guarded factor(I(kLanes)), squares(I(kLanes));
        for (int s = 0; s < kLanes; ++s) {
          const double mask = masked ? scene.mask[I(s)] : 1.0;
          squares[I(s)] = 0.0;
          for (int row = 0; row < 2; ++row) {
            double& x = r[I(row * kLanes + s)];
            x *= scale[row];
            J_l[I(row * kLanes + s)] *= scale[row];
            for (int column = 0; column < 6; ++column)
              J[I((6 * row + column) * kLanes + s)] *= scale[row];
            squares[I(s)] += mask * x * x;
          }
          factor[I(s)] = 1.0;
        }
        double expected = 0.0;
        if (loss == LaneLoss::kNone) {
          for (int s = 0; s < kLanes; ++s)
            expected += 0.5 * squares[I(s)];
        } else {
          expected =
              k().loss_lanes(loss, kLanes, squares.data(), scene.width.data(), factor.data());
        }
        for (int s = 0; s < kLanes && masked; ++s)
          factor[I(s)] *= scene.mask[I(s)];
        TwistRun same{2, kLanes, r.data(), J_l.data(), J.data(), 1.0, factor.data()};
        const TwistTotals to_other = in_turn.To(scene.frame, sets);
        ASSERT_EQ(k().twist_sums(&same, &to_other), 1);
        EXPECT_NEAR(cost, expected, 1e-12 * expected);
        EXPECT_EQ(k().two_view_cost(&run, &weights), cost) << "costs are compared to the last bit";
        for (int s = 0; s < kLanes; ++s) {
          ASSERT_NEAR(in_one.h[I(s)], in_turn.h[I(s)], 1e-11);
          ASSERT_NEAR(in_one.b[I(s)], in_turn.b[I(s)], 1e-11);
        }
        for (int i = 0; i < 6 * Totals::kForceLanes; ++i)
          ASSERT_NEAR(in_one.force[I(i)], in_turn.force[I(i)], 1e-11) << i;
        for (int i = 0; i < 27; ++i) {
          ASSERT_NEAR(in_one.sums[I(i)], in_turn.sums[I(i)],
                      1e-12 * (1e3 + std::abs(in_turn.sums[I(i)])))
              << i;
        }
        EXPECT_TRUE(in_one.GuardsIntact());
      }
    }
  }
}

TEST_P(TwoViewTest, WhatIsNotFiniteIsSaid) {
  Scene scene(3);
  const TwoViewRun run = scene.Run(true);
  const TwoViewWeights weights{{1.0, 1.0}, LaneLoss::kHuber, scene.width.data()};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int s = 0; s < Scene::kLanes; ++s) {
    Totals totals;
    const TwistTotals to = totals.To(scene.frame, false);
    double cost = 0.0;
    const double depth = scene.depth[I(s)];
    scene.depth[I(s)] = nan;
    const bool counts = scene.mask[I(s)] != 0.0;
    EXPECT_EQ(k().two_view_sums(&run, &weights, &to, &cost), counts ? 0 : 1) << s;
    EXPECT_EQ(std::isfinite(k().two_view_cost(&run, &weights)), !counts) << s;
    scene.depth[I(s)] = depth;
  }
  // In the plane of the target camera: z = 0.
  Rotation({0.0, 0.0, 1.0}, scene.host.R_wc);
  Rotation({0.0, 0.0, 1.0}, scene.target.R_wc);
  for (int s = 0; s < Scene::kLanes; ++s)
    scene.depth[I(s)] = 0.5;
  for (int i = 0; i < 3; ++i)
    scene.target.c[i] = scene.host.c[i] + (i == 2 ? 2.0 : 0.0);
  Totals totals;
  const TwistTotals to = totals.To(scene.frame, false);
  double cost = 0.0;
  EXPECT_EQ(k().two_view_sums(&run, &weights, &to, &cost), 0);
  for (int s = 0; s < Scene::kLanes; ++s)
    scene.mask[I(s)] = 0.0;
  Totals fresh;
  const TwistTotals to_fresh = fresh.To(scene.frame, false);
  EXPECT_EQ(k().two_view_sums(&run, &weights, &to_fresh, &cost), 1);
  EXPECT_EQ(cost, 0.0);
}

}  // namespace
}  // namespace glissade::kernels
