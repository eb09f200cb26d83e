// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/io/euroc.h"
#include "glissade/lie/pose.h"

/// \file
/// VIOTRACKS: a recorded visual(-inertial) run with feature tracks. A folder with calibration.json,
/// frames.csv, tracks.csv, and, where there are such things, imu.csv and groundtruth.csv; every
/// .csv may be a .csv.gz.
namespace glissade {

/// Pinhole without distortion: u = fx X/Z + cx, v = fy Y/Z + cy. A rectified stereo pair is two.
struct ViotracksCamera {
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;  ///< px
  int width = 1, height = 1;                      ///< px
  double sigma_px = 1.0;                          ///< of an observation, each coordinate
  Pose T_b_c;                                     ///< camera in body
};

struct ViotracksFrame {
  std::int32_t id = 0;
  std::int64_t stamp_ns = 0;
};

/// One feature in one image; undistorted pixels. May be an outlier.
struct ViotracksObservation {
  std::int32_t frame = 0;  ///< index in frames, not its id
  std::int32_t track = 0;
  std::int32_t camera = 0;
  double u = 0.0, v = 0.0;  ///< px
};

struct Viotracks {
  std::string origin;                          ///< where the data is from
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);  ///< acceleration in the world, m/s^2
  std::vector<ViotracksCamera> cameras;
  std::optional<ImuNoise> imu_noise;  ///< absent: there is no IMU
  double imu_rate_hz = 0.0;
  std::vector<ImuSample> imu;          ///< as recorded; ImuBuffer sorts out what is wrong with it
  std::vector<ViotracksFrame> frames;  ///< ids and stamps increase
  std::vector<ViotracksObservation> tracks;
  std::vector<GroundTruthState> ground_truth;  ///< stamps increase; may be empty

  /// What ReadViotracks would not take back: a camera that is none, ids or stamps that do not
  /// increase, an observation in a frame or camera that does not exist, a number that is not
  /// finite, an IMU without samples or samples without an IMU, ground truth with speeds and biases
  /// at some stamps only.
  [[nodiscard]] Status Validate() const;
};

/// Reads a folder. All or nothing: kIoError where a file that must be there cannot be opened, else
/// kParseError with "file:line: what was expected, what was found".
///
/// Reading::kAsRecorded hands on what the data doctor is to judge: stamps and ids of frames in any
/// order, numbers that are none, cameras that do not exist, an IMU without samples; the ground
/// truth is not read. WriteViotracks would refuse such a recording.
[[nodiscard]] Result<Viotracks> ReadViotracks(const std::string& folder,
                                              Reading reading = Reading::kChecked);

/// Writes calibration.json and .csv.gz tables to a folder, which is made where its parent exists;
/// numbers have as few digits as read back to the same bits. Each file appears whole or not at all;
/// tables that another recording has left there are removed. Refuses what ReadViotracks would not
/// take back; then nothing is written.
Status WriteViotracks(const Viotracks& recording, const std::string& folder);

}  // namespace glissade
