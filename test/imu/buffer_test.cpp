// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/buffer.h"

#include <gtest/gtest.h>

#include <limits>

#include "imu/imu_signal.h"

namespace glissade {
namespace {

using test::SampleAt;

ImuBuffer Filled(int n, std::int64_t period_ns, const ImuBufferOptions& options = {}) {
  ImuBuffer buffer(options);
  for (int k = 0; k <= n; ++k)
    EXPECT_TRUE(buffer.Add(SampleAt(k * period_ns)).ok());
  return buffer;
}

TEST(ImuBuffer, RefusesAndCountsWhatDoesNotFit) {
  ImuBuffer buffer = Filled(3, 10);
  EXPECT_EQ(buffer.Add(SampleAt(30)).code(), StatusCode::kDuplicate);
  EXPECT_EQ(buffer.Add(SampleAt(20)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(buffer.Add(SampleAt(-5)).code(), StatusCode::kInvalidArgument);
  ImuSample bad = SampleAt(40);
  bad.gyro[1] = std::numeric_limits<double>::quiet_NaN();
  const Status status = buffer.Add(bad);
  EXPECT_EQ(status.code(), StatusCode::kNotFinite);
  EXPECT_NE(status.message().find("40 ns"), std::string::npos) << status.message();
  bad = SampleAt(40);
  bad.accel[0] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(buffer.Add(bad).code(), StatusCode::kNotFinite);
  EXPECT_EQ(buffer.counts().accepted, 4);
  EXPECT_EQ(buffer.counts().duplicate, 1);
  EXPECT_EQ(buffer.counts().out_of_order, 2);
  EXPECT_EQ(buffer.counts().not_finite, 2);
  EXPECT_EQ(buffer.samples().size(), 4u);
  EXPECT_TRUE(buffer.Add(SampleAt(40)).ok());
}

TEST(ImuBuffer, InterpolatesTheEnds) {
  const ImuBuffer buffer = Filled(10, 10);
  ImuInterval interval;
  ASSERT_TRUE(buffer.Between(13, 47, &interval).ok());
  ASSERT_EQ(interval.samples.size(), 5u);
  EXPECT_EQ(interval.samples[0].stamp_ns, 13);
  EXPECT_EQ(interval.samples[1].stamp_ns, 20);
  EXPECT_EQ(interval.samples[4].stamp_ns, 47);
  const ImuSample a = SampleAt(10), b = SampleAt(20);
  EXPECT_LT((interval.samples[0].gyro - (0.7 * a.gyro + 0.3 * b.gyro)).norm(), 1e-15);
  EXPECT_LT((interval.samples[0].accel - (0.7 * a.accel + 0.3 * b.accel)).norm(), 1e-14);
  // On samples: taken as they are.
  ASSERT_TRUE(buffer.Between(20, 40, &interval).ok());
  ASSERT_EQ(interval.samples.size(), 3u);
  EXPECT_EQ(interval.samples[0].gyro, SampleAt(20).gyro);
  EXPECT_EQ(interval.samples[2].accel, SampleAt(40).accel);
  // Inside one pair.
  ASSERT_TRUE(buffer.Between(22, 28, &interval).ok());
  ASSERT_EQ(interval.samples.size(), 2u);
  EXPECT_EQ(interval.samples[0].stamp_ns, 22);
  EXPECT_EQ(interval.samples[1].stamp_ns, 28);
  // The whole recording.
  ASSERT_TRUE(buffer.Between(0, 100, &interval).ok());
  EXPECT_EQ(interval.samples.size(), 11u);
}

TEST(ImuBuffer, IntervalsJoin) {
  // Two intervals that meet between samples integrate to what one does.
  ImuBuffer buffer = Filled(40, 5'000'000);
  ImuInterval first, second, whole;
  ASSERT_TRUE(buffer.Between(2'000'000, 83'333'333, &first).ok());
  ASSERT_TRUE(buffer.Between(83'333'333, 180'000'000, &second).ok());
  ASSERT_TRUE(buffer.Between(2'000'000, 180'000'000, &whole).ok());
  const PreintegratedImu a = Preintegrate(first.samples, {}, {})->imu;
  const PreintegratedImu b = Preintegrate(second.samples, {}, {})->imu;
  const PreintegratedImu c = Preintegrate(whole.samples, {}, {})->imu;
  const Vector3 p = a.dp + b.dt * a.dv + RotationMatrix(a.dq.coeffs().data()) * b.dp;
  EXPECT_LT((p - c.dp).norm(), 1e-9);
  EXPECT_LT(so3::Log(Quaternion((a.dq * b.dq).conjugate() * c.dq)).norm(), 1e-9);
}

TEST(ImuBuffer, NeverExtrapolates) {
  const ImuBuffer buffer = Filled(10, 10);
  ImuInterval interval;
  EXPECT_FALSE(buffer.Between(-1, 50, &interval).ok());
  EXPECT_FALSE(buffer.Between(50, 101, &interval).ok());
  EXPECT_FALSE(buffer.Between(50, 50, &interval).ok());
  EXPECT_FALSE(buffer.Between(60, 50, &interval).ok());
  EXPECT_TRUE(interval.samples.empty());
  EXPECT_FALSE(ImuBuffer().Between(0, 1, &interval).ok());
}

TEST(ImuBuffer, ReportsGaps) {
  ImuBuffer buffer({.max_gap_ns = 25});
  for (std::int64_t stamp : {0, 10, 20, 30, 60, 70, 95, 121})
    EXPECT_TRUE(buffer.Add(SampleAt(stamp)).ok());
  EXPECT_EQ(buffer.counts().gaps, 2);
  ImuInterval interval;
  ASSERT_TRUE(buffer.Between(5, 30, &interval).ok());
  EXPECT_EQ(interval.gaps, 0);
  EXPECT_EQ(interval.largest_gap_ns, 10);
  ASSERT_TRUE(buffer.Between(5, 40, &interval).ok());  // ends inside the gap
  EXPECT_EQ(interval.gaps, 1);
  EXPECT_EQ(interval.largest_gap_ns, 30);
  ASSERT_TRUE(buffer.Between(50, 55, &interval).ok());  // all inside it
  EXPECT_EQ(interval.gaps, 1);
  ASSERT_TRUE(buffer.Between(0, 121, &interval).ok());
  EXPECT_EQ(interval.gaps, 2);
}

TEST(ImuBuffer, MarksSaturation) {
  ImuBuffer buffer({.gyro_range = 5.0, .accel_range = 20.0});
  ImuSample s;
  for (std::int64_t stamp : {0, 10, 20, 30}) {
    s = SampleAt(stamp);
    if (stamp == 10) s.accel[2] = -20.0;
    if (stamp == 30) s.gyro[0] = 5.5;
    ASSERT_TRUE(buffer.Add(s).ok());
  }
  EXPECT_EQ(buffer.counts().saturated, 2);
  ImuInterval interval;
  ASSERT_TRUE(buffer.Between(0, 25, &interval).ok());
  EXPECT_FALSE(interval.samples[0].accel_saturated);
  EXPECT_TRUE(interval.samples[1].accel_saturated);
  EXPECT_FALSE(interval.samples[1].gyro_saturated);
  EXPECT_FALSE(interval.samples[2].accel_saturated);
  EXPECT_TRUE(interval.samples[3].gyro_saturated);  // interpolated from the one at 30
}

TEST(ImuBuffer, DropsWhatIsBehind) {
  ImuBuffer buffer = Filled(10, 10);
  buffer.DropBefore(34);
  EXPECT_EQ(buffer.samples().front().stamp_ns, 30);
  ImuInterval interval;
  EXPECT_TRUE(buffer.Between(34, 100, &interval).ok());
  EXPECT_FALSE(buffer.Between(29, 100, &interval).ok());
  buffer.DropBefore(1000);  // the last one stays: order is still watched
  EXPECT_EQ(buffer.samples().size(), 1u);
  EXPECT_EQ(buffer.Add(SampleAt(100)).code(), StatusCode::kDuplicate);
  EXPECT_TRUE(buffer.Add(SampleAt(110)).ok());
  // Storage stays bounded.
  for (int k = 12; k < 10000; ++k) {
    ASSERT_TRUE(buffer.Add(SampleAt(10 * k)).ok());
    buffer.DropBefore(10 * k - 50);
    ASSERT_LE(buffer.samples().size(), 7u);
  }
  EXPECT_EQ(buffer.samples().front().stamp_ns, 99940);
}

TEST(ImuBuffer, ExtremeStamps) {
  constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();
  ImuBuffer buffer;
  ImuSample s;
  s.stamp_ns = kLow;
  EXPECT_TRUE(buffer.Add(s).ok());
  s.stamp_ns = kHigh;
  EXPECT_TRUE(buffer.Add(s).ok());
  EXPECT_EQ(buffer.counts().gaps, 1);
  ImuInterval interval;
  EXPECT_TRUE(buffer.Between(0, 10, &interval).ok());
  EXPECT_EQ(interval.gaps, 1);
  EXPECT_TRUE(internal::AllFinite(interval.samples[0].accel.data(), 3));
}

TEST(ImuBuffer, OptionsThatMakeNoSense) {
  EXPECT_FALSE(ImuBufferOptions{.max_gap_ns = 0}.Validate().ok());
  EXPECT_FALSE(ImuBufferOptions{.gyro_range = std::nan("")}.Validate().ok());
  EXPECT_FALSE(ImuBufferOptions{.accel_range = -1.0}.Validate().ok());
  EXPECT_EQ(ImuBuffer({.max_gap_ns = -1}).options().max_gap_ns, 50'000'000);
}

}  // namespace
}  // namespace glissade
