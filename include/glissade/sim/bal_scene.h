// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/status.h"
#include "glissade/io/bal.h"

namespace glissade::sim {

/// A bundle adjustment problem in the form of "Bundle Adjustment in the Large": cameras on a ring
/// of 10 m around a cloud of points of 4 m, all looking inward.
struct BalSceneOptions {
  int num_cameras = 16;
  int num_points = 300;
  double part_seen = 0.4;       ///< a point is seen by this part of the cameras; at least by three
  double pixel_noise = 0.5;     ///< sigma (px)
  double start_point_m = 0.05;  ///< sigma, each axis
  double start_rotation_rad = 0.002;  ///< sigma, each axis
  double start_translation_m = 0.02;  ///< sigma, each axis
  std::uint64_t seed = 1;

  [[nodiscard]] Status Validate() const;
};

/// Where a solve begins, and noisy observations (rounded to 1/256 px). The same numbers for the
/// same seed. kInvalidArgument where the options make no sense.
[[nodiscard]] Result<BalProblem> MakeBalScene(const BalSceneOptions& options);

}  // namespace glissade::sim
