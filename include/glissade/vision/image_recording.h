// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/io/euroc.h"
#include "glissade/vision/camera.h"

/// \file
/// Recordings of images, of a camera or a stereo pair, with or without an IMU, in the layouts of
/// the data sets that people have.
namespace glissade::vision {

/// What the cameras saw at one instant.
struct ImageFrame {
  std::int64_t stamp_ns = 0;
  /// One for each camera; empty: this camera has no image of this instant.
  std::vector<std::string> files;
};

struct ImageRecording {
  std::string layout;  ///< "EuRoC" or "KITTI odometry"
  std::vector<Camera> cameras;
  std::vector<ImageFrame> frames;     ///< stamps increase
  std::optional<ImuNoise> imu_noise;  ///< absent: there is no IMU
  double imu_rate_hz = 0.0;
  std::vector<ImuSample> imu;  ///< in axes of the body; as recorded
  /// T_W_B of the body that T_b_c are about; stamps increase; may be empty.
  std::vector<GroundTruthState> ground_truth;
};

/// Reads the calibration, stamps, IMU and truth of a recording; images are left to ReadImage, but
/// that their files are there is seen to here. By what the folder holds:
///
/// - **EuRoC** (Burri et al., IJRR 2016) and **TUM-VI** (Schubert et al., IROS 2018) in its export:
///   mav0/ (or what is in it) with cam0, perhaps cam1, each data.csv, data/ and sensor.yaml
///   (pinhole with radial-tangential or equidistant distortion, or none); perhaps imu0;
///   state_groundtruth_estimate0, or mocap0, as truth. Where a camera has no sensor.yaml, Kalibr's
///   dso/camchain.yaml beside mav0 speaks for it, and dso/imu_config.yaml for the IMU.
///   The body is the IMU; a sensor.yaml of the IMU whose T_BS is not the identity is refused.
/// - **KITTI odometry** (Geiger et al., CVPR 2012): image_0, perhaps image_1, calib.txt, times.txt;
///   perhaps poses.txt as truth. The body is the left camera; rectified, no IMU.
///
/// Of a stereo pair at least a tenth of the frames must have both images, at the same stamp.
///
/// kIoError where a file that must be there is not, among them any image that is named; kParseError
/// with "file:line: what" for what is in them.
/// At most `max_cameras` cameras, 1 or 2: of others nothing is looked at.
[[nodiscard]] Result<ImageRecording> ReadImageRecording(const std::string& folder,
                                                        int max_cameras = 2);

/// Writes everything but the images of a recording in EuRoC's layout: mav0/ and in it data.csv and
/// sensor.yaml of each sensor, and the truth. Images are expected at ImagePath. kInvalidArgument,
/// and nothing written, for what ReadImageRecording would not take back.
Status WriteEurocRecording(const ImageRecording& recording, const std::string& folder);

/// "FOLDER/mav0/cam0/data/1403638538577829376.png"
[[nodiscard]] std::string EurocImagePath(const std::string& folder, int camera,
                                         std::int64_t stamp_ns, const std::string& ending = "png");

}  // namespace glissade::vision
