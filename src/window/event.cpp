// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/event.h"

namespace glissade {

std::string_view ToString(WindowEvent event) {
  switch (event) {
    case WindowEvent::kInitialized:
      return "initialized";
    case WindowEvent::kKeyframe:
      return "keyframe";
    case WindowEvent::kObservationRefused:
      return "observation refused";
    case WindowEvent::kObservationRejected:
      return "observation rejected";
    case WindowEvent::kLandmarkTriangulated:
      return "landmark triangulated";
    case WindowEvent::kLandmarkMarginalized:
      return "landmark marginalized";
    case WindowEvent::kLandmarkStarved:
      return "landmark starved";
    case WindowEvent::kFrameWithoutLandmarks:
      return "frame without landmarks";
    case WindowEvent::kImuSampleRefused:
      return "imu sample refused";
    case WindowEvent::kImuSaturated:
      return "imu saturated";
    case WindowEvent::kImuGap:
      return "imu gap";
    case WindowEvent::kImuTermReplaced:
      return "imu term replaced";
    case WindowEvent::kStandingStill:
      return "standing still";
    case WindowEvent::kSolveFailed:
      return "solve failed";
    case WindowEvent::kReset:
      return "reset";
    case WindowEvent::kFrameRefused:
      return "frame refused";
    case WindowEvent::kCameraWithoutFeatures:
      return "camera without features";
  }
  return "unknown";
}

}  // namespace glissade
