// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "glissade/base/status.h"
#include "glissade/cameras/kannala_brandt.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/cameras/radtan.h"
#include "glissade/lie/pose.h"
#include "glissade/window/observation.h"

namespace glissade::vision {

/// A calibrated camera on a body, as it takes images: a lens, which may distort, and a size.
struct Camera {
  /// No distortion; radial-tangential (EuRoC, OpenCV); equidistant (TUM-VI, Kalibr, OpenCV's
  /// fisheye).
  std::variant<CameraPinhole, CameraRadtan, CameraKannalaBrandt> lens;
  int width = 0, height = 0;  ///< px
  Pose T_b_c;                 ///< camera in body

  /// (x/z, y/z) of the ray through a pixel; false where there is none. Pixels have their centres at
  /// whole numbers.
  bool Undistort(const double uv[2], double xy[2]) const;
  /// The pixel of a ray; false where the lens has no image of it. It may lie outside the image.
  bool Distort(const double xy[2], double uv[2]) const;
  /// The focal lengths and the principal point.
  [[nodiscard]] const CameraPinhole& pinhole() const;

  /// kNotPositive, kNotFinite, kInvalidArgument: a lens, a size or a pose that is none.
  [[nodiscard]] Status Validate() const;
};

/// What a window takes for the camera: the same focal lengths and principal point, without the
/// distortion. sigma_px is that of an observation, each coordinate.
[[nodiscard]] WindowCamera WithoutDistortion(const Camera& camera, double sigma_px);

}  // namespace glissade::vision
