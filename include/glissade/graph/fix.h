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
  kBiases,          ///< both biases of a VertexSpeedBias; its velocity stays free
  kCoordinate,      ///< one coordinate of a camera centre; for gauges (gauge/gauge.h), not SetFixed
  kNumbers,         ///< some numbers of an additive vertex: Graph::SetFixedNumbers
};

/// The free tangent of a partly fixed vertex: tangent = basis * d, d of free_dim numbers.
///
/// kPosition: basis = [0; I3]. kBiases: basis = [I3; 0].
/// kPositionAndYaw: the rotation is parametrised as R = Exp(dphi) R0 with dphi_z = 0 and dphi
/// additive (Zhang, Gallego, Scaramuzza, RA-L 2018, Eq. 9). R0 is the rotation at the time of
/// SetFixed and stays through all solves. In the body tangent, dtheta = R0' Jr(dphi) d(dphi), so
/// the basis depends on dphi and is refreshed before every linearization. Masking a coordinate of
/// dtheta instead (no coordinate of which is yaw) drifts by 1e-3 to 1e-2 rad at the same cost.
/// kCoordinate: n'(p + R l) is held, n a unit vector in the world and l the camera centre in the
/// body; two coordinates of p and the rotation are free, and p moves along n as R turns l.
/// kNumbers: the basis picks those that are not in `held`.
struct FreeTangent {
  static constexpr int kMaxTangentDim = 9;
  static constexpr int kMaxFreeDim = 8;

  AnyVertex vertex;
  Fix fix = Fix::kPosition;
  int tangent_dim = 6;
  int free_dim = 3;
  std::uint32_t held = 0;                           ///< of kNumbers: bit k for number k
  double basis[kMaxTangentDim * kMaxFreeDim] = {};  ///< row-major, tangent_dim x free_dim
  double q0[4] = {0, 0, 0, 1};                      ///< R0, quaternion x y z w
  double dphi[3] = {0, 0, 0};
  double normal[3] = {0, 0, 1}, lever[3] = {0, 0, 0};  ///< n and l of kCoordinate

  /// Chart at the vertex's present state; R0 = a pose's present rotation.
  static FreeTangent At(AnyVertex vertex, Fix fix, const double* state);
  /// kPositionAndYaw with a given R0: dphi = Log(R R0').
  static FreeTangent InChart(AnyVertex vertex, const double* q0, const double* pose);
  /// kCoordinate.
  static FreeTangent OnPlane(AnyVertex vertex, const double* normal, const double* lever,
                             const double* pose);
  /// kNumbers: some of `tangent_dim` numbers, at least one and not all.
  static FreeTangent Numbers(AnyVertex vertex, int tangent_dim, std::uint32_t held);
  /// Recomputes the basis for the present dphi and state.
  void UpdateBasis(const double* state);
  /// state <- state moved by d (free_dim numbers), in the chart.
  void Plus(const double* d, double* state);
};

}  // namespace glissade
