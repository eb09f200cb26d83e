// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Recordings broken on purpose: each has its finding and no other.
#include "glissade/window/data_doctor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "common/sanitized.h"
#include "window/doctor_findings.h"

namespace glissade {
namespace {

using test::kDegree;
using test::kQuick;
using test::Only;
using test::Serious;
using test::ShakenRecording;
using test::Shifted;
using test::Told;

TEST(DataDoctor, AHealthyRecordingHasNothing) {
  for (const double hz : {10.0, 20.0}) {
    ShakenRecording r(3, hz);
    const DoctorReport report = Diagnose(r.Input());
    EXPECT_TRUE(Serious(report).empty()) << Told(report);
    const DoctorFacts& f = report.facts;
    EXPECT_NEAR(f.imu_rate_hz, 200.0, 0.1);
    EXPECT_NEAR(f.frame_rate_hz, hz, 0.01);
    EXPECT_NEAR(f.duration_s, 12.0, 0.01);
    EXPECT_EQ(f.imu_coverage, 1.0);
    EXPECT_NEAR(f.quiet_accel, 9.81, 0.3);
    EXPECT_NEAR(f.gyro_noise_density / r.noise.gyro_noise_density, 1.0, 0.15);
    EXPECT_NEAR(f.accel_noise_density / r.noise.accel_noise_density, 1.0, 0.15);
    EXPECT_NEAR(f.pixel_noise, 1.0, 0.15);
    EXPECT_LT(f.outlier_share, 0.01);
    ASSERT_TRUE(f.time_offset_s && f.extrinsic_error && f.gyro_bias);
    EXPECT_NEAR(*f.time_offset_s, 0.0, 0.002);
    EXPECT_LT(f.extrinsic_error->norm(), 0.3 * kDegree);
    EXPECT_LT((*f.gyro_bias - Vector3(0.01, -0.006, 0.004)).norm(), 0.005);
  }
}

TEST(DataDoctor, NoFalseAlarms) {
  for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 20); ++seed) {
    ShakenRecording r(seed, seed % 2 == 0 ? 10.0 : 20.0);
    const DoctorReport report = Diagnose(r.Input(), {.max_frame_pairs = 60});
    EXPECT_TRUE(Serious(report).empty()) << seed << "\n" << Told(report);
  }
}

TEST(DataDoctor, TimeOffset) {
  for (const double S : {-0.11, 0.25}) {
    for (const double hz : {10.0, 20.0}) {
      ShakenRecording r(5, hz, 8.0);
      for (std::int64_t& stamp : r.stamps)
        stamp = Shifted(stamp, -S);  // S added gives IMU time
      DoctorReport report = Diagnose(r.Input());
      const DoctorFinding f = Only(report, DoctorKind::kTimeOffset);
      EXPECT_NEAR(f.estimate.value_or(0.0), S, 0.003) << hz;
      EXPECT_LT(f.sigma.value_or(1.0), 0.003);
      EXPECT_LT(std::abs(f.estimate.value_or(0.0) - S), 4.0 * f.sigma.value_or(0.0));
      EXPECT_GT(f.sigmas.value_or(0.0), 5.0);
      EXPECT_EQ(f.unit, "s");
      EXPECT_NE(f.message.find(S < 0.0 ? "late" : "early"), std::string::npos) << f.message;
    }
  }
}

TEST(DataDoctor, RotationOfTheExtrinsics) {
  for (const Vector3& d : {Vector3(0.0, 0.0, 4.0 * kDegree),
                           Vector3(-1.5 * kDegree, 2.0 * kDegree, 0.0), Vector3(0.5, 0.4, -0.3)}) {
    ShakenRecording r(6);
    for (WindowCamera& c : r.cameras)
      c.T_b_c = Pose(Matrix3(so3::Exp(d).transpose()), Vector3::Zero()) * c.T_b_c;
    DoctorReport report = Diagnose(r.Input());
    const DoctorFinding f = Only(report, DoctorKind::kExtrinsicRotation);
    ASSERT_TRUE(report.facts.extrinsic_error);
    const Matrix3 rest = so3::Exp(*report.facts.extrinsic_error).transpose() * so3::Exp(d);
    EXPECT_LT(so3::Log(rest).norm(), 0.5 * kDegree) << d.transpose();
    EXPECT_NEAR(f.estimate.value_or(0.0), d.norm() / kDegree, 0.5);
  }
}

