// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stamps, IMU values and tracks broken on purpose: each has its finding and no other.
#include "glissade/window/data_doctor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "window/doctor_findings.h"

namespace glissade {
namespace {

using test::kQuick;
using test::Only;
using test::Serious;
using test::ShakenRecording;
using test::Shifted;
using test::Told;

TEST(DataDoctorStreams, StampsOfTheImu) {
  {
    ShakenRecording r(13);
    const std::int64_t at = r.imu[999].stamp_ns;
    r.imu.erase(r.imu.begin() + 1000, r.imu.begin() + 1060);
    const DoctorFinding f = Only(r, DoctorKind::kImuGap);
    EXPECT_EQ(f.stamp_ns.value_or(0), at);
    EXPECT_NEAR(f.estimate.value_or(0.0), 61 * 0.005, 1e-6);
    EXPECT_EQ(f.severity, DoctorSeverity::kError);
  }
  {
    ShakenRecording r(13);
    for (std::size_t k = 300; k < r.imu.size(); k += 300)
      r.imu.erase(r.imu.begin() + static_cast<std::ptrdiff_t>(k),
                  r.imu.begin() + static_cast<std::ptrdiff_t>(k) + 3);
    EXPECT_EQ(Only(r, DoctorKind::kImuGap).severity, DoctorSeverity::kWarning);
  }
  {
    ShakenRecording r(13);
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<double> u(-0.002, 0.002);
    for (ImuSample& s : r.imu)
      s.stamp_ns = Shifted(s.stamp_ns, u(rng));
    // Intervals are differences of two of these.
    const DoctorFinding f = Only(r, DoctorKind::kImuJitter);
    EXPECT_NEAR(f.estimate.value_or(0.0), 0.004 / std::sqrt(12.0) * std::sqrt(2.0), 2e-4);
  }
  {
    ShakenRecording r(13);
    r.imu.insert(r.imu.begin() + 500, r.imu[499]);
    const DoctorFinding f = Only(r, DoctorKind::kImuDuplicateStamp);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.imu[500].stamp_ns);
    EXPECT_EQ(f.count, 1);
  }
  {
    ShakenRecording r(13);
    std::swap(r.imu[700], r.imu[701]);
    const DoctorFinding f = Only(r, DoctorKind::kImuSwappedStamps);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.imu[701].stamp_ns);
  }
  {
    ShakenRecording r(13);
    std::rotate(r.imu.begin() + 400, r.imu.begin() + 450, r.imu.begin() + 500);
    const DoctorFinding f = Only(r, DoctorKind::kImuOutOfOrder);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.imu[450].stamp_ns);
  }
  {
    ShakenRecording r(13);
    r.rate_hz = 400.0;
    EXPECT_NEAR(Only(r, DoctorKind::kImuRate).estimate.value_or(0.0), 200.0, 0.1);
  }
}

TEST(DataDoctorStreams, ValuesOfTheImu) {
  {
    ShakenRecording r(14);
    r.imu[321].gyro[1] = std::numeric_limits<double>::quiet_NaN();
    const DoctorFinding f = Only(r, DoctorKind::kImuNotFinite);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.imu[321].stamp_ns);
    EXPECT_EQ(f.sensor, "gyro");
  }
  {
    ShakenRecording r(14);
    for (std::size_t k = 800; k < 840; ++k)
      r.imu[k].accel = r.imu[800].accel;
    const DoctorFinding f = Only(r, DoctorKind::kImuStuck);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.imu[800].stamp_ns);
    EXPECT_EQ(f.sensor, "accel");
    EXPECT_EQ(f.count, 40);
  }
  {
    ShakenRecording r(14);
    for (ImuSample& s : r.imu)
      s.gyro[2] = std::clamp(s.gyro[2], -0.5, 0.5);
    const DoctorReport report = Diagnose(r.Input(), kQuick);
    const DoctorFinding* f = report.Find(DoctorKind::kImuSaturated);
    ASSERT_NE(f, nullptr) << Told(report);
    EXPECT_EQ(f->sensor, "gyro z");
    EXPECT_NEAR(std::abs(f->estimate.value_or(0.0)), 0.5, 1e-12);
  }
  {
    ShakenRecording r(14);
    for (std::size_t k = 1; k < r.imu.size(); k += 2) {
      r.imu[k].gyro = r.imu[k - 1].gyro;
      r.imu[k].accel = r.imu[k - 1].accel;
    }
    const DoctorReport report = Diagnose(r.Input(), kQuick);
    const DoctorFinding* f = report.Find(DoctorKind::kImuRepeated);
    ASSERT_NE(f, nullptr) << Told(report);
    EXPECT_NEAR(f->estimate.value_or(0.0), 0.5, 0.01);
    EXPECT_EQ(report.Find(DoctorKind::kImuStuck), nullptr) << Told(report);
  }
}

