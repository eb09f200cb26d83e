// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sim/city_views.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"

namespace glissade::sim::internal {

using glissade::internal::Index;

namespace {

constexpr double kCell = 8.0;          // m
constexpr double kMinDepth = 1.0;      // m
constexpr double kMinCosine = 0.17;    // between the normal of a facade and the line of sight
constexpr double kMinSine2 = 1.22e-3;  // of the angle between rays, squared: 2 degrees

int CellOf(double x, int cells) {
  return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, cells - 1);
}

}  // namespace

CityViews::CityViews(const CityMap& map, const std::vector<CityCamera>& cameras)
    : map_(map),
      cameras_(cameras),
      cells_x_(static_cast<int>(std::ceil(map.blocks_x * map.period_m / kCell))),
      cells_y_(static_cast<int>(std::ceil(map.blocks_y * map.period_m / kCell))),
      begin_(Index(std::int64_t{cells_x_} * cells_y_ + 1), 0),
      number_(cameras.size()),
      sorted_(cameras.size()) {
  const auto cell = [&](const CityCamera& camera) {
    return Index(std::int64_t{CellOf(camera.c[1], cells_y_)} * cells_x_ +
                 CellOf(camera.c[0], cells_x_));
  };
  for (const CityCamera& camera : cameras)
    ++begin_[cell(camera) + 1];
  for (std::size_t c = 1; c < begin_.size(); ++c)
    begin_[c] += begin_[c - 1];
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const std::size_t place = Index(next[cell(cameras[k])]++);
    number_[place] = static_cast<std::int32_t>(k);
    sorted_[place] = cameras[k];
  }
}

bool CityViews::Sees(const CityCamera& camera, const CityPoint& point, CityView* view) const {
  const double d[3] = {point.x[0] - camera.c[0], point.x[1] - camera.c[1],
                       point.x[2] - camera.c[2]};
  const double* R = camera.R;
  const double depth = -(R[6] * d[0] + R[7] * d[1] + R[8] * d[2]);
  if (depth < kMinDepth) return false;
  const double distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  if (distance2 > point.range * point.range) return false;
  const double x = (R[0] * d[0] + R[1] * d[1] + R[2] * d[2]) / depth;
  const double y = (R[3] * d[0] + R[4] * d[1] + R[5] * d[2]) / depth;
  const double n = x * x + y * y;
  const double scale = camera.f * (1.0 + n * (camera.k1 + camera.k2 * n));
  view->u = scale * x;
  view->v = scale * y;
  if (std::abs(view->u) > 0.5 * kImageWidth || std::abs(view->v) > 0.5 * kImageHeight) return false;
  if (point.normal[0] != 0.0 || point.normal[1] != 0.0) {
    const double cosine = -(point.normal[0] * d[0] + point.normal[1] * d[1]);
    if (cosine < 0.0 || cosine * cosine < kMinCosine * kMinCosine * distance2) return false;
  }
  return !map_.Hidden(camera.c[0], camera.c[1], point.x[0], point.x[1]);
}

bool CityViews::HaveParallax(const CityPoint& point, const std::vector<CityView>& views) const {
  // Against the first ray: at least half of the largest angle between any two.
  const auto ray = [&](const CityView& view, int axis) {
    return point.x[axis] - cameras_[Index(view.camera)].c[axis];
  };
  const double a[3] = {ray(views[0], 0), ray(views[0], 1), ray(views[0], 2)};
  return std::any_of(views.begin() + 1, views.end(), [&](const CityView& view) {
    const double b[3] = {ray(view, 0), ray(view, 1), ray(view, 2)};
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]};
    const double lengths2 =
        (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    return c[0] * c[0] + c[1] * c[1] + c[2] * c[2] >= kMinSine2 * lengths2;
  });
}

void CityViews::Of(const CityPoint& point, int min_track, NoiseSource* random,
                   std::vector<CityView>* views) const {
  views->clear();
  // Cells within its range, of a facade before it.
  const auto low = [&](int axis) {
    return point.x[axis] - (point.normal[axis] > 0.0 ? 0.0 : point.range);
  };
  const auto high = [&](int axis) {
    return point.x[axis] + (point.normal[axis] < 0.0 ? 0.0 : point.range);
  };
  const int x0 = CellOf(low(0), cells_x_), x1 = CellOf(high(0), cells_x_);
  const int y0 = CellOf(low(1), cells_y_), y1 = CellOf(high(1), cells_y_);
  for (int y = y0; y <= y1; ++y) {
    const std::int64_t row = std::int64_t{y} * cells_x_;
    for (std::int32_t k = begin_[Index(row + x0)]; k < begin_[Index(row + x1 + 1)]; ++k) {
      CityView view{number_[Index(k)], 0.0, 0.0};
      if (Sees(sorted_[Index(k)], point, &view)) views->push_back(view);
    }
  }
  std::sort(views->begin(), views->end(),
            [](const CityView& a, const CityView& b) { return a.camera < b.camera; });
  std::erase_if(*views,
                [&](const CityView&) { return random->Uniform(0.0, 1.0) >= point.detectable; });
  if (static_cast<int>(views->size()) < min_track || !HaveParallax(point, *views)) views->clear();
}

}  // namespace glissade::sim::internal
