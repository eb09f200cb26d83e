// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "glissade/window/data_doctor.h"
#include "window/doctor_two_view.h"

/// \file
/// What the parts of the data doctor share: the recording once what cannot be used has been taken
/// out and put in order of time, and how a finding is made. The parts run in the order in which
/// they are declared; each reads what those before it have found.
namespace glissade::internal {

/// A reading that can be used, in seconds since DoctorCase::origin_ns.
struct DoctorSample {
  double t = 0.0;
  Vector3 gyro = Vector3::Zero();
  Vector3 accel = Vector3::Zero();
};

/// An observation that can be used: finite, of a camera that is one, once in its frame and camera.
struct DoctorFeature {
  std::int64_t track = 0;
  double x = 0.0, y = 0.0;  ///< (x/z, y/z)
};

/// A frame that can be used.
struct DoctorFrame {
  double t = 0.0;
  std::int64_t stamp_ns = 0;
  std::vector<std::vector<DoctorFeature>> features;  ///< by camera; in the order of tracks
};

/// Relative rotation of one camera between two frames, from its tracks.
struct DoctorPair {
  int camera = 0;
  int from = 0, to = 0;  ///< frames
  double t0 = 0.0, t1 = 0.0;
  Vector3 phi = Vector3::Zero();  ///< Log(R_c0_c1)
  Matrix3 covariance = Matrix3::Zero();
  int matches = 0, outliers = 0;
  double noise = 0.0;                  ///< sigma of what fits over the expected one
  std::vector<TwoViewMatch> some;      ///< matches, not more than 80
  Vector3 t = Vector3(1.0, 0.0, 0.0);  ///< direction: x1 ~ R_c1_c0 x0 + t
};

/// A recording being looked at.
struct DoctorCase {
  DoctorCase(const DoctorInput& recording, const DoctorOptions& chosen)
      : input(recording), options(chosen) {}

  const DoctorInput& input;
  DoctorOptions options;  ///< made sensible
  DoctorReport report;

  std::int64_t origin_ns = 0;
  std::vector<DoctorSample> imu;  ///< in order of time; without duplicates
  std::vector<DoctorFrame> frames;
  std::vector<bool> camera_ok;
  double imu_dt = 0.0;       ///< median interval, s; 0: no IMU that can be used
  double imu_max_gap = 0.0;  ///< s: a longer interval is no motion that was seen
  double accel_unit = 1.0;   ///< m/s^2 a unit of the recording
  double gyro_unit = 1.0;    ///< rad/s a unit of the recording
  std::vector<DoctorPair> pairs;

  /// Seconds since origin_ns.
  [[nodiscard]] double Seconds(std::int64_t stamp_ns) const;
  /// The stamp nearest to a time of the IMU or of the frames.
  [[nodiscard]] std::int64_t Stamp(double t) const;

  DoctorFinding& Add(DoctorKind kind, DoctorSeverity severity, std::string sensor,
                     std::string message, std::string advice);
};

#if defined(__GNUC__)
#define GLISSADE_PRINTF __attribute__((format(printf, 1, 2)))
#else
#define GLISSADE_PRINTF
#endif
/// As printf.
[[nodiscard]] std::string Text(const char* format, ...) GLISSADE_PRINTF;
#undef GLISSADE_PRINTF

/// A camera in a finding.
inline std::string CameraName(std::size_t camera) {
  return Text("camera %zu", camera);
}

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< rad

/// p-th part of the values, 0 where there are none. Reorders them.
double QuantileOf(std::vector<double>* values, double p);

/// IMU: values that are none; then stamps. Fills imu, imu_dt.
void CheckImuValues(DoctorCase* c);
void CheckImuStamps(DoctorCase* c);
/// Frames: stamps, and whether the IMU covers them.
void CheckFrameStamps(DoctorCase* c);
/// Observations one by one; then how many there are and how long tracks are. Fills frames.
void CheckObservations(DoctorCase* c);
void CheckTrackCounts(DoctorCase* c);
/// Units of the accelerometer, gravity. Fills accel_unit.
void CheckGravity(DoctorCase* c);
/// Tracks that jump, and pixel noise. Fills pairs.
void CheckTrackGeometry(DoctorCase* c);
void CheckStereo(DoctorCase* c);
/// Gyroscope against tracks: units, axes, T_b_c, time offset. Fills gyro_unit.
void CheckGyroAgainstTracks(DoctorCase* c);
/// Values of the IMU that repeat: stuck, held, saturated.
void CheckImuRepetition(DoctorCase* c);
void CheckImuNoise(DoctorCase* c);

}  // namespace glissade::internal
