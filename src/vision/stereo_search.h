// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "glissade/vision/camera.h"
#include "vision/frame_image.h"

namespace glissade::vision::internal {

/// Where in the second image a point of the first one may be: along its epipolar curve.
class StereoSearch {
 public:
  StereoSearch(const Camera& first, const Camera& second, double min_depth_m);

  [[nodiscard]] double baseline() const { return T_2_1_.p().norm(); }  ///< m
  /// Where a point at this inverse depth (1/z in the first camera, 1/m) is in the second image;
  /// false where that has no image of it.
  bool Project(const double xy[2], double inverse_depth, cv::Point2f* px) const;
  /// The inverse depth at which the point is nearest to its match, which is at xy_second.
  [[nodiscard]] double InverseDepth(const double xy[2], const double xy_second[2]) const;
  /// Sampson's distance from the epipolar lines, normalized coordinates.
  [[nodiscard]] double Distance(const double xy[2], const double xy_second[2]) const;

  /// The best of places along the curve, from infinity to the nearest depth, by the correlation of
  /// patches of 9 x 9 px, mean and contrast taken out, two levels up; false where none is good.
  bool Search(const FrameImage& first, const FrameImage& second, const cv::Point2f& px,
              const double xy[2], cv::Point2f* match, double* inverse_depth) const;

 private:
  Camera second_;
  Pose T_2_1_;
  double max_inverse_depth_;
};

}  // namespace glissade::vision::internal
