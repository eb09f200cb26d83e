// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks of one host, poses as twists, against loops over one row at a time.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

class TwistsTest : public KernelTest {
 protected:
  static Guarded Numbers(int count, Random& random) {
    Guarded x(static_cast<size_t>(count));
    x.FillRandom(random);
    return x;
  }
};
GLISSADE_INSTANTIATE_KERNEL_TEST(TwistsTest);

/// out = M x, 3 x 3 row-major.
void Multiply(const double* M, const double* x, double* out) {
  for (int r = 0; r < 3; ++r)
    out[r] = M[3 * r] * x[0] + M[3 * r + 1] * x[1] + M[3 * r + 2] * x[2];
}

/// [f; q] as kernels/twists.h has it.
void TwistOf(const TwistFrame& frame, const double* J, double* out) {
  double a[3] = {J[0], J[1], J[2]}, b[3];
  if (frame.turned) Multiply(frame.turn, J, a);
  Multiply(frame.R, J + 3, b);
  for (int i = 0; i < 3; ++i)
    out[i] = -a[i];
  const double* p = frame.p;
  out[3] = -b[0] + p[1] * out[2] - p[2] * out[1];
  out[4] = -b[1] + p[2] * out[0] - p[0] * out[2];
  out[5] = -b[2] + p[0] * out[1] - p[1] * out[0];
}

TEST_P(TwistsTest, SumsAreThoseOfLoops) {
  Random random(1);
  for (const int rows : {1, 2, 3}) {
    for (const int lanes : {8, 24}) {
      for (const bool turned : {false, true}) {
        for (const bool weighted : {false, true}) {
          for (const bool sets : {false, true}) {
            const Guarded r = Numbers(rows * lanes, random), J_l = Numbers(rows * lanes, random);
            const Guarded J = Numbers(6 * rows * lanes, random), weight = Numbers(lanes, random);
            const Guarded numbers = Numbers(21, random);
            TwistFrame frame{};
            for (int i = 0; i < 9; ++i) {
              frame.R[i] = numbers[I(i)];
              frame.turn[i] = numbers[I(9 + i)];
            }
            for (int i = 0; i < 3; ++i)
              frame.p[i] = numbers[I(18 + i)];
            frame.turned = turned;
            const int force_lanes = lanes + 8;
            Guarded h = Numbers(lanes, random), b = Numbers(lanes, random);
            Guarded force = Numbers(6 * force_lanes, random), sums = Numbers(kTwistSums, random);
            const Guarded h0 = h, b0 = b, force0 = force, sums0 = sums;
            TwistRun run{};
            run.rows = rows;
            run.lanes = lanes;
            run.r = r.data();
            run.J_l = J_l.data();
            run.J = J.data();
            run.scale = 0.7;
            run.weight = weighted ? weight.data() : nullptr;
            const TwistTotals totals{&frame,      h.data(), b.data(),   force.data(),
                                     force_lanes, sets,     sums.data()};
            ASSERT_EQ(k().twist_sums(&run, &totals), 1);
            double expected[27] = {};
            for (int s = 0; s < lanes; ++s) {
              const double w = weighted ? weight[I(s)] : 1.0;
              double h_s = h0[I(s)], b_s = b0[I(s)], force_s[6] = {};
              for (int row = 0; row < rows; ++row) {
                const double r_s = w * r[I(row * lanes + s)];
                const double j = 0.7 * w * J_l[I(row * lanes + s)];
                double raw[6], twist[6];
                for (int c = 0; c < 6; ++c)
                  raw[c] = 0.7 * w * J[I((6 * row + c) * lanes + s)];
                TwistOf(frame, raw, twist);
                h_s += j * j;
                b_s -= j * r_s;
                for (int i = 0, n = 0; i < 6; ++i) {
                  force_s[i] += j * twist[i];
                  expected[21 + i] += r_s * twist[i];
                  for (int m = 0; m <= i; ++m, ++n)
                    expected[n] += twist[i] * twist[m];
                }
              }
              ASSERT_NEAR(h[I(s)], h_s, 1e-13);
              ASSERT_NEAR(b[I(s)], b_s, 1e-13);
              for (int i = 0; i < 6; ++i) {
                const size_t at = I(i * force_lanes + s);
                ASSERT_NEAR(force[at], force_s[i] + (sets ? 0.0 : force0[at]), 1e-13);
              }
            }
            for (int n = 0; n < 27; ++n)
              ASSERT_NEAR(sums[I(n)], sums0[I(n)] + expected[n], 1e-12) << n;
            ASSERT_TRUE(h.GuardsIntact() && b.GuardsIntact() && force.GuardsIntact() &&
                        sums.GuardsIntact());
          }
        }
      }
    }
  }
}