TEST(DataDoctor, AxesOfTheGyroscope) {
  struct Case {
    Vector3 (*change)(const Vector3&);
    const char* name;
  };
  for (const Case& c :
       {Case{[](const Vector3& w) { return Vector3(w[1], -w[0], w[2]); }, "y, -x, z"},
        Case{[](const Vector3& w) { return Vector3(w[0], w[1], -w[2]); }, "x, y, -z"},
        Case{[](const Vector3& w) { return Vector3(w[0], w[2], w[1]); }, "x, z, y"},
        Case{[](const Vector3& w) { return Vector3(-w); }, "-x, -y, -z"}}) {
    ShakenRecording r(7);
    for (ImuSample& s : r.imu)
      s.gyro = c.change(s.gyro);
    const DoctorFinding f = Only(r, DoctorKind::kGyroAxes);
    EXPECT_NE(f.message.find(c.name), std::string::npos) << f.message;
  }
}

TEST(DataDoctor, UnitsOfTheGyroscope) {
  ShakenRecording r(8);
  for (ImuSample& s : r.imu)
    s.gyro /= kDegree;
  const DoctorFinding f = Only(r, DoctorKind::kGyroUnits);
  EXPECT_NEAR(f.estimate.value_or(0.0) / kDegree, 1.0, 0.02);
}

TEST(DataDoctor, ScaleOfTheGyroscope) {
  ShakenRecording r(9);
  for (ImuSample& s : r.imu)
    s.gyro *= 1.25;
  EXPECT_NEAR(Only(r, DoctorKind::kGyroScale).estimate.value_or(0.0), 0.8, 0.02);
}

TEST(DataDoctor, UnitsOfTheAccelerometer) {
  for (const double unit : {9.80665, 9.80665e-3}) {
    ShakenRecording r(10);
    for (ImuSample& s : r.imu)
      s.accel /= unit;
    EXPECT_NEAR(Only(r, DoctorKind::kAccelUnits).estimate.value_or(0.0) / unit, 1.0, 0.05);
  }
}

TEST(DataDoctor, Gravity) {
  ShakenRecording r(11);
  for (ImuSample& s : r.imu)
    s.accel *= 1.2;
  EXPECT_NEAR(Only(r, DoctorKind::kGravity).estimate.value_or(0.0), 1.2 * 9.81, 0.4);
  ShakenRecording up(11);
  up.gravity = Vector3(0.0, 0.0, 9.81);
  EXPECT_NE(Only(up, DoctorKind::kGravity).message.find("+z"), std::string::npos);
}

TEST(DataDoctor, NoiseDensities) {
  for (const double factor : {0.1, 0.3, 10.0}) {
    ShakenRecording r(12);
    const ImuNoise given = r.noise;
    r.noise.gyro_noise_density = factor * given.gyro_noise_density;
    DoctorFinding f = Only(r, DoctorKind::kGyroNoise);
    EXPECT_NEAR(f.estimate.value_or(0.0) * factor, 1.0, 0.3);
    EXPECT_NE(f.message.find(factor < 1.0 ? "dangerous" : "safe"), std::string::npos) << f.message;
    r.noise = given;
    r.noise.accel_noise_density = factor * given.accel_noise_density;
    f = Only(r, DoctorKind::kAccelNoise);
    EXPECT_NEAR(f.estimate.value_or(0.0) * factor, 1.0, 0.3);
  }
  ShakenRecording r(12);
  r.noise.accel_random_walk = 0.0;
  Only(r, DoctorKind::kBadNoise);
}

TEST(DataDoctor, PixelNoise) {
  ShakenRecording r(18);
  for (WindowCamera& c : r.cameras)
    c.sigma_px = 0.4;
  const DoctorFinding f = Only(r, DoctorKind::kPixelNoise);
  EXPECT_NEAR(f.estimate.value_or(0.0), 2.5, 0.4);
  EXPECT_NE(f.message.find("dangerous"), std::string::npos);
}

TEST(DataDoctor, StereoPair) {
  {
    ShakenRecording r(19);
    const Vector3 d(0.6 * kDegree, 0.0, 0.4 * kDegree);  // in the camera's axes
    r.cameras[1].T_b_c = r.cameras[1].T_b_c * Pose(so3::Exp(d), Vector3::Zero());
    const DoctorFinding f = Only(r, DoctorKind::kStereoExtrinsic);
    EXPECT_NEAR(f.estimate.value_or(0.0), d.norm() / kDegree, 0.1);
  }
  {
    ShakenRecording r(19);
    std::swap(r.cameras[0].T_b_c, r.cameras[1].T_b_c);
    EXPECT_GT(Only(r, DoctorKind::kStereoSwapped).estimate.value_or(0.0), 0.9);
  }
}

TEST(DataDoctor, GyroscopeOfAnotherRecording) {
  ShakenRecording r(20), other(21);
  for (std::size_t k = 0; k < r.imu.size(); ++k)
    r.imu[k].gyro = other.imu[r.imu.size() - 1 - k].gyro.cwiseAbs();
  const DoctorReport report = Diagnose(r.Input());
  EXPECT_EQ(report.Worst(), DoctorSeverity::kError) << Told(report);
}

