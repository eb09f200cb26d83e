// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/consistency.h"

#include <Eigen/Core>
#include <cmath>

#include "glissade/eval/alignment.h"
#include "glissade/eval/association.h"
#include "glissade/eval/nees.h"
#include "glissade/lie/so3.h"
#include "replay/judge.h"

namespace glissade::app {

namespace {

/// Further apart than this, two true poses do not tell what was between them.
constexpr std::int64_t kMaxGapNs = 100'000'000;

/// A pose of a run and the true one, in the world of the truth, as seen from the window's oldest
/// frame.
struct SeenFromOldest {
  Pose T_r_w, estimate, truth;
};
std::optional<SeenFromOldest> SeeFromOldest(const FrameEstimate& estimate,
                                            const eval::Trajectory& truth, std::int64_t shift,
                                            bool has_imu) {
  const auto oldest = eval::PoseAt(truth, estimate.oldest.stamp_ns - shift, kMaxGapNs);
  const auto newest = eval::PoseAt(truth, estimate.state.stamp_ns - shift, kMaxGapNs);
  if (!oldest || !newest) return {};
  const Pose T_r_w = has_imu ? eval::AlignPose(estimate.oldest.T_w_b, *oldest).T_r_e
                             : *oldest * estimate.oldest.T_w_b.Inverse();
  return SeenFromOldest{T_r_w, T_r_w * estimate.state.T_w_b, *newest};
}

}  // namespace

std::optional<std::array<double, 3>> ErrorFromOldest(const FrameEstimate& estimate,
                                                     const eval::Trajectory& truth, bool has_imu) {
  const auto seen = SeeFromOldest(estimate, truth, 0, has_imu);
  if (!seen) return {};
  const Vector3 e = seen->T_r_w.q().conjugate() * (seen->estimate.p() - seen->truth.p());
  return std::array<double, 3>{e[0], e[1], e[2]};
}

std::optional<Consistency> ConsistencyOf(const CausalRun& run, const Viotracks& recording,
                                         double time_offset_s, bool has_imu) {
  const eval::Trajectory truth = ReferenceOf(recording);
  const std::int64_t shift = std::llround(1e9 * time_offset_s);
  Consistency c;
  for (const FrameEstimate& estimate : run.estimates) {
    const auto seen = SeeFromOldest(estimate, truth, shift, has_imu);
    if (!seen) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(
        estimate.pose_covariance.data());
    const Eigen::Vector3d p = seen->estimate.p() - seen->truth.p();
    const Eigen::Vector3d theta =
        so3::Log(Quaternion(seen->truth.q().conjugate() * seen->estimate.q()));
    const Eigen::Matrix3d R = seen->T_r_w.R();
    const Eigen::Matrix3d P_position = R * P.topLeftCorner<3, 3>() * R.transpose();
    const Eigen::Matrix3d P_rotation = P.bottomRightCorner<3, 3>();
    const auto position = eval::Nees(p, P_position);
    const auto rotation = eval::Nees(theta, P_rotation);
    if (!position.ok() || !rotation.ok()) continue;  // the oldest frame itself, or no covariance
    c.nees_position += *position;
    c.nees_rotation += *rotation;
    ++c.frames;
  }
  if (c.frames == 0) return {};
  c.nees_position /= static_cast<double>(c.frames);
  c.nees_rotation /= static_cast<double>(c.frames);
  return c;
}

}  // namespace glissade::app