TEST_P(TwistsTest, WhatIsNotFiniteIsSaid) {
  Random random(2);
  constexpr int kLanes = 16;
  Guarded values = Numbers(8 * 2 * kLanes, random);
  TwistFrame frame{};
  frame.R[0] = frame.R[4] = frame.R[8] = 1.0;
  for (int bad = 0; bad < 8 * 2 * kLanes; bad += 7) {
    Guarded h = Numbers(kLanes, random), b = Numbers(kLanes, random);
    Guarded force = Numbers(6 * kLanes, random), sums = Numbers(kTwistSums, random);
    const double good = values[I(bad)];
    values[I(bad)] = std::numeric_limits<double>::quiet_NaN();
    TwistRun run{};
    run.rows = 2;
    run.lanes = kLanes;
    run.r = values.data();
    run.J_l = values.data() + 2 * kLanes;
    run.J = values.data() + 4 * kLanes;
    run.scale = 1.0;
    const TwistTotals totals{&frame, h.data(), b.data(), force.data(), kLanes, false, sums.data()};
    EXPECT_EQ(k().twist_sums(&run, &totals), 0) << bad;
    if (bad < 4 * kLanes) {
      run.J = nullptr;
      EXPECT_EQ(k().twist_sums(&run, &totals), 0) << bad;
    }
    values[I(bad)] = good;
  }
}

TEST_P(TwistsTest, ProductsAreThoseOfThePanel) {
  Random random(3);
  constexpr int kLanes = 24, kTargets = 3, kRows = 7 + 6 * kTargets, kStride = 32;
  const int used[kTargets] = {24, 13, 8}, lanes[kTargets] = {24, 16, 8};
  std::vector<Guarded> force;
  force.reserve(kTargets);
  TwistTarget targets[kTargets];
  for (int t = 0; t < kTargets; ++t) {
    force.push_back(Numbers(6 * lanes[t], random));
    for (int i = 0; i < 6; ++i) {
      for (int s = used[t]; s < lanes[t]; ++s)
        force.back()[I(i * lanes[t] + s)] = 0.0;
    }
    targets[t] = {used[t], lanes[t], force.back().data()};
  }
  const Guarded b = Numbers(kLanes, random), beta = Numbers(kLanes, random);
  const Guarded scale = Numbers(kLanes, random), twists = Numbers(6 * (kTargets + 1), random);
  const TwistGroup group{1, kLanes, kLanes, kTargets, targets, nullptr};
  Guarded panel(I(kStride * kLanes));
  k().twist_panel(&group, scale.data(), beta.data(), panel.data());
  Guarded product(I(kLanes)), sums(I(6 * (kTargets + 1)));
  k().twist_transpose_product(&group, twists.data(), product.data());
  k().twist_product(&group, b.data(), sums.data());
  std::vector<double> expected(I(6 * (kTargets + 1)));
  for (int s = 0; s < kLanes; ++s) {
    EXPECT_EQ(panel[I(kStride * s)], beta[I(s)]);
    double sum = 0.0;
    for (int row = 1; row < kRows; ++row) {
      const int target = (row - 1) / 6 - 1;
      if (target >= 0 && s >= lanes[target]) continue;
      const double w = panel[I(kStride * s + row)] / scale[I(s)];
      sum += w * twists[I(row - 1)];
      expected[I(row - 1)] += w * b[I(s)];
    }
    EXPECT_NEAR(product[I(s)], sum, 1e-11);
  }
  for (int i = 0; i < 6 * (kTargets + 1); ++i)
    EXPECT_NEAR(sums[I(i)], expected[I(i)], 1e-11);
  EXPECT_TRUE(panel.GuardsIntact() && product.GuardsIntact() && sums.GuardsIntact());
}

TEST_P(TwistsTest, ReducedIsTheProductOfThePanel) {
  Random random(4);
  for (const int num_targets : {0, 1, 2, 3, 4, 7, 10}) {
    const int used = 37, lanes = 40, rows = 7 + 6 * num_targets, stride = (rows + 7) / 8 * 8;
    std::vector<Guarded> force;
    force.reserve(I(num_targets));
    std::vector<TwistTarget> targets;
    for (int t = 0; t < num_targets; ++t) {
      const int seen = std::max(8, lanes - (2 * t + 1) / 3 * 8),
                last = std::min(t > 0 ? targets.back().used : used, seen - t % 3);
      force.push_back(Numbers(6 * seen, random));
      for (int i = 0; i < 6; ++i) {
        for (int s = last; s < seen; ++s)
          force.back()[I(i * seen + s)] = 0.0;
      }
      targets.push_back({last, seen, force.back().data()});
    }
    const Guarded beta = Numbers(lanes, random);
    const Guarded scale = Numbers(lanes, random);
    const TwistGroup group{1, used, lanes, num_targets, targets.data(), nullptr};
    // What is not written is not read.
    Guarded panel(I(stride * lanes)), reduced(I(stride * stride));
    for (size_t i = 0; i < panel.size(); ++i)
      panel[i] = std::numeric_limits<double>::quiet_NaN();
    k().twist_panel(&group, scale.data(), beta.data(), panel.data());
    k().twist_reduce(&group, panel.data(), reduced.data());
    const auto entry = [&](int row, int s) {
      const bool seen = row < 7 || s < targets[I((row - 7) / 6)].used;
      return seen ? panel[I(stride * s + row)] : 0.0;
    };
    for (int c = 0; c < rows; ++c) {
      for (int r = c; r < rows; ++r) {
        double sum = 0.0;
        for (int s = 0; s < used; ++s)
          sum += entry(r, s) * entry(c, s);
        ASSERT_NEAR(reduced[I(r + c * stride)], -sum, 1e-12) << num_targets << " " << r << " " << c;
      }
    }
    EXPECT_TRUE(panel.GuardsIntact() && reduced.GuardsIntact());
  }
}

}  // namespace
}  // namespace glissade::kernels
