// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade {

/// An observation by two ideal cameras: the host's ray of an inverse-depth landmark and where the
/// target sees it, both in normalized coordinates. With b = (uv_host, 1),
///     P = T_b_target^-1 T_W_Bj^-1 T_W_Bi T_b_host (b / rho),   r = P.xy / P.z - uv_target.
/// An edge on two poses and an inverse depth with that residual may say so,
///     TwoViewObservation TwoView() const;
/// and is then evaluated by a kernel of the library instead of its own Evaluate. What a base says
/// does not count: the derived edge's Evaluate may be another. Pointers into the edge.
struct TwoViewObservation {
  const double* uv_host = nullptr;    ///< 2 numbers
  const double* uv_target = nullptr;  ///< 2 numbers
  const double* T_b_host = nullptr;   ///< camera in body, 7 numbers as in Pose
  const double* T_b_target = nullptr;
};

}  // namespace glissade
