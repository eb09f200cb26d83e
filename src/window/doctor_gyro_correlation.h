// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "window/doctor.h"
#include "window/doctor_gyro_integral.h"

namespace glissade::internal {

/// What the rotation rates have in common at one offset.
struct GyroCorrelation {
  double proper = 0.0, mirrored = 0.0;  ///< -1 to 1
  double scale = 1.0;                   ///< camera's rotation over the sum of readings
  Matrix3 M = Matrix3::Zero();          ///< sum of body times camera', normalized
  double camera_rms = 0.0;
};

/// S: added to the camera's stamps (s). All zero for fewer than ten pairs.
GyroCorrelation CorrelationAt(const GyroIntegral& gyro, const std::vector<DoctorPair>& pairs,
                              double S);

}  // namespace glissade::internal
