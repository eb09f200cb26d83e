// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/handle.h"

namespace glissade {

/// What of a vertex a solve must not move.
enum class Fix : std::uint8_t {
  kFree = 0,
  kWhole,           ///< everything; a fixed landmark leaves the system
  kPosition,        ///< position of a pose
  kPositionAndYaw,  ///< position of a pose and its rotation about world z, in the chart below
};

/// The free tangent of a partly fixed pose: tangent = basis * d, d of free_dim numbers.
///
/// kPosition: basis = [0; I3].
/// kPositionAndYaw: the rotation is parametrised as R = Exp(dphi) R0 with dphi_z = 0 and dphi
/// additive (Zhang, Gallego, Scaramuzza, RA-L 2018, Eq. 9). R0 is the rotation at the time of
/// SetFixed and stays through all solves. In the body tangent, dtheta = R0' Jr(dphi) d(dphi), so
/// the basis depends on dphi and is refreshed before every linearization. Masking a coordinate of
/// dtheta instead (no coordinate of which is yaw) drifts by 1e-3 to 1e-2 rad at the same cost.
struct FreeTangent {
  static constexpr int kMaxTangentDim = 6;

  AnyVertex vertex;
  Fix fix = Fix::kPosition;
  int free_dim = 3;
  double basis[kMaxTangentDim * kMaxTangentDim] = {};  ///< row-major, tangent_dim x free_dim
  double q0[4] = {0, 0, 0, 1};                         ///< R0, quaternion x y z w
  double dphi[3] = {0, 0, 0};

  /// Chart with R0 = the pose's present rotation (pose: p, q as in VertexPose).
  static FreeTangent ForPose(AnyVertex vertex, Fix fix, const double* pose);
  /// Recomputes the basis for the present dphi and pose.
  void UpdateBasis(const double* pose);
  /// pose <- pose moved by d (free_dim numbers), in the chart.
  void Plus(const double* d, double* pose);
};

}  // namespace glissade
