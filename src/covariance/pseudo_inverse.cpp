// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <cmath>

#include "covariance/linearized_graph.h"
#include "glissade/base/index.h"
#include "glissade/covariance/covariance.h"

namespace glissade {

namespace {

using internal::Index;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstBlock = Eigen::Map<const RowMajor>;

/// H over padded pose scalars, then landmarks; zero rows where coordinates are held.
Eigen::MatrixXd DenseHessian(const LinearizedGraph& linear) {
  const Structure& structure = linear.structure;
  const int num_poses = structure.num_pose_scalars();
  const int n = num_poses + structure.num_landmark_scalars();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  const auto set = [&](int row, int col, const DenseBlock& block) {
    const ConstBlock values(block.data, block.rows, block.cols);
    H.block(row, col, block.rows, block.cols) = values;
    H.block(col, row, block.cols, block.rows) = values.transpose();
  };
  for (std::size_t k = 0; k < linear.hessian->num_pairs(); ++k) {
    const Hessian::PosePair pair = linear.hessian->Pair(k);
    set(linear.hessian->offset(pair.row), linear.hessian->offset(pair.col), pair.H);
  }
  for (std::size_t l = 0; l < linear.hessian->num_landmarks(); ++l) {
    const Hessian::LandmarkPart landmark = linear.hessian->Landmark(l);
    const int at = num_poses + structure.landmarks()[l].step;
    set(at, at, landmark.H());
    for (int s = 0; s < landmark.num_slots(); ++s)
      set(landmark.row(s), at, landmark.W(s));
  }
  return H;
}

}  // namespace

Result<JointCovariance> RawFreeGaugePseudoInverse(Graph* graph, int null_dimension) {
  LinearizedGraph linear;
  Status status = linear.Linearize(graph, Gauge::Free, 1);
  if (!status.ok()) return status;
  const Eigen::MatrixXd H = DenseHessian(linear);
  Result<Orbit> orbit = Orbit::Of(*graph);
  // Held coordinates are zero rows: part of the null space.
  Eigen::Index d = null_dimension >= 0 ? null_dimension : orbit.ok() ? orbit->dim() : 0;
  for (const std::uint8_t held : linear.equations.held())
    d += held;
  if (d > H.rows()) {
    return Status(StatusCode::kInvalidArgument, "pseudo-inverse: null_dimension is too large");
  }
  // Eigenvalues of the scaled matrix are good to eps times its own, far smaller, condition number.
  // A generalized inverse of it, scaled back, is one of H; projected onto the range of H on both
  // sides it is the one of Moore and Penrose.
  Eigen::VectorXd scale = H.diagonal();
  for (double& x : scale)
    x = x > 0.0 ? 1.0 / std::sqrt(x) : 1.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(scale.asDiagonal() * H * scale.asDiagonal()));
  const Eigen::Index r = H.rows() - d;  // eigenvalues ascend
  const Eigen::MatrixXd V = scale.asDiagonal() * eigen.eigenvectors().rightCols(r);
  Eigen::MatrixXd pinv =
      V * eigen.eigenvalues().tail(r).cwiseInverse().asDiagonal() * V.transpose();
  if (d > 0) {
    const Eigen::MatrixXd null = scale.asDiagonal() * eigen.eigenvectors().leftCols(d);
    const Eigen::MatrixXd N = Eigen::HouseholderQR<Eigen::MatrixXd>(null).householderQ() *
                              Eigen::MatrixXd::Identity(H.rows(), d);
    pinv -= (N * (N.transpose() * pinv)).eval();
    pinv -= ((pinv * N) * N.transpose()).eval();
  }

  // Rows of each vertex's full tangent.
  JointCovariance out;
  out.offsets.push_back(0);
  out.references = linear.references;
  if (orbit.ok()) out.orbit = std::move(orbit).value();
  std::vector<Eigen::Triplet<double>> entries;
  for (const AnyVertex& vertex : linear.vertices) {
    const LinearizedGraph::Place& place = *linear.Find(vertex);
    const int row = out.offsets.back();
    if (place.pose >= 0) {
      const PoseBlock& pose = linear.structure.poses()[Index(place.pose)];
      const FreeTangent* tangent =
          pose.free_tangent < 0 ? nullptr : &linear.tangents[Index(pose.free_tangent)];
      for (int r = 0; r < pose.dim; ++r) {
        if (tangent == nullptr) entries.emplace_back(row + r, pose.offset + r, 1.0);
        for (int k = 0; tangent != nullptr && k < tangent->free_dim; ++k) {
          entries.emplace_back(row + r, pose.offset + k, tangent->basis[r * tangent->free_dim + k]);
        }
      }
    } else if (place.landmark >= 0) {
      const int at = linear.structure.num_pose_scalars() +
                     linear.structure.landmarks()[Index(place.landmark)].step;
      for (int r = 0; r < place.dim; ++r)
        entries.emplace_back(row + r, at + r, 1.0);
    }
    out.vertices.push_back(vertex);
    out.offsets.push_back(row + place.dim);
    out.state_offsets.push_back(out.states.size());
    out.states.insert(out.states.end(), place.state.begin(), place.state.end());
  }
  Eigen::SparseMatrix<double> E(out.size(), H.rows());
  E.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd half = E * pinv;
  const Eigen::MatrixXd cov = half * E.transpose();
  if (!cov.allFinite()) return Status(StatusCode::kNotFinite, "pseudo-inverse: not finite");
  out.values.assign(cov.data(), cov.data() + cov.size());
  return out;
}

}  // namespace glissade
