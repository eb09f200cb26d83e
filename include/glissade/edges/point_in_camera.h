// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/small_matrix.h"
#include "glissade/lie/pose.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/pose_view.h"
#include "glissade/vertices/view.h"

namespace glissade::internal {

/// A world point as a camera on a body has it: x_b = R_wb' (X - p_wb), x_c = R_bc' (x_b - p_bc).
template <class T>
struct PointInCamera {
  PointInCamera(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Pose& T_b_c)
      : camera_in_body(ViewOf<T>(T_b_c)),
        x_b(TransposeTimes(pose.R, point.p - pose.p)),
        x_c(TransposeTimes(camera_in_body.R, x_b - camera_in_body.p)) {}

  /// d r / d T_W_B and d r / d X of what has d r / d x_c; null: not wanted.
  void Derivatives(const View<VertexPose, T>& pose, const Mat<T, 2, 3>& d_r_d_c,
                   Mat<T, 2, 6>* d_r_d_pose, Mat<T, 2, 3>* d_r_d_point) const {
    const Mat<T, 2, 3> d_r_d_b = d_r_d_c * camera_in_body.R.Transpose();
    const Mat<T, 2, 3> d_r_d_w = d_r_d_b * pose.R.Transpose();
    if (d_r_d_pose) {
      d_r_d_pose->Set(0, 0, -d_r_d_w);
      for (int row = 0; row < 2; ++row)
        d_r_d_pose->Set(row, 3, Cross(d_r_d_b.Row(row), x_b));
    }
    if (d_r_d_point) *d_r_d_point = d_r_d_w;
  }

  View<VertexPose, T> camera_in_body;
  Vec<T, 3> x_b, x_c;
};

}  // namespace glissade::internal
