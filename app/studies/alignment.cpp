// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/alignment.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace glissade::app {

Result<CourseErrors> AlignedErrors(const CourseScene& scene, const Graph& graph,
                                   const CourseHandles& handles) {
  const std::size_t n = scene.poses.size();
  Eigen::MatrixXd estimate = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(n));
  Eigen::MatrixXd truth = estimate;
  for (std::size_t k = 0; k < n; ++k) {
    for (int i = 0; i < 3; ++i) {
      estimate(i, static_cast<Eigen::Index>(k)) = graph.Get(handles.poses[k]).Data()[i];
      truth(i, static_cast<Eigen::Index>(k)) = scene.poses[k].data[i];
    }
  }
  const auto undetermined = [] {
    return Status(StatusCode::kInvalidArgument,
                  "without priors the scene can only be compared to the truth if it has three "
                  "poses in different places");
  };
  const double spread = (estimate.colwise() - estimate.rowwise().mean()).norm();
  if (n < 3 || !(spread > 0.0)) return undetermined();
  const Eigen::MatrixXd T = Eigen::umeyama(estimate, truth, true);
  const Eigen::MatrixXd sR = T.topLeftCorner(3, 3);
  const double scale = sR.col(0).norm();
  if (!T.allFinite() || !(scale > 0.0)) return undetermined();

  Eigen::MatrixXd difference = sR * estimate - truth;
  difference.colwise() += T.topRightCorner(3, 1).col(0);
  CourseErrors errors;
  errors.pose = difference.colwise().norm().sum();
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    const double rho = graph.Get(handles.points[k]).rho / scale;
    errors.point += std::abs(rho - scene.TrueInverseDepth(scene.points[k]));
  }
  return errors;
}

}  // namespace glissade::app
