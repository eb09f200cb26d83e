// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "glissade/vision/tracker_options.h"
#include "vision/frame_image.h"

namespace glissade::vision::internal {

/// Corners (Shi and Tomasi) for the empty cells of a grid.
class CornerDetector {
 public:
  /// Adds at most `count` corners, strongest first, each in a cell of its own that has no feature,
  /// and not too near to one in a neighbour's. Corners are those of the image at half its size:
  /// a quarter of the work, and the tracker refines nothing less by it.
  void Detect(const FrameImage& image, const std::vector<cv::Point2f>& features,
              const TrackerOptions& options, int count, std::vector<cv::Point2f>* corners);

 private:
  struct Candidate {
    float strength;
    int x, y;  // px of the half image
  };
  cv::Mat strength_;
  std::vector<Candidate> best_;  // of each cell
  std::vector<std::vector<cv::Point2f>> by_cell_;
};

}  // namespace glissade::vision::internal
