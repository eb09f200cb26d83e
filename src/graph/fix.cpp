// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/fix.h"

#include <algorithm>

#include "glissade/base/matrix.h"
#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"

namespace glissade {

FreeTangent FreeTangent::ForPose(AnyVertex vertex, Fix fix, const double* pose) {
  FreeTangent tangent;
  tangent.vertex = vertex;
  tangent.fix = fix;
  tangent.free_dim = fix == Fix::kPosition ? 3 : 2;
  std::copy_n(pose + 3, 4, tangent.q0);
  tangent.UpdateBasis(pose);
  return tangent;
}

void FreeTangent::UpdateBasis(const double*) {
  std::fill(std::begin(basis), std::end(basis), 0.0);
  if (fix == Fix::kPosition) {
    for (int k = 0; k < 3; ++k)
      basis[(3 + k) * 3 + k] = 1.0;
    return;
  }
  const Quaternion rotation0(q0);
  const Vector3 phi(dphi[0], dphi[1], dphi[2]);
  const Matrix3 d_theta_d_phi = rotation0.toRotationMatrix().transpose() * so3::Jr(phi);
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 2; ++k)
      basis[(3 + row) * 2 + k] = d_theta_d_phi(row, k);
  }
}

void FreeTangent::Plus(const double* d, double* pose) {
  Quaternion q(pose + 3);
  if (fix == Fix::kPosition) {
    q = q * so3::ExpQuaternion(Vector3(d[0], d[1], d[2]));
  } else {
    dphi[0] += d[0];
    dphi[1] += d[1];
    const Quaternion rotation0(q0);
    q = so3::ExpQuaternion(Vector3(dphi[0], dphi[1], dphi[2])) * rotation0;
  }
  q.normalize();
  std::copy_n(q.coeffs().data(), 4, pose + 3);
}

}  // namespace glissade
