// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// EdgeSE3Prior: the inverse right Jacobian used the unit axis instead of the rotation vector (error
// 0.7 at |w| = 0.01).
#include <gtest/gtest.h>

#include "common/random_states.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/testing.h"

namespace glissade {
namespace {

/// The prior with the defect: Jr^-1 of the axis, as if every error were one radian.
struct EdgeSE3PriorWithUnitAxis : EdgeSE3Prior {
  bool Evaluate(const VertexPose& pose, Vector6& r, Jacobian<6, 6>* d_r_d_pose) const {
    EdgeSE3Prior::Evaluate(pose, r, d_r_d_pose);
    if (d_r_d_pose) {
      const Vector3 axis = r.tail<3>().normalized();
      d_r_d_pose->bottomRightCorner<3, 3>() = so3::JrInverse(axis);
    }
    return true;
  }
};

TEST(Se3PriorJacobian, InverseRightJacobianTakesTheRotationVectorNotItsAxis) {
  test::Random random(1);
  double largest_entry_error = 0.0;
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_w_b = random.RandomPose(2.0);
    const Pose error = random.RandomPose(0.1, 0.01);
    const VertexPose x{T_w_b * error};

    const JacobianCheck good = CheckJacobians(EdgeSE3Prior{T_w_b}, x);
    EXPECT_TRUE(good.ok) << good.message;

    const JacobianCheck bad = CheckJacobians(EdgeSE3PriorWithUnitAxis{{T_w_b}}, x);
    EXPECT_FALSE(bad.ok);
    EXPECT_GE(bad.row, 3);  // in the rotation block
    EXPECT_GE(bad.column, 3);

    Vector6 r;
    Jacobian<6, 6> J_good, J_bad;
    EdgeSE3Prior{T_w_b}.Evaluate(x, r, &J_good);
    EdgeSE3PriorWithUnitAxis{{T_w_b}}.Evaluate(x, r, &J_bad);
    largest_entry_error = std::max(largest_entry_error, (J_good - J_bad).norm());
  }
  EXPECT_NEAR(largest_entry_error, 0.7, 0.05);
}

}  // namespace
}  // namespace glissade
