// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "glissade/vision/image.h"
#include "glissade/vision/tracker_options.h"

namespace glissade::vision::internal {

/// An image as the tracker needs it.
struct FrameImage {
  /// Image and gradients of each level in turn, each with a border of the tracker's window.
  std::vector<cv::Mat> pyramid;

  [[nodiscard]] int levels() const { return static_cast<int>(pyramid.size()) / 2 - 1; }
  [[nodiscard]] const cv::Mat& level(int k) const {
    return pyramid[2 * static_cast<std::size_t>(k)];
  }
};

/// Mean and standard deviation of grey values.
struct GreyValues {
  double mean = 0.0, deviation = 0.0;
};
GreyValues GreyValuesOf(const ImageView& image);

/// Evens contrast out and makes pyramids. Keeps what it works in: one for each camera.
class FrameImageMaker {
 public:
  FrameImageMaker(const TrackerOptions& options, int width, int height);
  /// Storage of `out` is used again.
  void Make(const ImageView& image, FrameImage* out);

 private:
  cv::Ptr<cv::CLAHE> contrast_;  // null: none
  cv::Mat even_;
  int window_px_, levels_;
};

/// Points of one image, looked for in another.
struct LkResult {
  std::vector<cv::Point2f> points;
  std::vector<unsigned char> found;
  /// Smaller eigenvalue of the mean squared gradient of the patch, (grey values / px)^2.
  std::vector<float> gradient;
  /// Distance of a point from where tracking back from its match leads, px.
  std::vector<float> back_px;
};

/// Lucas and Kanade's tracker from `guess`, there and back. Found: inside the image, with a patch
/// that has an eighth of a corner's gradient (min_corner), and back within
/// max_forward_backward_px. `levels` beyond the
/// image itself.
void TrackThereAndBack(const FrameImage& from, const FrameImage& to,
                       const std::vector<cv::Point2f>& points,
                       const std::vector<cv::Point2f>& guess, const TrackerOptions& options,
                       int levels, LkResult* result);

}  // namespace glissade::vision::internal
