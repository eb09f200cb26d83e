// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/gyro_rotation.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "glissade/lie/so3.h"

namespace glissade::vision {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::vector<ImuSample> Turning(const Vector3& rate, int count) {
  std::vector<ImuSample> samples(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    samples[static_cast<std::size_t>(k)].stamp_ns = 5 * kMs * k;
    samples[static_cast<std::size_t>(k)].gyro = rate;
  }
  return samples;
}

TEST(GyroRotation, AConstantRateLessItsBias) {
  const Vector3 rate(0.3, -0.5, 0.8);
  ImuBias bias;
  bias.bg = Vector3(0.02, 0.01, -0.03);
  const auto samples = Turning(rate, 21);  // to 100 ms
  for (const std::int64_t begin : {0 * kMs, 2 * kMs, 17 * kMs, -10 * kMs}) {
    const auto turn = IntegrateGyro(samples, begin, 83 * kMs, bias);
    ASSERT_TRUE(turn.has_value());
    const double dt = 1e-9 * static_cast<double>(83 * kMs - begin);
    const Matrix3 expected = so3::Exp(Vector3(dt * (rate - bias.bg)));
    EXPECT_LT((turn->R_from_to - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
  // The last rate is held for a while.
  EXPECT_TRUE(IntegrateGyro(samples, 50 * kMs, 130 * kMs).has_value());
  EXPECT_FALSE(IntegrateGyro(samples, 50 * kMs, 160 * kMs).has_value());
}

TEST(GyroRotation, ARateThatChangesIsTakenInTheMiddle) {
  auto samples = Turning(Vector3::Zero(), 41);
  double angle = 0.0;
  for (ImuSample& s : samples)
    s.gyro = Vector3(0.0, 0.0, 10.0 * 1e-9 * static_cast<double>(s.stamp_ns));
  angle = 0.5 * 10.0 * 0.2 * 0.2;
  const auto turn = IntegrateGyro(samples, 0, 200 * kMs);
  ASSERT_TRUE(turn.has_value());
  EXPECT_NEAR(so3::Log(turn->R_from_to)[2], angle, 1e-12);
}

TEST(GyroRotation, RefusesWhatItCannotKnow) {
  EXPECT_FALSE(IntegrateGyro({}, 0, kMs).has_value());
  auto samples = Turning(Vector3(1.0, 0.0, 0.0), 21);
  EXPECT_FALSE(IntegrateGyro(samples, 10 * kMs, 10 * kMs).has_value());
  EXPECT_FALSE(IntegrateGyro(samples, 20 * kMs, 10 * kMs).has_value());
  EXPECT_FALSE(IntegrateGyro(samples, -60 * kMs, 10 * kMs).has_value());
  auto gap = samples;
  gap.erase(gap.begin() + 5, gap.begin() + 16);
  EXPECT_FALSE(IntegrateGyro(gap, 0, 100 * kMs).has_value());
  auto back = samples;
  std::swap(back[7], back[8]);
  EXPECT_FALSE(IntegrateGyro(back, 0, 100 * kMs).has_value());
  samples[9].gyro[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IntegrateGyro(samples, 0, 100 * kMs).has_value());
}

}  // namespace
}  // namespace glissade::vision
