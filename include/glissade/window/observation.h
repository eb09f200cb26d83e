// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/base/validate.h"
#include "glissade/lie/pose.h"

/// \file
/// What a front end hands over: tracked features in the images of calibrated cameras on one body.
namespace glissade {

/// Pinhole without distortion: u = fx X/Z + cx, v = fy Y/Z + cy. A rectified stereo pair is two.
/// For features given as (x/z, y/z) leave the defaults and say sigma in those units.
struct WindowCamera {
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;  ///< px
  double sigma_px = 1.0;                          ///< of an observation, each coordinate
  Pose T_b_c;                                     ///< camera in body

  /// (x/z, y/z) of a pixel.
  [[nodiscard]] Vector2 Normalized(double u, double v) const {
    return Vector2((u - cx) / fx, (v - cy) / fy);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePositive(fx, "fx"); !s.ok()) return s;
    if (Status s = ValidatePositive(fy, "fy"); !s.ok()) return s;
    if (Status s = ValidateFinite(&cx, 1, "cx"); !s.ok()) return s;
    if (Status s = ValidateFinite(&cy, 1, "cy"); !s.ok()) return s;
    if (Status s = ValidatePositive(sigma_px, "sigma_px"); !s.ok()) return s;
    return ValidatePose(T_b_c.data, "T_b_c");
  }
};

/// One feature in one image of a frame; undistorted pixels. May be an outlier.
struct FrameObservation {
  std::int64_t track = 0;   ///< the same number in all images that show the same point
  int camera = 0;           ///< index in the cameras
  double u = 0.0, v = 0.0;  ///< px
};

/// What the cameras saw at one instant.
struct FrameObservations {
  std::int64_t stamp_ns = 0;
  std::span<const FrameObservation> observations;
};

}  // namespace glissade
