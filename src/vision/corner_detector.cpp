// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/corner_detector.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace glissade::vision::internal {

void CornerDetector::Detect(const FrameImage& image, const std::vector<cv::Point2f>& features,
                            const TrackerOptions& options, int count,
                            std::vector<cv::Point2f>* corners) {
  const int level = image.levels() > 0 ? 1 : 0;
  const int scale = 1 << level;
  const cv::Mat& half = image.level(level);
  // Eigenvalues of sums over 3 x 3 px of Sobel's gradients, over (12 * 255)^2: Sobel's weights sum
  // to 8. Times this they are those of the mean squared gradient.
  constexpr double kGradient = 12.0 * 255.0 * 12.0 * 255.0 / (64.0 * 9.0);
  cv::cornerMinEigenVal(half, strength_, 3, 3);

  const int cell = std::max(4, options.cell_px / scale);
  const int columns = half.cols / cell + 1, rows = half.rows / cell + 1;
  const auto cell_of = [&](float x, float y) {
    const int c = std::clamp(static_cast<int>(x) / (cell * scale), 0, columns - 1);
    const int r = std::clamp(static_cast<int>(y) / (cell * scale), 0, rows - 1);
    return static_cast<std::size_t>(r * columns + c);
  };
  by_cell_.resize(static_cast<std::size_t>(columns * rows));
  for (auto& list : by_cell_)
    list.clear();
  for (const cv::Point2f& p : features)
    by_cell_[cell_of(p.x, p.y)].push_back(p);

  // The windows of features at the border would lie outside the image.
  const int border = std::max(3, options.window_px / 2 / scale);
  float strongest = 0.0f;
  best_.clear();
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      Candidate best{-1.0f, 0, 0};
      const int x_end = std::min((c + 1) * cell, half.cols - border);
      const int y_end = std::min((r + 1) * cell, half.rows - border);
      for (int y = std::max(r * cell, border); y < y_end; ++y) {
        const float* row = strength_.ptr<float>(y);
        for (int x = std::max(c * cell, border); x < x_end; ++x) {
          if (row[x] > best.strength) best = {row[x], x, y};
        }
      }
      strongest = std::max(strongest, best.strength);
      if (best.strength > 0.0f && by_cell_[static_cast<std::size_t>(r * columns + c)].empty()) {
        best_.push_back(best);
      }
    }
  }
  const float enough = std::max(static_cast<float>(options.min_corner / kGradient),
                                static_cast<float>(options.min_relative_corner) * strongest);
  std::stable_sort(best_.begin(), best_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.strength > b.strength; });
  const float near = 0.5f * static_cast<float>(options.cell_px);
  for (const Candidate& candidate : best_) {
    if (count <= 0 || candidate.strength < enough) break;
    // Pixels of the half image stand where the even ones of the image do.
    const cv::Point2f p(static_cast<float>(candidate.x * scale),
                        static_cast<float>(candidate.y * scale));
    bool crowded = false;
    const int c = static_cast<int>(p.x) / (cell * scale),
              r = static_cast<int>(p.y) / (cell * scale);
    for (int y = std::max(0, r - 1); y <= std::min(rows - 1, r + 1) && !crowded; ++y) {
      for (int x = std::max(0, c - 1); x <= std::min(columns - 1, c + 1) && !crowded; ++x) {
        for (const cv::Point2f& other : by_cell_[static_cast<std::size_t>(y * columns + x)]) {
          const cv::Point2f d = other - p;
          crowded = crowded || d.x * d.x + d.y * d.y < near * near;
        }
      }
    }
    if (crowded) continue;
    by_cell_[cell_of(p.x, p.y)].push_back(p);
    corners->push_back(p);
    --count;
  }
}

}  // namespace glissade::vision::internal