TEST(DataDoctor, WhatMotionLeavesOpenIsNotClaimed) {
  ShakenRecording r(22, 10.0, 12.0, {.rate = 0.5, .planar = true});
  const DoctorReport report = Diagnose(r.Input());
  EXPECT_TRUE(Serious(report).empty()) << Told(report);
  ASSERT_TRUE(report.facts.time_offset_s);
  EXPECT_NEAR(*report.facts.time_offset_s, 0.0, 0.01);
  // Nobody turns: it says so.
  ShakenRecording still(22, 10.0, 12.0, {.rate = 0.0, .planar = false});
  const DoctorReport quiet = Diagnose(still.Input());
  EXPECT_TRUE(Serious(quiet).empty()) << Told(quiet);
  EXPECT_NE(quiet.Find(DoctorKind::kNotComparable), nullptr);
  EXPECT_FALSE(quiet.facts.time_offset_s);
}

TEST(DataDoctor, TheSameReportTwice) {
  ShakenRecording r(23);
  r.stamps[10] += 20'000'000;
  const DoctorReport a = Diagnose(r.Input(), kQuick), b = Diagnose(r.Input(), kQuick);
  EXPECT_EQ(Told(a), Told(b));
  EXPECT_EQ(a.facts.time_offset_s, b.facts.time_offset_s);
  EXPECT_EQ(a.facts.outlier_share, b.facts.outlier_share);
}

/// All numbers of a report are finite, and every finding says something.
void ExpectFinite(const DoctorReport& report) {
  for (const DoctorFinding& f : report.findings) {
    for (const auto& x : {f.sigmas, f.estimate, f.sigma})
      EXPECT_TRUE(!x || std::isfinite(*x)) << f.message;
    EXPECT_FALSE(f.message.empty());
    // Those two quote what was given.
    if (f.kind == DoctorKind::kBadCamera || f.kind == DoctorKind::kBadNoise) continue;
    EXPECT_EQ(f.message.find("nan"), std::string::npos) << f.message;
  }
  const DoctorFacts& f = report.facts;
  for (const double x :
       {f.imu_rate_hz, f.imu_jitter_s, f.imu_longest_s, f.frame_rate_hz, f.frame_jitter_s,
        f.frame_longest_s, f.duration_s, f.imu_coverage, f.quiet_accel, f.gyro_noise_density,
        f.accel_noise_density, f.tracks_per_frame, f.outlier_share, f.pixel_noise}) {
    EXPECT_TRUE(std::isfinite(x));
  }
  EXPECT_TRUE(f.mean_accel.allFinite());
}

TEST(DataDoctor, NothingIsTooBroken) {
  ExpectFinite(Diagnose({}));
  std::mt19937_64 rng(3);
  const double odd[] = {0.0,
                        -1.0,
                        1e-300,
                        1e300,
                        -1e7,
                        9e6,
                        std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity()};
  const auto number = [&] { return odd[rng() % std::size(odd)]; };
  for (int trial = 0; trial < 60; ++trial) {
    ShakenRecording r(24, 10.0, 3.0);
    const std::uint64_t every = 1 + rng() % 40;
    for (ImuSample& s : r.imu) {
      if (rng() % every == 0) s.stamp_ns = static_cast<std::int64_t>(rng());
      if (rng() % every == 0) s.gyro[static_cast<int>(rng() % 3)] = number();
      if (rng() % every == 0) s.accel[static_cast<int>(rng() % 3)] = number();
    }
    for (std::int64_t& stamp : r.stamps) {
      if (rng() % every == 0) stamp = static_cast<std::int64_t>(rng());
    }
    for (auto& frame : r.observations) {
      if (rng() % every == 0) frame.clear();
      for (FrameObservation& o : frame) {
        if (rng() % every == 0) o.u = number();
        if (rng() % every == 0) o.track = static_cast<std::int64_t>(rng());
        if (rng() % every == 0) o.camera = static_cast<int>(rng() % 5) - 1;
      }
    }
    if (trial % 3 == 0) r.cameras[rng() % 2].fx = number();
    if (trial % 4 == 0) r.cameras[rng() % 2].sigma_px = number();
    if (trial % 5 == 0) r.cameras[1].T_b_c = Pose();
    if (trial % 5 == 1) r.noise.gyro_noise_density = number();
    if (trial % 7 == 0) r.gravity[2] = number();
    if (trial % 7 == 1) r.rate_hz = number();
    if (trial % 6 == 0) r.sizes.pop_back();
    ExpectFinite(Diagnose(r.Input(), {.max_time_offset_s = number(), .max_frame_pairs = 20}));
  }
}

}  // namespace
}  // namespace glissade
