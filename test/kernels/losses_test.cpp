// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Losses in lanes against long doubles.

#include <cmath>
#include <limits>
#include <vector>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLanes = 8;

class LossesTest : public KernelTest {
 protected:
  /// rho(s) / 2 and the root of rho'(s), of one residual among lanes that have none.
  struct Value {
    double cost, root;
  };
  [[nodiscard]] Value Of(LaneLoss loss, double s, double width, int lane) const {
    Guarded squares(kLanes), widths(kLanes), root(kLanes);
    for (size_t i = 0; i < kLanes; ++i) {
      squares[i] = 0.0;
      widths[i] = kInfinity;
    }
    squares[static_cast<size_t>(lane)] = s;
    widths[static_cast<size_t>(lane)] = width;
    const double cost = k().loss_lanes(loss, kLanes, squares.data(), widths.data(), root.data());
    EXPECT_TRUE(root.GuardsIntact());
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_TRUE(i == lane || root[static_cast<size_t>(i)] == 1.0);
    }
    return {cost, root[static_cast<size_t>(lane)]};
  }
  static Wide Loss(LaneLoss loss, Wide s, Wide width, Wide* weight) {
    const Wide square = width * width;
    switch (loss) {
      case LaneLoss::kHuber:
        *weight = s > square ? width / std::sqrt(s) : Wide{1};
        return s > square ? 2 * width * std::sqrt(s) - square : s;
      case LaneLoss::kCauchy:
        *weight = 1 / (1 + s / square);
        return square * std::log1p(s / square);
      default: {
        const Wide v = s <= square ? 1 - s / square : Wide{0};
        *weight = v * v;
        return square / 3 * (1 - v * v * v);
      }
    }
  }
};
GLISSADE_INSTANTIATE_KERNEL_TEST(LossesTest);

constexpr LaneLoss kLosses[] = {LaneLoss::kHuber, LaneLoss::kCauchy, LaneLoss::kTukey};

TEST_P(LossesTest, AgreeWithLongDoubles) {
  Random random(1);
  for (const LaneLoss loss : kLosses) {
    for (int i = 0; i < 2000; ++i) {
      const double width = std::exp2(4.0 * random.Uniform());
      const double s = width * width * std::exp2(8.0 * random.Uniform());
      Wide weight = 0;
      const Wide expected = Loss(loss, s, width, &weight);
      const Value value = Of(loss, s, width, i % kLanes);
      ASSERT_NEAR(2.0 * value.cost, static_cast<double>(expected), 1e-15 * (s + width * width));
      ASSERT_NEAR(value.root, static_cast<double>(std::sqrt(weight)), 2e-15);
    }
    // No loss where the width is infinite, and nothing where there is no residual.
    EXPECT_EQ(Of(loss, 3.0, kInfinity, 2).cost, 1.5);
    EXPECT_EQ(Of(loss, 3.0, kInfinity, 2).root, 1.0);
    EXPECT_EQ(Of(loss, 3.0, 1e200, 3).cost, 1.5);
    EXPECT_EQ(Of(loss, 0.0, 0.5, 1).cost, 0.0);
    EXPECT_EQ(Of(loss, 0.0, 0.5, 1).root, 1.0);
    EXPECT_TRUE(std::isnan(Of(loss, std::nan(""), 1.0, 4).cost) || loss == LaneLoss::kTukey);
  }
  EXPECT_EQ(Of(LaneLoss::kHuber, kInfinity, 1.0, 5).cost, kInfinity);
  EXPECT_EQ(Of(LaneLoss::kCauchy, kInfinity, 1.0, 5).cost, kInfinity);
  EXPECT_EQ(Of(LaneLoss::kTukey, kInfinity, 3.0, 5).cost, 1.5);
}

// The logarithm of Cauchy's loss, width 1: to less than an ulp over all doubles.
TEST_P(LossesTest, TheLogarithmIsRightToTheLastBit) {
  Random random(2);
  std::vector<double> numbers = {std::numeric_limits<double>::denorm_min(),
                                 std::numeric_limits<double>::min(),
                                 std::numeric_limits<double>::epsilon(),
                                 std::numeric_limits<double>::max(),
                                 std::nextafter(1.0, 2.0),
                                 std::nextafter(1.0, 0.0),
                                 std::sqrt(2.0) - 1.0,
                                 1.0,
                                 3.0,
                                 0x1p53 - 1.0,
                                 0x1p53,
                                 0x1p53 + 2.0,
                                 0x1p54};
  for (int i = 0; i < 4000; ++i) {
    const double mantissa = 1.5 + 0.5 * random.Uniform();
    numbers.push_back(std::ldexp(mantissa, random.Below(2098) - 1074));  // all exponents
    numbers.push_back(std::ldexp(mantissa, random.Below(64) - 54));      // where 1 + x is rounded
    numbers.push_back(mantissa - 1.0);
    numbers.push_back(std::ldexp(1.0, random.Below(120) - 60) * (1.0 + 1e-15 * i) - 1.0);
  }
  double worst = 0.0;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const double x = std::abs(numbers[i]);
    const double value = 2.0 * Of(LaneLoss::kCauchy, x, 1.0, static_cast<int>(i % kLanes)).cost;
    const Wide expected = std::log1p(static_cast<Wide>(x));
    const double nearest = static_cast<double>(expected);
    const Wide ulp = std::nextafter(nearest, kInfinity) - static_cast<Wide>(nearest);
    const auto error = static_cast<double>(std::abs(static_cast<Wide>(value) - expected) / ulp);
    // Half of a denormal number is rounded.
    ASSERT_LE(error, nearest < 1e-300 ? 2.0 : 1.0) << x;
    if (nearest >= 1e-300) worst = std::max(worst, error);
  }
  RecordProperty("worst_error_in_ulps", std::to_string(worst));
  EXPECT_LT(worst, 0.95);
}

}  // namespace
}  // namespace glissade::kernels
