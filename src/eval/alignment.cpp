// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "glissade/base/validate.h"

namespace glissade::eval {

namespace {

// A width of 1e-6 of the length: narrower, and the positions do not tell a rotation about the line
// from none. Also far above what rounding makes of points that are on a line.
constexpr double kSingularRatio = 1e-12;

/// First and second moments of both sets of positions.
struct Moments {
  Eigen::Vector3d mean_e = Eigen::Vector3d::Zero(), mean_r = Eigen::Vector3d::Zero();
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();  ///< 1/n sum (p_ref - mean)(p_est - mean)'
  double variance_e = 0.0;
  /// Product of what rounding alone makes of distances in the two: an element of C that is no
  /// larger says nothing.
  double rounding = 0.0;
};

Moments MomentsOf(const MatchedTrajectories& matched) {
  Moments m;
  double largest_e = 0.0, largest_r = 0.0;
  const auto n = static_cast<double>(matched.estimate.size());
  // From the first position on: coordinates that do not change have no variance, not a rounded one.
  const Eigen::Vector3d first_e = matched.estimate[0].T_w_b.p();
  const Eigen::Vector3d first_r = matched.reference[0].T_w_b.p();
  for (std::size_t k = 0; k < matched.estimate.size(); ++k) {
    const auto e = matched.estimate[k].T_w_b.p(), r = matched.reference[k].T_w_b.p();
    m.mean_e += (e - first_e) / n;
    m.mean_r += (r - first_r) / n;
    largest_e = std::max(largest_e, e.cwiseAbs().maxCoeff());
    largest_r = std::max(largest_r, r.cwiseAbs().maxCoeff());
  }
  m.mean_e += first_e;
  m.mean_r += first_r;
  for (std::size_t k = 0; k < matched.estimate.size(); ++k) {
    const Eigen::Vector3d e = matched.estimate[k].T_w_b.p() - m.mean_e;
    const Eigen::Vector3d r = matched.reference[k].T_w_b.p() - m.mean_r;
    m.C += r * e.transpose() / n;
    m.variance_e += e.squaredNorm() / n;
  }
  const double epsilon = 16.0 * std::numeric_limits<double>::epsilon();
  m.rounding = (epsilon * largest_e) * (epsilon * largest_r);
  return m;
}

Status Undetermined(const char* why) {
  return {StatusCode::kSingular, std::string("alignment: ").append(why)};
}

Alignment With(const Moments& m, const Eigen::Matrix3d& R, double scale) {
  Alignment alignment;
  alignment.scale = scale;
  alignment.T_r_e = Pose(Matrix3(R), Vector3::Zero());
  // With the rotation as it is stored, so that the centroid is met to rounding.
  const Vector3 moved = alignment.T_r_e * Vector3(scale * m.mean_e);
  alignment.T_r_e.p() = m.mean_r - moved;
  return alignment;
}

Result<Alignment> AlignUmeyama(const Moments& m, std::size_t n, bool with_scale) {
  if (n < 3) return Undetermined("needs at least three positions");
  // Of dynamic size: of fixed size GCC 12 takes it for uninitialized.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m.C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  Eigen::Vector3d D = svd.singularValues();
  const double sign = U.determinant() * V.determinant() < 0.0 ? -1.0 : 1.0;
  D[2] *= sign;
  // The maximum of tr(R'C) is unique just where this sum is positive.
  const double least = std::max(kSingularRatio * D[0], m.rounding);
  if (!(D[1] + D[2] > least)) {
    return Undetermined("the positions do not determine the rotation: are they all on one line?");
  }
  const Eigen::Matrix3d R = U * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * V.transpose();
  return With(m, R, with_scale ? D.sum() / m.variance_e : 1.0);
}

Result<Alignment> AlignYaw(const Moments& m, std::size_t n, const Eigen::Vector3d& u) {
  if (n < 2) return Undetermined("needs at least two positions");
  // The parts of tr(Rot(u, yaw)' C) that go with cos(yaw) and sin(yaw).
  const double c = m.C.trace() - u.dot(m.C * u);
  const Eigen::Vector3d skew(m.C(2, 1) - m.C(1, 2), m.C(0, 2) - m.C(2, 0), m.C(1, 0) - m.C(0, 1));
  const double s = u.dot(skew);
  const double least = std::max(kSingularRatio * m.C.norm(), m.rounding);
  if (!(std::hypot(c, s) > least)) {
    return Undetermined("the positions do not determine the yaw: are they all on one vertical?");
  }
  return With(m, Eigen::AngleAxisd(std::atan2(s, c), u).toRotationMatrix(), 1.0);
}

}  // namespace

std::string_view ToString(AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::kNone:
      return "none";
    case AlignmentKind::kYaw:
      return "yaw";
    case AlignmentKind::kSe3:
      return "se3";
    case AlignmentKind::kSim3:
      return "sim3";
  }
  return "unknown";
}

Result<Alignment> Align(const MatchedTrajectories& matched, const AlignmentOptions& options) {
  if (Status s = matched.Validate(); !s.ok()) return s;
  if (Status s = ValidateFinite(options.vertical.data(), 3, "vertical"); !s.ok()) return s;
  const std::size_t n = matched.estimate.size();
  if (n == 0) return Undetermined("there is no pose");
  if (options.kind == AlignmentKind::kNone) return Alignment();
  const Moments m = MomentsOf(matched);
  if (!m.C.allFinite() || !std::isfinite(m.variance_e)) {
    return Status(StatusCode::kNotFinite, "alignment: the squares of the positions overflow");
  }
  switch (options.kind) {
    case AlignmentKind::kYaw: {
      const Eigen::Vector3d u = options.vertical.stableNormalized();
      if (!(u.norm() > 0.5)) {
        return Status(StatusCode::kInvalidArgument, "alignment: the vertical has no direction");
      }
      return AlignYaw(m, n, u);
    }
    case AlignmentKind::kSe3:
      return AlignUmeyama(m, n, false);
    case AlignmentKind::kSim3:
      return AlignUmeyama(m, n, true);
    default:
      return Status(StatusCode::kInvalidArgument, "alignment: no such kind");
  }
}

void ApplyAlignment(const Alignment& alignment, std::span<StampedPose> estimate) {
  for (StampedPose& x : estimate)
    x.T_w_b = alignment.Apply(x.T_w_b);
}

}  // namespace glissade::eval
