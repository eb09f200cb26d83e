// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>

#include "glissade/marginal/schur_complement.h"
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
  // Raw pointers: Eigen's types go by another name in here than in the header of SchurComplement.
  constexpr int kKeep[] = {0, 1}, kOut[] = {2};
  const Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  double b_after[2];
  int rank = 0;
  const Status status = internal::SchurComplement(3, moved.data(), rhs.data(), kKeep, kOut, 0.0,
                                                  example.after.data(), b_after, &rank);
  if (!status.ok()) example.after.setZero();  // cannot be: H is what it is
  return example;
}

}  // namespace glissade
