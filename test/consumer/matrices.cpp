// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Matrices that cross the border: the library computes, this program owns, resizes and frees them.
// With -march=native Eigen allocates and aligns them differently here than in the library.
#include "matrices.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "glissade/edges/se3_prior.h"
#include "glissade/problem/problem.h"
#include "glissade/vertices/pose.h"

bool MatricesAreSound() {
  using namespace glissade;
  Problem problem;
  const int num_poses = 7;
  for (int i = 0; i < num_poses; ++i) {
    EdgeSE3Prior prior;
    prior.T_w_b.p() = Eigen::Vector3d(i, -i, 0.1 * i);
    if (!problem.AddEdge(prior, {problem.AddVertex(VertexPose{prior.T_w_b})}).ok()) return false;
  }
  if (!problem.MakeHessian().ok()) return false;
  Eigen::MatrixXd H = problem.Hessian();
  if (H.rows() != 6 * num_poses || H.cols() != H.rows()) return false;
  if (!H.isApprox(Eigen::MatrixXd::Identity(H.rows(), H.cols()), 1e-12)) return false;
  Eigen::VectorXd b = problem.Rhs();
  if (b.size() != H.rows() || b.norm() > 1e-12) return false;
  H.conservativeResize(H.rows() + 3, H.cols() + 3);
  H.bottomRows<3>().setZero();
  H.rightCols<3>().setZero();
  H.diagonal().array() += 1.0;
  b = Eigen::VectorXd::Ones(H.rows());
  const Eigen::VectorXd x = H.llt().solve(b);
  if ((H * x - b).norm() > 1e-12) return false;

  const MarginalizeExample example = TestMarginalize();
  return example.before.isApprox(example.before.transpose()) && example.after.allFinite();
}
