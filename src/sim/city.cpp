// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/city.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"
#include "sim/city_plan.h"
#include "sim/city_start.h"
#include "sim/city_views.h"

namespace glissade::sim {

using glissade::internal::Index;
using internal::CityPoint;
using internal::CityView;

namespace {

constexpr int kMinPerCamera = 20;

double ObservationsPerCamera(const CityOptions& options) {
  if (options.observations_per_camera > 0.0) return options.observations_per_camera;
  return std::min(1000.0, 576.0 * std::pow(options.num_cameras / 1000.0, 0.24));
}

double RoundedPixel(double x) {
  return std::round(x * 256.0) / 256.0;
}

/// Takes points as they are drawn and writes them down as a BAL problem.
class CityBuilder {
 public:
  explicit CityBuilder(const CityOptions& options)
      : options_(options),
        map_(internal::PlanFor(options.num_cameras)),
        cameras_(internal::DriveThrough(map_, options.num_cameras, options.seed)),
        views_(map_, cameras_),
        noise_(options.seed, internal::kCityNoiseStream),
        start_(options),
        seen_(cameras_.size(), 0) {
    problem_.cameras.reserve(cameras_.size());
    for (const internal::CityCamera& camera : cameras_)
      problem_.cameras.push_back(start_.Camera(camera));
  }
  CityBuilder(const CityBuilder&) = delete;
  CityBuilder& operator=(const CityBuilder&) = delete;

  /// As many points as it takes for the number of observations.
  void AddPoints();
  /// More of them for cameras that see little.
  Status AddMore();
  BalProblem Take() && { return std::move(problem_); }

 private:
  /// What one point that is drawn comes to.
  struct Yield {
    double points, observations;
  };
  [[nodiscard]] Yield TryOut() const;
  void Add(const CityPoint& point, const std::vector<CityView>& views);

