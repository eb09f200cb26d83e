// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/window/observation.h"

/// \file
/// The data doctor: what is wrong with a visual-inertial recording, found before any solve.
/// docs/data_doctor.md says how each finding is measured and what to do about it.
namespace glissade {

enum class DoctorSeverity : std::uint8_t {
  kInfo,     ///< good to know; a healthy recording has these too
  kWarning,  ///< costs accuracy, or is worth a look
  kError,    ///< an estimator fails, or is wrong and does not know it
};

/// What a finding is about.
enum class DoctorKind : std::uint8_t {
  // The two sensors against each other.
  kTimeOffset,         ///< camera stamps are early or late against the IMU's
  kGyroUnits,          ///< degrees for radians
  kGyroScale,          ///< rotates more or less than the camera sees
  kGyroAxes,           ///< axes exchanged or reversed
  kExtrinsicRotation,  ///< of T_b_c
  kFrameOutsideImu,
  kNotComparable,  ///< too little rotation, or too few tracks, to compare them
  // IMU.
  kNoImu,
  kBadNoise,  ///< densities that are not positive
  kImuNotFinite,
  kImuOutOfOrder,
  kImuSwappedStamps,
  kImuDuplicateStamp,
  kImuGap,
  kImuJitter,
  kImuRate,  ///< not the one that was given
  kImuStuck,
  kImuRepeated,  ///< sampled and held
  kImuSaturated,
  kAccelUnits,  ///< g for m/s^2, and such
  kGravity,     ///< magnitude against the mean specific force; sign
  kGyroNoise,
  kAccelNoise,
  // Frames.
  kNoFrames,
  kFrameOutOfOrder,
  kFrameSwappedStamps,
  kFrameDuplicateStamp,
  kFrameGap,
  kFrameJitter,
  // Cameras and tracks.
  kNoTracks,
  kBadCamera,
  kUnknownCamera,
  kPixelNotFinite,
  kDuplicateObservation,
  kOutsideImage,
  kFewTracks,
  kShortTracks,
  kTrackJumps,
  kPixelNoise,
  kStereoSwapped,    ///< points lie behind the cameras
  kStereoExtrinsic,  ///< rotation between the two, or rectification
  kStereoOutliers,
};

/// "info", "warning", "error".
std::string_view ToString(DoctorSeverity severity);
/// "time_offset", "gyro_units", ...: the enumerator's name in small letters.
std::string_view ToString(DoctorKind kind);

/// One thing that was found. All numbers are finite.
struct DoctorFinding {
  DoctorKind kind = DoctorKind::kNoImu;
  DoctorSeverity severity = DoctorSeverity::kInfo;
  std::string sensor;                    ///< "imu", "gyro x", "camera 0", "frames", ...
  std::optional<std::int64_t> stamp_ns;  ///< where it is, or where it is worst
  std::int64_t count = 0;                ///< samples, frames or observations concerned, 0: no count
  /// How far from healthy, in standard deviations of what was measured; absent where it was
  /// counted, and so is certain.
  std::optional<double> sigmas;
  std::optional<double> estimate;  ///< the quantity at fault, in `unit`
  std::optional<double> sigma;     ///< of the estimate
  std::string unit;                ///< "s", "deg", "px", "" for a factor or share
  std::string message;             ///< what was found: one line
  std::string advice;              ///< what to do: one line
};

/// Facts that were measured on the way; 0 where there was nothing to measure.
struct DoctorFacts {
  double imu_rate_hz = 0.0;    ///< of the median interval
  double imu_jitter_s = 0.0;   ///< rms of intervals about their median, gaps apart
  double imu_longest_s = 0.0;  ///< longest interval
  double frame_rate_hz = 0.0;
  double frame_jitter_s = 0.0;
  double frame_longest_s = 0.0;
  double duration_s = 0.0;               ///< first to last frame, or IMU sample without frames
  double imu_coverage = 0.0;             ///< share of frames inside the IMU's time
  Vector3 mean_accel = Vector3::Zero();  ///< mean specific force in B (m/s^2 as recorded)
  double quiet_accel = 0.0;              ///< |specific force| where it is quietest
  double gyro_noise_density = 0.0;       ///< measured, rad/s/sqrt(Hz)
  double accel_noise_density = 0.0;      ///< measured, m/s^2/sqrt(Hz)
  double tracks_per_frame = 0.0;         ///< median over frames and cameras
  std::vector<std::int64_t> length_histogram;  ///< [n]: tracks seen in n frames; the last: or more
  double median_track_length = 0.0;            ///< frames
  double outlier_share = 0.0;  ///< of the observations, by epipolar geometry of frames
  double pixel_noise = 0.0;    ///< measured sigma over the given one
  int frame_pairs = 0;         ///< pairs of images with a relative rotation
  /// Seconds to be added to camera stamps to get IMU time, and its sigma; absent where the two
  /// cannot be compared.
  std::optional<double> time_offset_s, time_offset_sigma_s;
  /// Rotation of camera 0 in the body as gyroscope and tracks have it, against the given one: the
  /// rotation vector d (body axes, rad) with R_b_c (measured) = Exp(d) R_b_c (given).
  std::optional<Vector3> extrinsic_error;
  std::optional<Vector3> gyro_bias;  ///< rad/s
};

struct DoctorReport {
  std::vector<DoctorFinding> findings;  ///< worst first
  DoctorFacts facts;

  /// The worst of the findings; kInfo where there are none.
  [[nodiscard]] DoctorSeverity Worst() const;
  /// The first of a kind, null where there is none.
  [[nodiscard]] const DoctorFinding* Find(DoctorKind kind) const;
};

struct DoctorImageSize {
  int width = 0, height = 0;  ///< px
};

/// A recording as it was recorded: nothing is expected of it.
struct DoctorInput {
  std::span<const ImuSample> imu;  ///< in the order of the file
  std::optional<ImuNoise> imu_noise;
  double imu_rate_hz = 0.0;                      ///< as given; 0: not given
  std::span<const FrameObservations> frames;     ///< in the order of the file
  std::span<const WindowCamera> cameras;         ///< empty: no vision
  std::span<const DoctorImageSize> image_sizes;  ///< one a camera, or empty
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);    ///< in W
};

struct DoctorOptions {
  double max_time_offset_s = 0.5;  ///< searched on both sides
  int max_frame_pairs = 300;       ///< of one camera, evenly over the recording
  std::uint64_t seed = 1;          ///< of the random samples of tracks
};

/// Looks for everything that DoctorKind lists. Total: whatever the input, it returns, and no number
/// of the report is NaN or infinite. The same input and options give the same report.
///
/// Sign of the time offset: S is what has to be added to camera stamps to get IMU time, so that a
/// camera whose stamps are late has S < 0.
[[nodiscard]] DoctorReport Diagnose(const DoctorInput& input, const DoctorOptions& options = {});

}  // namespace glissade
