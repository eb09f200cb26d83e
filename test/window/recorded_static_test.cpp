// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Standing still in recordings of a real IMU: on the ground with the rotors off and on, and in
// flight.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/data_dir.h"
#include "glissade/io/viotracks.h"
#include "glissade/window/initialize_static.h"

namespace glissade {
namespace {

struct Stand {
  double begin_s, end_s;  ///< on the ground, by the ground truth
};

class RecordedStatic : public testing::TestWithParam<const char*> {
 protected:
  /// Nothing where the recording is missing.
  Result<Viotracks> Read() {
    const auto folder = test::DataDir() / "vio" / GetParam();
    if (!std::filesystem::exists(folder)) return Status(StatusCode::kIoError, "not there");
    return ReadViotracks(folder.string());
  }
  [[nodiscard]] std::vector<Stand> Stands() const {
    if (std::string(GetParam()) == "euroc_v101_map") return {{0.0, 5.0}};
    return {{0.0, 2.5}, {12.0, 19.0}};
  }
};

/// Each second, every half a second: on the ground it passes with a tilt as good as its sigma says,
/// and in the air it does not pass.
TEST_P(RecordedStatic, PassesOnTheGroundAndNotInTheAir) {
  const auto recording = Read();
  if (!recording.ok()) GTEST_SKIP() << recording.status().message();
  const std::int64_t first = recording->imu.front().stamp_ns;
  int standing = 0, standing_passed = 0, flying = 0, flying_passed = 0, tilts_within_2_sigma = 0;
  std::vector<ImuSample> second;
  for (int half = 0; half < 200; ++half) {
    const double begin = 0.5 * half, end = begin + 1.0;
    second.clear();
    for (const ImuSample& s : recording->imu) {
      const double t = SecondsBetween(first, s.stamp_ns);
      if (t >= begin && t <= end) second.push_back(s);
    }
    if (second.size() < 100) break;
    const auto state = InitializeStatic(second, *recording->imu_noise);
    const auto stands = Stands();
    const auto inside = [&](const Stand& s) { return begin >= s.begin_s && end <= s.end_s; };
    const auto touches = [&](const Stand& s) { return end >= s.begin_s && begin <= s.end_s; };
    if (std::any_of(stands.begin(), stands.end(), inside)) {
      ++standing;
      if (!state.ok()) continue;
      ++standing_passed;
      const auto& truth = recording->ground_truth;
      const auto at = std::lower_bound(
          truth.begin(), truth.end() - 1, state->stamp_ns,
          [](const GroundTruthState& x, std::int64_t stamp) { return x.stamp_ns < stamp; });
      const Vector3 up = state->pose.pose.R().transpose() * Vector3::UnitZ();
      const Vector3 up_true = at->T_w_b.R().transpose() * Vector3::UnitZ();
      const double sigma = std::sqrt(0.5 * state->covariance.block<3, 3>(3, 3).trace());
      // Two angles of that sigma: 95 % are within 2.45 of it.
      if (up_true.cross(up).norm() < 2.45 * sigma) ++tilts_within_2_sigma;
    } else if (!std::any_of(stands.begin(), stands.end(), touches)) {
      ++flying;
      if (state.ok()) ++flying_passed;
    }
  }
  RecordProperty("standing", standing);
  EXPECT_GE(standing, 9);
  EXPECT_EQ(standing_passed, standing);
  EXPECT_EQ(tilts_within_2_sigma, standing_passed);
  EXPECT_GT(flying, 100);
  EXPECT_EQ(flying_passed, 0);
}

INSTANTIATE_TEST_SUITE_P(Euroc, RecordedStatic,
                         testing::Values("euroc_v101_map", "euroc_mh05_map"));

}  // namespace
}  // namespace glissade
