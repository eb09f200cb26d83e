// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/base/status.h"
#include "glissade/imu/noise.h"
#include "glissade/vision/camera.h"

/// \file
/// Calibrations of sensors in YAML. kIoError where the file cannot be opened, else kParseError with
/// "file:line: what".
namespace glissade::vision::internal {

/// EuRoC's cam0/sensor.yaml.
Result<Camera> ReadCameraYaml(const std::string& path);

struct ImuCalibration {
  ImuNoise noise;
  double rate_hz = 0.0;
};
/// EuRoC's imu0/sensor.yaml; Kalibr's imu.yaml, whose keys are the same but for the first.
Result<ImuCalibration> ReadImuYaml(const std::string& path);

/// Kalibr's camchain.yaml: camera k of it.
Result<Camera> ReadKalibrCamera(const std::string& path, int k);

}  // namespace glissade::vision::internal
