// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the frames and cameras of TwistTerms stand.

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/lie/quaternion.h"
#include "glissade/vertices/pose.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

using internal::Index;

void Copy(const Matrix3& R, double* out) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      out[3 * r + c] = R(r, c);
  }
}

}  // namespace

void TwistTerms::UpdatePoses(const Structure& structure, const Graph& graph) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const double* o = poses.Data(plan.center);
  std::copy_n(o, 3, origin_.data());
  for (Camera& camera : cameras_) {
    // Taken from the center's position first: far from the world's origin the rest would lose its
    // last digits to that distance.
    Pose T_o_b = poses.At(camera.pose).pose;
    for (int i = 0; i < 3; ++i)
      T_o_b.data[i] -= o[i];
    const Pose T_o_c = T_o_b * camera.T_b_c;
    Copy(T_o_c.R(), camera.at.R_wc);
    std::copy_n(T_o_c.data, 3, camera.at.c);
  }
}

void TwistTerms::UpdateFrames(const Structure& structure, const Graph& graph) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const LinearizationTable& table = poses.first_estimates();
  const bool full = graph.first_estimates() == FirstEstimates::kFull && !table.empty();
  const auto lin = [&](int pose) {
    const double* at = full ? table.At(pose) : nullptr;
    return at != nullptr ? at : poses.Data(pose);
  };
  // Moments are taken about a point among the poses, so that they do not grow with the distance
  // from the world's origin (LandmarkPlan::kMaxReach).
  const double* o = lin(plan.center);
  std::copy_n(o, 3, linearized_at_.data());
  frames_.resize(Index(poses.size()));
  for (int k = 0; k < poses.size(); ++k) {
    kernels::TwistFrame& frame = frames_[Index(k)];
    const double *x = poses.Data(k), *x_lin = lin(k);
    const Matrix3 R = RotationMatrix(x_lin + 3);
    Copy(R, frame.R);
    for (int i = 0; i < 3; ++i)
      frame.p[i] = x_lin[i] - o[i];
    frame.turned = x != x_lin && !std::equal(x + 3, x + 7, x_lin + 3);
    if (frame.turned) Copy(R * RotationMatrix(x + 3).transpose(), frame.turn);
  }
  for (Camera& camera : cameras_) {
    // Jacobians by the camera are in its own axes, to be turned to the world's.
    const Matrix3 R = RotationMatrix(lin(camera.pose) + 3), R_w_c = R * camera.T_b_c.R();
    Copy(R_w_c, camera.frame.R);
    Copy(R_w_c, camera.frame.turn);
    camera.frame.turned = true;
    const Vector3 lever = R * camera.T_b_c.p();
    for (int i = 0; i < 3; ++i)
      camera.frame.p[i] = frames_[Index(camera.pose)].p[i] + lever[i];
  }
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    const PoseBlock& block = structure.poses()[k];
    if (block.pool != poses.id()) continue;
    const kernels::TwistFrame& frame = frames_[Index(block.index)];
    const double *R = frame.R, *p = frame.p;
    double* T = maps_[k].T;
    for (int c = 0; c < 3; ++c) {
      T[8 * c + c] = 1.0;
      T[3 + c] = p[1] * R[6 + c] - p[2] * R[3 + c];
      T[8 + 3 + c] = p[2] * R[c] - p[0] * R[6 + c];
      T[16 + 3 + c] = p[0] * R[3 + c] - p[1] * R[c];
      for (int r = 0; r < 3; ++r)
        T[8 * (3 + r) + 3 + c] = R[3 * r + c];
    }
  }
}

}  // namespace glissade
