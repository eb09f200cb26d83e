// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/frame_image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

#include "vision/as_mat.h"

namespace glissade::vision::internal {

namespace {

// cv::calcOpticalFlowPyrLK gives eigenvalues of gradients times 32, squared, divided by 2^20.
constexpr double kGradientOfEigenvalue = 1024.0;

}  // namespace

GreyValues GreyValuesOf(const ImageView& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(AsMat(image), mean, deviation);
  return {mean[0], deviation[0]};
}

FrameImageMaker::FrameImageMaker(const TrackerOptions& options, int width, int height)
    : window_px_(options.window_px),
      levels_(std::max(options.levels_predicted, options.levels_blind)) {
  if (options.contrast_limit > 0.0) {
    const auto tiles = [](int px) { return std::max(1, (px + 32) / 64); };
    contrast_ = cv::createCLAHE(options.contrast_limit, cv::Size(tiles(width), tiles(height)));
  }
}

void FrameImageMaker::Make(const ImageView& image, FrameImage* out) {
  cv::Mat source = AsMat(image);
  if (contrast_) {
    contrast_->apply(source, even_);
    source = even_;
  }
  cv::buildOpticalFlowPyramid(source, out->pyramid, cv::Size(window_px_, window_px_), levels_, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
}

void TrackThereAndBack(const FrameImage& from, const FrameImage& to,
                       const std::vector<cv::Point2f>& points,
                       const std::vector<cv::Point2f>& guess, const TrackerOptions& options,
                       int levels, LkResult* result) {
  const std::size_t n = points.size();
  result->points = guess;
  result->found.assign(n, 0);
  result->gradient.assign(n, 0.0f);
  result->back_px.assign(n, 0.0f);
  if (n == 0) return;
  const cv::Size window(options.window_px, options.window_px);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.03);
  // A patch that has lost most of the gradient a corner had is none any more.
  const double min_eigenvalue = 0.125 * options.min_corner / kGradientOfEigenvalue;
  const int flags = cv::OPTFLOW_USE_INITIAL_FLOW | cv::OPTFLOW_LK_GET_MIN_EIGENVALS;
  std::vector<unsigned char> forth, back;
  std::vector<float> eigenvalues, unused;
  cv::calcOpticalFlowPyrLK(from.pyramid, to.pyramid, points, result->points, forth, eigenvalues,
                           window, std::min(levels, std::min(from.levels(), to.levels())), stop,
                           flags, min_eigenvalue);
  // Back from where it is to where it was: it is near, so that one level more is enough.
  std::vector<cv::Point2f> returned = points;
  cv::calcOpticalFlowPyrLK(to.pyramid, from.pyramid, result->points, returned, back, unused, window,
                           std::min(1, std::min(from.levels(), to.levels())), stop, flags,
                           min_eigenvalue);
  const cv::Mat& image = to.level(0);
  for (std::size_t k = 0; k < n; ++k) {
    const cv::Point2f p = result->points[k], d = returned[k] - points[k];
    result->back_px[k] = std::sqrt(d.x * d.x + d.y * d.y);
    result->gradient[k] = static_cast<float>(kGradientOfEigenvalue) * eigenvalues[k];
    const bool inside = p.x >= 1.0f && p.y >= 1.0f && p.x < static_cast<float>(image.cols - 1) &&
                        p.y < static_cast<float>(image.rows - 1);
    result->found[k] = forth[k] != 0 && back[k] != 0 && inside &&
                       result->back_px[k] <= static_cast<float>(options.max_forward_backward_px);
  }
}

}  // namespace glissade::vision::internal
