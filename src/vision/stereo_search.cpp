// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/stereo_search.h"

#include <algorithm>
#include <cmath>

#include "vision/epipolar.h"

namespace glissade::vision::internal {

namespace {

constexpr int kRadius = 4;
constexpr int kSize = 2 * kRadius + 1;
constexpr double kGoodCorrelation = 0.7;

/// A patch with mean 0 and norm 1; false where it leaves the image or is flat.
bool ReadPatch(const cv::Mat& image, int x, int y, float* patch) {
  if (x < kRadius || y < kRadius || x + kRadius >= image.cols || y + kRadius >= image.rows) {
    return false;
  }
  float sum = 0.0f;
  float* to = patch;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    const unsigned char* row = image.ptr<unsigned char>(y + dy) + x - kRadius;
    for (int dx = 0; dx < kSize; ++dx, ++to) {
      *to = static_cast<float>(row[dx]);
      sum += *to;
    }
  }
  const float mean = sum / (kSize * kSize);
  float squares = 0.0f;
  for (int k = 0; k < kSize * kSize; ++k) {
    patch[k] -= mean;
    squares += patch[k] * patch[k];
  }
  if (!(squares > kSize * kSize)) return false;  // deviation of one grey value
  const float scale = 1.0f / std::sqrt(squares);
  for (int k = 0; k < kSize * kSize; ++k)
    patch[k] *= scale;
  return true;
}

}  // namespace

StereoSearch::StereoSearch(const Camera& first, const Camera& second, double min_depth_m)
    : second_(second),
      T_2_1_(second.T_b_c.Inverse() * first.T_b_c),
      max_inverse_depth_(1.0 / min_depth_m) {}

bool StereoSearch::Project(const double xy[2], double inverse_depth, cv::Point2f* px) const {
  const Vector3 direction = T_2_1_.q() * Vector3(xy[0], xy[1], 1.0);
  const Vector3 p = direction + inverse_depth * Vector3(T_2_1_.p());
  if (!(p[2] > 0.05 * p.norm())) return false;
  const double in_second[2] = {p[0] / p[2], p[1] / p[2]};
  double uv[2];
  if (!second_.Distort(in_second, uv)) return false;
  *px = cv::Point2f(static_cast<float>(uv[0]), static_cast<float>(uv[1]));
  return true;
}

double StereoSearch::InverseDepth(const double xy[2], const double xy_second[2]) const {
  // f_2 x (R f_1 + rho p) = 0, by least squares.
  const Vector3 f(xy_second[0], xy_second[1], 1.0);
  const Vector3 a = f.cross(Vector3(T_2_1_.q() * Vector3(xy[0], xy[1], 1.0)));
  const Vector3 b = f.cross(Vector3(T_2_1_.p()));
  return -a.dot(b) / std::max(1e-300, b.squaredNorm());
}

double StereoSearch::Distance(const double xy[2], const double xy_second[2]) const {
  TwoViews views;
  views.R_a_b = T_2_1_.q().conjugate().toRotationMatrix();
  views.t_a = T_2_1_.Inverse().p().normalized();
  return EpipolarDistance(views, {{xy[0], xy[1]}, {xy_second[0], xy_second[1]}});
}

bool StereoSearch::Search(const FrameImage& first, const FrameImage& second, const cv::Point2f& px,
                          const double xy[2], cv::Point2f* match, double* inverse_depth) const {
  const int level = std::min({2, first.levels(), second.levels()});
  const float scale = static_cast<float>(1 << level);
  float wanted[kSize * kSize], seen[kSize * kSize];
  if (!ReadPatch(first.level(level), cvRound(px.x / scale), cvRound(px.y / scale), wanted)) {
    return false;
  }
  // Steps of one pixel of that level: along the curve they are nearly even in inverse depth.
  cv::Point2f far, near;
  if (!Project(xy, 0.0, &far)) return false;
  double end = max_inverse_depth_;
  while (!Project(xy, end, &near)) {
    end *= 0.7;
    if (end < 1e-3) return false;
  }
  const double length = std::hypot(near.x - far.x, near.y - far.y) / scale;
  const int steps = std::clamp(static_cast<int>(std::ceil(length)), 1, 2000);
  double best = kGoodCorrelation;
  bool found = false;
  int last_x = -1, last_y = -1;
  // A little beyond infinity: calibrations are not exact.
  for (int k = -2; k <= steps; ++k) {
    const double rho = end * k / steps;
    cv::Point2f p;
    if (!Project(xy, rho, &p)) continue;
    const int x = cvRound(p.x / scale), y = cvRound(p.y / scale);
    if (x == last_x && y == last_y) continue;
    last_x = x;
    last_y = y;
    if (!ReadPatch(second.level(level), x, y, seen)) continue;
    double correlation = 0.0;
    for (int i = 0; i < kSize * kSize; ++i)
      correlation += static_cast<double>(wanted[i] * seen[i]);
    if (correlation <= best) continue;
    best = correlation;
    *match = p;
    *inverse_depth = rho;
    found = true;
  }
  return found;
}

}  // namespace glissade::vision::internal
