// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/eval/association.h"
#include "glissade/lie/so3.h"

/// \file
/// An estimate lives in a world of its own: alignment moves it to the reference's by just what its
/// sensors cannot observe. Closed form: S. Umeyama, "Least-squares estimation of transformation
/// parameters between two point patterns", IEEE PAMI 13(4), 1991, and, about a known vertical,
/// Z. Zhang and D. Scaramuzza, "A tutorial on quantitative trajectory evaluation for
/// visual(-inertial) odometry", IROS 2018.
namespace glissade::eval {

enum class AlignmentKind : std::uint8_t {
  kNone,  ///< both are in one world already
  kYaw,   ///< translation and rotation about the vertical: what a camera with an IMU cannot observe
  kSe3,   ///< translation and rotation: stereo without IMU
  kSim3,  ///< and scale: one camera without IMU
};

/// "none", "yaw", "se3", "sim3".
[[nodiscard]] std::string_view ToString(AlignmentKind kind);

struct AlignmentOptions {
  AlignmentKind kind = AlignmentKind::kYaw;
  /// For kYaw: the vertical, in the coordinates of both worlds; of any length but 0.
  Vector3 vertical = Vector3(0.0, 0.0, 1.0);
};

/// x_r = scale R x_e + t: R and t are those of T_r_e; r is the reference's world, e the estimate's.
struct Alignment {
  double scale = 1.0;
  Pose T_r_e;

  /// A pose of the estimate, in the reference's world.
  template <int = 0>
  [[nodiscard]] Pose Apply(const Pose& T_e_b) const {
    Pose scaled = T_e_b;
    for (int i = 0; i < 3; ++i)
      scaled.data[i] *= scale;
    Pose T_r_b = T_r_e * scaled;
    T_r_b.Normalize();
    return T_r_b;
  }
};

/// The alignment that minimizes sum_k |p_ref,k - (scale R p_est,k + t)|^2 among those of a kind.
///
/// kSe3, kSim3: with C = 1/n sum (p_ref - mean)(p_est - mean)' = U D V', R = U S V', S = diag(1, 1,
/// det(U) det(V)), scale = tr(D S) / var_est for kSim3 (Umeyama, Eqs. 40 to 43), t = mean_ref -
/// scale R mean_est. kYaw: R = Rot(vertical, yaw), yaw = atan2(sum u . (x_e x x_r), sum x_e' (I -
/// u u') x_r), x the positions less their mean, u the unit vertical.
///
/// kSingular where the positions do not say: fewer than three or all on one line (kSe3, kSim3),
/// fewer than two or all on one vertical (kYaw), none (kNone); on one line means that the second
/// singular value of C is below 1e-12 of the first, which is a width of a millionth of the length.
/// Else refused: what MatchedTrajectories::Validate refuses; a vertical of no length; kNotFinite
/// where sums of squares overflow.
[[nodiscard]] Result<Alignment> Align(const MatchedTrajectories& matched,
                                      const AlignmentOptions& options = {});

/// Moves the estimate, by Alignment::Apply.
void ApplyAlignment(const Alignment& alignment, std::span<StampedPose> estimate);

/// The rotation that a quaternion (x y z w, not zero) makes about a unit axis, rad, -pi to pi: the
/// twist in q = swing * twist, after which the swing has no component along the axis.
template <int = 0>
[[nodiscard]] double RotationAbout(const double q[4], const Vector3& axis) {
  const double along = axis[0] * q[0] + axis[1] * q[1] + axis[2] * q[2];
  return 2.0 * (q[3] < 0.0 ? std::atan2(-along, -q[3]) : std::atan2(along, q[3]));
}

/// Takes one estimated pose to where its position is that of the reference, and its rotation
/// differs from the reference's by none about the vertical (of unit length): the component along it
/// of the quaternion of Rot(vertical, yaw) R_est R_ref' is 0 (Zhang et al., RA-L 2018, Eq. 13 with
/// R_0^0 the reference's rotation). What a gauge is evaluated in: the error is then 0 at the
/// anchor, and not least squares over all poses as with Align.
template <int = 0>
[[nodiscard]] Alignment AlignPose(const Pose& estimate, const Pose& reference,
                                  const Vector3& vertical = Vector3(0.0, 0.0, 1.0)) {
  const Quaternion q(estimate.q() * reference.q().conjugate());
  const double yaw = -RotationAbout(q.coeffs().data(), vertical);
  Alignment alignment;
  alignment.T_r_e = Pose(so3::ExpQuaternion(Vector3(yaw * vertical)), Vector3(0.0, 0.0, 0.0));
  alignment.T_r_e.p() = reference.p() - alignment.T_r_e * Vector3(estimate.p());
  return alignment;
}

}  // namespace glissade::eval
