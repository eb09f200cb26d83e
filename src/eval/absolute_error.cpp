// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/absolute_error.h"

#include <cmath>
#include <numbers>

#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "glissade/eval/alignment.h"
#include "glissade/lie/so3.h"

namespace glissade::eval {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

PoseError ErrorOf(const StampedPose& estimate, const StampedPose& reference, const Vector3& u) {
  PoseError error;
  error.stamp_ns = estimate.stamp_ns;
  const Vector3 dp = estimate.T_w_b.p() - reference.T_w_b.p();
  for (int i = 0; i < 3; ++i)
    error.translation[i] = dp[i];
  const auto q_est = estimate.T_w_b.q(), q_ref = reference.T_w_b.q();
  error.rotation_deg = kDegrees * so3::Log(Quaternion(q_ref.conjugate() * q_est)).norm();
  const Quaternion in_world(q_est * q_ref.conjugate());
  error.yaw_deg = kDegrees * RotationAbout(in_world.coeffs().data(), u);
  return error;
}

Result<AbsoluteErrors> Compute(const MatchedTrajectories& matched, const Vector3& u) {
  AbsoluteErrors errors;
  std::vector<double> translations, rotations, yaws;
  for (std::size_t k = 0; k < matched.estimate.size(); ++k) {
    const PoseError e = ErrorOf(matched.estimate[k], matched.reference[k], u);
    errors.poses.push_back(e);
    const double* t = e.translation;
    translations.push_back(std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
    rotations.push_back(e.rotation_deg);
    yaws.push_back(std::abs(e.yaw_deg));
  }
  errors.translation_m = StatisticsOf(translations);
  errors.rotation_deg = StatisticsOf(rotations);
  errors.yaw_deg = StatisticsOf(yaws);
  if (!std::isfinite(errors.translation_m.rmse)) {
    return Status(StatusCode::kNotFinite, "absolute errors: the squares overflow");
  }
  return errors;
}

}  // namespace

Result<AbsoluteErrors> ComputeAbsoluteErrors(const MatchedTrajectories& matched,
                                             const AbsoluteErrorOptions& options) {
  if (Status s = matched.Validate(); !s.ok()) return s;
  if (Status s = ValidateFinite(options.vertical.data(), 3, "vertical"); !s.ok()) return s;
  const Vector3 u = options.vertical.stableNormalized();
  if (!(u.norm() > 0.5)) {
    return Status(StatusCode::kInvalidArgument, "absolute errors: the vertical has no direction");
  }
  if (matched.estimate.empty()) {
    return Status(StatusCode::kInvalidArgument, "absolute errors: there is no pose");
  }
  return internal::OrOutOfMemory([&] { return Compute(matched, u); });
}

}  // namespace glissade::eval
