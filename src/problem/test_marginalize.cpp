// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/LU>

#include "glissade/problem/problem.h"

namespace glissade {

MarginalizeExample TestMarginalize() {
  // Three scalar unknowns: x2 is measured with sigma 0.2, and differs from x1 and x3 by known
  // amounts with sigmas 0.1 and 0.3. H = J' Omega J.
  using Matrix3d = Eigen::Matrix3d;
  const Eigen::Vector3d sigma(0.1, 0.2, 0.3);
  Matrix3d J;
  J << 1, -1, 0,  //
      0, 1, 0,    //
      0, 1, -1;
  const Matrix3d H = J.transpose() * sigma.cwiseAbs2().cwiseInverse().asDiagonal() * J;

  Eigen::PermutationMatrix<3> move_last;
  move_last.indices() << 0, 2, 1;  // variable 2 goes to the end
  const Matrix3d moved = move_last * H * move_last.transpose();

  MarginalizeExample example;
  example.before = H;
  example.moved = moved;
  example.after = moved.topLeftCorner<2, 2>() -
                  moved.topRightCorner<2, 1>() * moved.bottomLeftCorner<1, 2>() / moved(2, 2);
  return example;
}

}  // namespace glissade
