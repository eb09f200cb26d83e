// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"

namespace glissade::vision {

/// How FeatureTracker finds and follows features. The defaults are for 752 x 480 at 20 Hz.
struct TrackerOptions {
  /// At most so many features in the first camera's image.
  int max_features = 200;
  /// A new feature is looked for in each free cell of a grid of this width (px); it keeps half of
  /// that from all others.
  int cell_px = 32;
  /// A corner is one whose smaller eigenvalue of the summed gradients (Shi and Tomasi, CVPR 1994)
  /// is at least this part of the image's strongest, ...
  double min_relative_corner = 0.01;
  /// ... and of at least this mean squared gradient (grey values per px)^2.
  double min_corner = 8.0;

  /// Evens contrast out first (CLAHE: adaptive histogram equalization with this limit, in tiles of
  /// about 64 px); 0: takes images as they are.
  double contrast_limit = 3.0;

  /// Lucas and Kanade's tracker in a pyramid: window (px, odd) and levels beyond the image itself,
  /// where the IMU predicts where to look and where nothing does.
  int window_px = 21;
  int levels_predicted = 2;
  int levels_blind = 4;
  /// Tracked back, a feature must come to within this of where it was (px).
  double max_forward_backward_px = 0.5;
  /// Distance from the epipolar line (px) beyond which a match is an outlier, between frames and
  /// between cameras.
  double max_epipolar_px = 1.5;
  double max_stereo_epipolar_px = 1.5;
  /// Nearest point that the stereo pair is searched for (m).
  double min_depth_m = 0.3;

  /// An image whose grey values have a standard deviation below this shows nothing: too dark, too
  /// bright or covered.
  double min_contrast = 4.0;
  /// After an image that shows nothing, or in which less than a third of the features is found
  /// again (blurred, say), features are looked for from the last good image, for so long.
  double max_blind_s = 0.4;

  [[nodiscard]] Status Validate() const;
};

}  // namespace glissade::vision