TEST(DataDoctorStreams, StampsOfFrames) {
  {
    ShakenRecording r(15);
    r.stamps.erase(r.stamps.begin() + 50, r.stamps.begin() + 57);
    r.observations.erase(r.observations.begin() + 50, r.observations.begin() + 57);
    const DoctorFinding f = Only(r, DoctorKind::kFrameGap);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.stamps[49]);
    EXPECT_NEAR(f.estimate.value_or(0.0), 0.8, 1e-6);
  }
  {
    ShakenRecording r(15);
    r.stamps[31] = r.stamps[30];
    EXPECT_EQ(Only(r, DoctorKind::kFrameDuplicateStamp).stamp_ns.value_or(0), r.stamps[30]);
  }
  {
    ShakenRecording r(15);
    std::swap(r.stamps[40], r.stamps[41]);
    std::swap(r.observations[40], r.observations[41]);
    EXPECT_EQ(Only(r, DoctorKind::kFrameSwappedStamps).stamp_ns.value_or(0), r.stamps[41]);
  }
  {
    ShakenRecording r(15);
    r.imu.erase(r.imu.begin(), r.imu.begin() + 300);  // 0.5 s of frames are missed by a second
    const DoctorFinding f = Only(r, DoctorKind::kFrameOutsideImu);
    EXPECT_EQ(f.count, 10);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.stamps[0]);
    EXPECT_EQ(f.severity, DoctorSeverity::kWarning);
  }
  {
    ShakenRecording r(15);
    for (std::int64_t& stamp : r.stamps)
      stamp /= 1000;  // microseconds
    EXPECT_EQ(Only(r, DoctorKind::kFrameOutsideImu).severity, DoctorSeverity::kError);
  }
}

TEST(DataDoctorStreams, Observations) {
  {
    ShakenRecording r(16);
    r.observations[20].push_back(r.observations[20].front());
    const DoctorFinding f = Only(r, DoctorKind::kDuplicateObservation);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.stamps[20]);
    EXPECT_EQ(f.count, 1);
  }
  {
    ShakenRecording r(16);
    r.observations[21][3].u = std::numeric_limits<double>::infinity();
    EXPECT_EQ(Only(r, DoctorKind::kPixelNotFinite).stamp_ns.value_or(0), r.stamps[21]);
  }
  {
    ShakenRecording r(16);
    r.observations[22][3].camera = 2;
    EXPECT_EQ(Only(r, DoctorKind::kUnknownCamera).stamp_ns.value_or(0), r.stamps[22]);
  }
  {
    ShakenRecording r(16);
    for (DoctorImageSize& size : r.sizes)
      size = {376, 240};  // of images at half the resolution
    EXPECT_EQ(Only(r, DoctorKind::kOutsideImage).severity, DoctorSeverity::kError);
  }
  {
    ShakenRecording r(16);
    for (std::size_t k = 60; k < 66; ++k)
      r.observations[k].clear();
    const DoctorFinding f = Only(r, DoctorKind::kFewTracks);
    EXPECT_EQ(f.stamp_ns.value_or(0), r.stamps[60]);
    EXPECT_EQ(f.count, 6);
  }
  {
    ShakenRecording r(16);
    std::int64_t next = 1'000'000;
    for (auto& frame : r.observations) {
      for (FrameObservation& o : frame)
        o.track = next++;  // numbers are never kept
    }
    Only(r, DoctorKind::kShortTracks);
  }
  {
    ShakenRecording r(16);
    r.cameras[0].fx = -1.0;
    Only(r, DoctorKind::kBadCamera);
  }
}

TEST(DataDoctorStreams, TracksThatJump) {
  ShakenRecording r(17);
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (auto& frame : r.observations) {
    for (FrameObservation& o : frame) {
      if (o.camera != 0 || u(rng) > 0.12) continue;
      o.u = 752.0 * u(rng);
      o.v = 480.0 * u(rng);
    }
  }
  DoctorReport report = Diagnose(r.Input());
  const DoctorFinding* f = report.Find(DoctorKind::kTrackJumps);
  ASSERT_NE(f, nullptr) << Told(report);
  EXPECT_EQ(f->sensor, "camera 0");
  // What jumps along its epipolar line is not seen.
  EXPECT_NEAR(f->estimate.value_or(0.0), 0.11, 0.025);
  const DoctorFinding* stereo = report.Find(DoctorKind::kStereoOutliers);
  ASSERT_NE(stereo, nullptr) << Told(report);
  EXPECT_NEAR(stereo->estimate.value_or(0.0), 0.11, 0.025);
  EXPECT_EQ(Serious(report), (std::vector<std::string>{"track_jumps", "stereo_outliers"}))
      << Told(report);
}

}  // namespace
}  // namespace glissade
