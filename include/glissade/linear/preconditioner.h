// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade {

/// Of conjugate gradients on the reduced system.
enum class Preconditioner {
  kJacobi,       ///< scalar diagonal
  kBlockJacobi,  ///< inverse diagonal blocks of S, one per vertex (Schur-Jacobi)
  /// Inverse diagonal blocks of S of up to 16 vertices that see the same landmarks (after Kushal
  /// and Agarwal, "Visibility based preconditioning for bundle adjustment", CVPR 2012).
  kClusterJacobi,
  /// The first terms of S^-1 = sum_i (H_pp^-1 W H_ll^-1 W')^i H_pp^-1 (Weber, Demmel, Chan and
  /// Cremers, "Power bundle adjustment for large-scale 3D reconstruction", CVPR 2023). A product
  /// with S for each, so that it pays where iterations are dear in other ways.
  kPowerSeries,
};

}  // namespace glissade
