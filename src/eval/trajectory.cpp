// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/trajectory.h"

#include <algorithm>
#include <string>

#include "eval/elapsed.h"
#include "glissade/base/validate.h"
#include "glissade/lie/so3.h"

namespace glissade::eval {

namespace {

std::string Named(std::string_view what, std::size_t k) {
  return std::string(what).append(": pose ").append(std::to_string(k));
}

}  // namespace

Status ValidateTrajectory(std::span<const StampedPose> trajectory, std::string_view what) {
  for (std::size_t k = 0; k < trajectory.size(); ++k) {
    const StampedPose& x = trajectory[k];
    if (k > 0 && x.stamp_ns <= trajectory[k - 1].stamp_ns) {
      return {StatusCode::kInvalidArgument,
              Named(what, k)
                  .append(": stamp ")
                  .append(std::to_string(x.stamp_ns))
                  .append(" is not later than ")
                  .append(std::to_string(trajectory[k - 1].stamp_ns))};
    }
    if (Status s = ValidatePose(x.T_w_b.data, ""); !s.ok()) {
      return ValidatePose(x.T_w_b.data, Named(what, k));
    }
  }
  return {};
}

double PathLength(std::span<const StampedPose> trajectory) {
  double length = 0.0;
  for (std::size_t k = 1; k < trajectory.size(); ++k)
    length += (trajectory[k].T_w_b.p() - trajectory[k - 1].T_w_b.p()).norm();
  return length;
}

StampedPose Interpolate(const StampedPose& a, const StampedPose& b, std::int64_t stamp_ns) {
  const std::int64_t stamp = std::clamp(stamp_ns, a.stamp_ns, std::max(a.stamp_ns, b.stamp_ns));
  // The neighbours themselves, to the bit.
  if (stamp == a.stamp_ns) return {stamp, a.T_w_b};
  if (stamp == b.stamp_ns) return {stamp, b.T_w_b};
  const double u = static_cast<double>(internal::Elapsed(a.stamp_ns, stamp)) /
                   static_cast<double>(internal::Elapsed(a.stamp_ns, b.stamp_ns));
  const Vector3 p = (1.0 - u) * a.T_w_b.p() + u * b.T_w_b.p();
  const Vector3 turn = so3::Log(Quaternion(a.T_w_b.q().conjugate() * b.T_w_b.q()));
  StampedPose x{stamp, Pose(Quaternion(a.T_w_b.q() * so3::ExpQuaternion(Vector3(u * turn))), p)};
  x.T_w_b.Normalize();
  return x;
}

}  // namespace glissade::eval
