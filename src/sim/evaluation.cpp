// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/evaluation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glissade/lie/so3.h"

namespace glissade::sim {

namespace {

double AngleBetween(const VertexPose& a, const VertexPose& b) {
  return so3::Log(Quaternion(a.pose.q().conjugate() * b.pose.q())).norm();
}

eval::Alignment AlignedToFirst(const ViStates& estimate, const ViStates& truth) {
  return eval::AlignPose(estimate.poses[0].pose, truth.poses[0].pose);
}

}  // namespace

ViStates Moved(const ViStates& states, const eval::Alignment& motion) {
  const Pose& g = motion.T_r_e;
  const Matrix3 R = g.R();
  ViStates moved = states;
  for (VertexPose& x : moved.poses) {
    x.pose = g * x.pose;
    x.pose.Normalize();
  }
  for (VertexSpeedBias& x : moved.speed_biases)
    x.v() = Vector3(R * x.v());
  for (VertexPointXYZ& x : moved.points)
    x.p() = g * Vector3(x.p());
  return moved;
}

Result<ViErrors> AlignedErrors(const ViStates& estimate, const ViStates& truth) {
  const std::size_t n = truth.poses.size();
  if (n == 0 || estimate.poses.size() != n || estimate.speed_biases.size() != n ||
      truth.speed_biases.size() != n) {
    return Status(StatusCode::kInvalidArgument, "estimate and truth differ in number");
  }
  const ViStates x = Moved(estimate, AlignedToFirst(estimate, truth));
  double p = 0.0, theta = 0.0, v = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    p += (x.poses[k].pose.p() - truth.poses[k].pose.p()).squaredNorm();
    v += (x.speed_biases[k].v() - truth.speed_biases[k].v()).squaredNorm();
    const double angle = AngleBetween(x.poses[k], truth.poses[k]);
    theta += angle * angle;
  }
  const auto rms = [&](double sum) { return std::sqrt(sum / static_cast<double>(n)); };
  return ViErrors{rms(p), 180.0 / std::numbers::pi * rms(theta), rms(v)};
}

ViDifference Difference(const ViStates& a, const ViStates& b) {
  ViDifference most;
  for (std::size_t k = 0; k < a.poses.size() && k < b.poses.size(); ++k) {
    const Vector3 dp = a.poses[k].pose.p() - b.poses[k].pose.p();
    const Vector3 dv = a.speed_biases[k].v() - b.speed_biases[k].v();
    most.position_m = std::max(most.position_m, dp.cwiseAbs().maxCoeff());
    most.velocity_mps = std::max(most.velocity_mps, dv.cwiseAbs().maxCoeff());
    most.rotation_rad = std::max(most.rotation_rad, AngleBetween(a.poses[k], b.poses[k]));
  }
  return most;
}

ViDifference AlignedDifference(const ViStates& a, const ViStates& b, const ViStates& truth) {
  return Difference(Moved(a, AlignedToFirst(a, truth)), Moved(b, AlignedToFirst(b, truth)));
}

}  // namespace glissade::sim
