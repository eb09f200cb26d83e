// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "common/data_dir.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/io/viotracks.h"

// Real inertial data: from the truth's state, with the truth's biases, 0.5 s ahead by IMU alone.

namespace glissade {
namespace {

double Median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

struct Limits {
  const char* name;
  double rotation_deg, velocity, position;
};

class EurocPropagation : public ::testing::TestWithParam<Limits> {};

TEST_P(EurocPropagation, HalfASecondFromTheTruth) {
  const auto folder = test::DataDir() / "vio" / GetParam().name;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto read = ReadViotracks(folder.string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  ImuBuffer buffer;
  for (const ImuSample& sample : read->imu)
    EXPECT_TRUE(buffer.Add(sample).ok());
  EXPECT_EQ(buffer.counts().gaps, 0);

  std::vector<double> rotation, velocity, position;
  ImuInterval interval;
  const auto& truth = read->ground_truth;
  for (std::size_t k = 0; k + 5 < truth.size(); ++k) {  // 10 Hz
    const GroundTruthState &from = truth[k], &to = truth[k + 5];
    ASSERT_TRUE(buffer.Between(from.stamp_ns, to.stamp_ns, &interval).ok());
    const auto preintegration = Preintegrate(
        interval.samples, {from.speed_bias->ba(), from.speed_bias->bg()}, *read->imu_noise);
    ASSERT_TRUE(preintegration.ok()) << preintegration.status().message();
    EXPECT_NEAR(preintegration->imu.dt, 0.5, 1e-3);
    auto factor = MakeImuFactor(*preintegration);
    ASSERT_TRUE(factor.ok()) << factor.status().message();
    factor->edge.gravity = read->gravity;
    const ImuPrediction x = Predict(factor->edge, VertexPose{from.T_w_b}, *from.speed_bias);
    const Quaternion error = x.pose.pose.q().conjugate() * to.T_w_b.q();
    rotation.push_back(180.0 / std::numbers::pi * so3::Log(error).norm());
    velocity.push_back((x.speed_bias.v() - to.speed_bias->v()).norm());
    position.push_back((x.pose.pose.p() - to.T_w_b.p()).norm());
  }
  EXPECT_LE(Median(rotation), GetParam().rotation_deg);
  EXPECT_LE(Median(velocity), GetParam().velocity);
  EXPECT_LE(Median(position), GetParam().position);
  RecordProperty("rotation_deg", std::to_string(Median(rotation)));
  RecordProperty("velocity_mps", std::to_string(Median(velocity)));
  RecordProperty("position_m", std::to_string(Median(position)));
  std::printf("[ measured ] %s: %.5f deg, %.5f m/s, %.5f m\n", GetParam().name, Median(rotation),
              Median(velocity), Median(position));
}

INSTANTIATE_TEST_SUITE_P(Recordings, EurocPropagation,
                         ::testing::Values(Limits{"euroc_v101_semi", 0.060, 0.026, 0.007},
                                           Limits{"euroc_mh05_semi", 0.010, 0.028, 0.009}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace glissade
