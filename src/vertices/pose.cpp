// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vertices/pose.h"

namespace glissade {

void VertexPose::MinusJacobian(const VertexPose& x0, double* D) const {
  double delta[6];
  Minus(x0, delta);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> J(D);
  J.setIdentity();
  J.bottomRightCorner<3, 3>() = so3::JrInverse(Vector3(delta[3], delta[4], delta[5]));
}

}  // namespace glissade
