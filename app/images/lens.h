// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "glissade/vision/camera.h"

namespace glissade::app {

/// How cameras are to differ from those of a recording.
struct LensOptions {
  /// own: as they are; none: no distortion; radtan: that of EuRoC's cameras; equidistant: that of
  /// TUM-VI's.
  std::string model = "own";
  int width = 0, height = 0;  ///< px; 0: as they are
  double focal_px = 0.0;      ///< both focal lengths, for the new width; 0: as they are
};

/// The words for LensOptions::model.
const std::vector<std::string>& LensModels();

/// A new size cuts or adds rows and scales with the width: the horizontal field of view stays, and
/// pixels stay square. `index` is 0 for the left camera, whose distortion is another one than that
/// of the right one.
vision::Camera WithLens(const vision::Camera& camera, int index, const LensOptions& options);

}  // namespace glissade::app
