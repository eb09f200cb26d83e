// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/judge.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "glissade/eval/absolute_error.h"
#include "glissade/eval/relative_error.h"

namespace glissade::app {

namespace {

using eval::AlignmentKind;

std::optional<eval::AbsoluteErrors> Aligned(const eval::MatchedTrajectories& matched,
                                            AlignmentKind kind) {
  const auto alignment = eval::Align(matched, {.kind = kind});
  if (!alignment.ok()) return {};
  eval::MatchedTrajectories moved = matched;
  eval::ApplyAlignment(*alignment, moved.estimate);
  auto errors = eval::ComputeAbsoluteErrors(moved);
  if (!errors.ok()) return {};
  return std::move(errors).value();
}

/// The whole first pose is taken for right without an IMU, its position and yaw with one.
std::optional<double> YawDrift(const eval::MatchedTrajectories& matched, bool has_imu) {
  if (matched.estimate.size() < 2) return {};
  const Pose& estimate = matched.estimate.front().T_w_b;
  const Pose& reference = matched.reference.front().T_w_b;
  eval::Alignment alignment;
  if (has_imu) {
    alignment = eval::AlignPose(estimate, reference);
  } else {
    alignment.T_r_e = reference * estimate.Inverse();
    alignment.T_r_e.Normalize();
  }
  const Pose last = alignment.Apply(matched.estimate.back().T_w_b);
  const Quaternion q(last.q() * matched.reference.back().T_w_b.q().conjugate());
  return std::abs(180.0 / std::numbers::pi *
                  eval::RotationAbout(q.coeffs().data(), Vector3(0.0, 0.0, 1.0)));
}

/// Half of the usual time between poses: that near to 1 s there is a pose.
std::int64_t HalfInterval(const eval::Trajectory& trajectory) {
  if (trajectory.size() < 2) return 0;
  const auto span = trajectory.back().stamp_ns - trajectory.front().stamp_ns;
  return span / (2 * static_cast<std::int64_t>(trajectory.size() - 1));
}

std::string Number(const std::optional<double>& value, int decimals, const char* unit) {
  return value ? fmt::format("{:.{}f} {}", *value, decimals, unit) : std::string("unknown");
}

}  // namespace

double DefaultLength(double path_m) {
  if (path_m >= 150.0) return 100.0;
  return path_m >= 15.0 ? 10.0 : 1.0;
}

eval::Trajectory ReferenceOf(const Viotracks& recording) {
  Pose T_z_w;
  if (recording.gravity.norm() > 0.0) {
    T_z_w = Pose(Quaternion::FromTwoVectors(Vector3(-recording.gravity), Vector3::UnitZ()),
                 Vector3(0.0, 0.0, 0.0));
  }
  eval::Trajectory reference;
  for (const GroundTruthState& state : recording.ground_truth) {
    Pose T = T_z_w * state.T_w_b;
    T.Normalize();
    reference.push_back({state.stamp_ns, T});
  }
  return reference;
}

bool OnFramesClock(const Viotracks& recording) {
  const auto& truth = recording.ground_truth;
  const auto known = [&](const ViotracksFrame& frame) {
    const auto at = std::lower_bound(
        truth.begin(), truth.end(), frame.stamp_ns,
        [](const GroundTruthState& state, std::int64_t t) { return state.stamp_ns < t; });
    return at != truth.end() && at->stamp_ns == frame.stamp_ns;
  };
  const auto count = std::count_if(recording.frames.begin(), recording.frames.end(), known);
  return 10 * count >= 9 * static_cast<std::ptrdiff_t>(recording.frames.size());
}

TrajectoryErrors Judge(const eval::Trajectory& estimate, const eval::Trajectory& reference,
                       const JudgeOptions& options) {
  TrajectoryErrors errors;
  errors.alignment = options.has_imu ? AlignmentKind::kYaw : AlignmentKind::kSe3;
  errors.rpe_length_m = options.rpe_length_m;
  const auto matched = eval::Associate(estimate, reference);
  if (!matched.ok()) return errors;
  errors.poses = matched->estimate.size();
  errors.path_m = eval::PathLength(matched->reference);
  if (!(errors.rpe_length_m > 0.0)) errors.rpe_length_m = DefaultLength(errors.path_m);

  if (const auto ate = Aligned(*matched, errors.alignment)) {
    errors.ate_m = ate->translation_m.rmse;
    errors.ate_yaw_deg = ate->yaw_deg.rmse;
  }
  if (const auto ate = Aligned(*matched, AlignmentKind::kSe3)) {
    errors.ate_se3_m = ate->translation_m.rmse;
  }
  if (const auto sim3 = eval::Align(*matched, {.kind = AlignmentKind::kSim3}); sim3.ok()) {
    errors.scale_error_percent = 100.0 * (1.0 / sim3->scale - 1.0);
  }
  const auto over_time = eval::RpeOverTime(
      *matched,
      {.tolerance_ns = std::max<std::int64_t>(100'000'000, HalfInterval(matched->estimate))});
  if (over_time.ok()) errors.rpe_1s_m = over_time->translation_m.rmse;
  const auto over_distance = eval::RpeOverDistance(*matched, {.lengths_m = {errors.rpe_length_m}});
  if (over_distance.ok()) errors.rpe_percent = over_distance->translation_percent.mean;
  errors.yaw_drift_deg = YawDrift(*matched, options.has_imu);
  return errors;
}

void AddErrors(const TrajectoryErrors& errors, nlohmann::ordered_json* json) {
  const auto add = [&](const char* key, const std::optional<double>& value) {
    (*json)[key] = value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  };
  add("ate_m", errors.ate_m);
  add("ate_yaw_deg", errors.ate_yaw_deg);
  add("rpe_1s_m", errors.rpe_1s_m);
  add("rpe_percent", errors.rpe_percent);
  add("ate_se3_m", errors.ate_se3_m);
  add("yaw_drift_deg", errors.yaw_drift_deg);
  add("scale_error_percent", errors.scale_error_percent);
  (*json)["alignment"] = eval::ToString(errors.alignment);
  (*json)["rpe_length_m"] = errors.rpe_length_m;
  (*json)["path_m"] = errors.path_m;
  (*json)["poses_judged"] = errors.poses;
}

std::string Describe(const TrajectoryErrors& e) {
  return fmt::format(
      "ATE {} ({} aligned), {} (SE(3) aligned); yaw {}, drift {}; scale {}\n"
      "RPE {} over 1 s, {} over {:g} m; {:.1f} m travelled\n",
      Number(e.ate_m, 4, "m"), eval::ToString(e.alignment), Number(e.ate_se3_m, 4, "m"),
      Number(e.ate_yaw_deg, 3, "deg"), Number(e.yaw_drift_deg, 3, "deg"),
      Number(e.scale_error_percent, 2, "%"), Number(e.rpe_1s_m, 4, "m"),
      Number(e.rpe_percent, 2, "%"), e.rpe_length_m, e.path_m);
}

}  // namespace glissade::app