  const CityOptions& options_;
  const CityMap map_;
  const std::vector<internal::CityCamera> cameras_;
  const internal::CityViews views_;
  NoiseSource noise_;
  internal::CityStart start_;
  std::vector<int> seen_;  // observations by camera
  BalProblem problem_;
};

CityBuilder::Yield CityBuilder::TryOut() const {
  // Tiles in turn, as often as their facades are long: the shorter one is left out at times.
  constexpr int kTries = 40000;
  NoiseSource random(options_.seed, internal::kPilotStream);
  std::vector<CityView> views;
  Yield yield{};
  double longest = 0.0;
  for (int j = 0; j < map_.blocks_y; ++j) {
    for (int i = 0; i < map_.blocks_x; ++i)
      longest = std::max(longest, internal::FacadeLength(map_, i, j));
  }
  for (int tries = 0; tries < kTries;) {
    const int i = static_cast<int>(random.Uniform(0.0, map_.blocks_x));
    const int j = static_cast<int>(random.Uniform(0.0, map_.blocks_y));
    if (random.Uniform(0.0, longest) > internal::FacadeLength(map_, i, j)) continue;
    ++tries;
    views_.Of(internal::DrawPoint(map_, i, j, &random), options_.min_track, &random, &views);
    if (!views.empty()) yield.points += 1.0 / kTries;
    yield.observations += static_cast<double>(views.size()) / kTries;
  }
  return yield;
}

void CityBuilder::AddPoints() {
  const Yield yield = TryOut();
  const double wanted = ObservationsPerCamera(options_) * options_.num_cameras;
  const double draws = wanted / yield.observations;
  constexpr double kMargin = 1.03;
  problem_.points.reserve(Index(static_cast<std::int64_t>(kMargin * draws * yield.points)) + 1000);
  problem_.observations.reserve(Index(static_cast<std::int64_t>(kMargin * wanted)) + 1000);

  double total = 0.0;
  for (int j = 0; j < map_.blocks_y; ++j) {
    for (int i = 0; i < map_.blocks_x; ++i)
      total += internal::FacadeLength(map_, i, j);
  }
  std::vector<CityView> views;
  double before = 0.0;
  std::int64_t drawn = 0;
  for (int j = 0; j < map_.blocks_y; ++j) {
    for (int i = 0; i < map_.blocks_x; ++i) {
      NoiseSource random(options_.seed, internal::kTileStream + Index(j) * 1000 + Index(i));
      before += internal::FacadeLength(map_, i, j);
      for (; static_cast<double>(drawn) < draws * before / total; ++drawn) {
        const CityPoint point = internal::DrawPoint(map_, i, j, &random);
        views_.Of(point, options_.min_track, &random, &views);
        if (!views.empty()) Add(point, views);
      }
    }
  }
}

Status CityBuilder::AddMore() {
  constexpr int kTries = 20000;
  NoiseSource random(options_.seed, internal::kMoreStream);
  std::vector<CityView> views;
  const auto tile = [&](double x, int tiles) {
    return std::clamp(static_cast<int>(std::floor(x / map_.period_m)), 0, tiles - 1);
  };
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    const internal::CityCamera& camera = cameras_[k];
    // It looks along -R's third row; 15 m ahead there is something to see.
    const int i = tile(camera.c[0] - 15.0 * camera.R[6], map_.blocks_x);
    const int j = tile(camera.c[1] - 15.0 * camera.R[7], map_.blocks_y);
    for (int tries = 0; tries < kTries && seen_[k] < kMinPerCamera; ++tries) {
      const CityPoint point = internal::DrawPoint(map_, i, j, &random);
      views_.Of(point, options_.min_track, &random, &views);
      const auto is_it = [&](const CityView& view) { return Index(view.camera) == k; };
      if (std::any_of(views.begin(), views.end(), is_it)) Add(point, views);
    }
    if (seen_[k] < kMinPerCamera) {
      return {StatusCode::kInvalidArgument,
              "city: camera " + std::to_string(k) + " sees too little with this min_track"};
    }
  }
  return {};
}

void CityBuilder::Add(const CityPoint& point, const std::vector<CityView>& views) {
  const auto index = static_cast<std::int32_t>(problem_.points.size());
  problem_.points.push_back(start_.Point(point.x));
  for (const CityView& view : views) {
    BalObservation o{view.camera, index, view.u, view.v};
    if (options_.outlier_share > 0.0 && noise_.Uniform(0.0, 1.0) < options_.outlier_share) {
      o.u = noise_.Uniform(-0.5, 0.5) * internal::kImageWidth;
      o.v = noise_.Uniform(-0.5, 0.5) * internal::kImageHeight;
    } else {
      o.u += noise_.Normal(options_.pixel_noise);
      o.v += noise_.Normal(options_.pixel_noise);
    }
    o.u = RoundedPixel(o.u);
    o.v = RoundedPixel(o.v);
    problem_.observations.push_back(o);
    ++seen_[Index(view.camera)];
  }
}

}  // namespace

Status CityOptions::Validate() const {
  const auto wrong = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("city: ").append(what));
  };
  if (num_cameras < 20 || num_cameras > 20000) return wrong("num_cameras must be 20 to 20000");
  const double n = observations_per_camera;
  if (!(n == 0.0 || (n >= 30.0 && n <= 5000.0))) {
    return wrong("observations_per_camera must be 30 to 5000, or 0");
  }
  if (min_track < 2 || min_track > 10) return wrong("min_track must be 2 to 10");
  if (!(outlier_share >= 0.0 && outlier_share <= 0.5)) {
    return wrong("outlier_share must be 0 to 0.5");
  }
  // Far more than a start can be off: what is computed from it is still finite.
  constexpr double kMost = 1e3;
  for (const double x : {pixel_noise, start_drift_m, start_point_m, start_rotation_rad,
                         start_centre_m, start_focal_relative}) {
    if (!(x >= 0.0 && x <= kMost)) return wrong("noise must be 0 to 1000");
  }
  return {};
}

Result<CityMap> MapOfCity(const CityOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  return internal::PlanFor(options.num_cameras);
}

Result<BalProblem> MakeCity(const CityOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  return glissade::internal::OrOutOfMemory([&]() -> Result<BalProblem> {
    CityBuilder builder(options);
    builder.AddPoints();
    if (Status s = builder.AddMore(); !s.ok()) return s;
    return std::move(builder).Take();
  });
}

}  // namespace glissade::sim
