// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/init_verdict.h"

#include "glissade/base/validate.h"

namespace glissade {

std::string_view ToString(InitReason reason) {
  switch (reason) {
    case InitReason::kOk:
      return "ok";
    case InitReason::kInvalidInput:
      return "invalid input";
    case InitReason::kNotFinite:
      return "not finite";
    case InitReason::kTooFewSamples:
      return "too few IMU samples";
    case InitReason::kImuGap:
      return "IMU gap";
    case InitReason::kImuSaturated:
      return "IMU saturated";
    case InitReason::kWrongGravity:
      return "wrong gravity";
    case InitReason::kMoving:
      return "moving";
    case InitReason::kTooFewFrames:
      return "too few frames";
    case InitReason::kTooFewTracks:
      return "too few tracks";
    case InitReason::kStandingStill:
      return "standing still";
    case InitReason::kRotationOnly:
      return "rotation only";
    case InitReason::kNoAcceleration:
      return "no acceleration";
    case InitReason::kNotConverged:
      return "not converged";
  }
  return "?";
}

Status InitVerdict::ToStatus() const {
  switch (reason) {
    case InitReason::kOk:
      return {};
    case InitReason::kNotFinite:
      return {StatusCode::kNotFinite, message};
    case InitReason::kStandingStill:
    case InitReason::kRotationOnly:
    case InitReason::kNoAcceleration:
      return {StatusCode::kSingular, message};
    default:
      return {StatusCode::kInvalidArgument, message};
  }
}

Status ImuBiasPrior::Validate() const {
  if (Status s = ValidateFinite(mean.ba.data(), 3, "accelerometer bias"); !s.ok()) return s;
  if (Status s = ValidateFinite(mean.bg.data(), 3, "gyroscope bias"); !s.ok()) return s;
  if (Status s = ValidatePositive(accel_sigma, "accel_sigma"); !s.ok()) return s;
  return ValidatePositive(gyro_sigma, "gyro_sigma");
}

}  // namespace glissade
