// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade {

/// An observation by two cameras without distortion: the host's ray of an inverse-depth landmark in
/// normalized coordinates, and where the target sees it. With b = (uv_host, 1),
///     P = T_b_target^-1 T_W_Bj^-1 T_W_Bi T_b_host (b / rho),   r = f P.xy / P.z + c - uv_target.
/// Or one of a point in the world, by the target alone: P = T_b_target^-1 T_W_B^-1 X, no host.
/// Edges of the library with that residual say so by TwoView(), and are then evaluated by a kernel
/// instead of their own Evaluate. A user's edge is not, whatever it says. Pointers into the edge.
struct TwoViewObservation {
  const double* uv_host = nullptr;    ///< 2 numbers; null: of a point
  const double* uv_target = nullptr;  ///< 2 numbers
  const double* T_b_host = nullptr;   ///< camera in body, 7 numbers as in Pose
  const double* T_b_target = nullptr;
  double f[2] = {1.0, 1.0};  ///< by axis; 1 of an ideal camera
  double c[2] = {0.0, 0.0};
};

}  // namespace glissade
