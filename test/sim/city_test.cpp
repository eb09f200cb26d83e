// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/city.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "glissade/lie/so3.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/noise_source.h"

namespace glissade::sim {
namespace {

CityOptions Exact(int num_cameras) {
  CityOptions options;
  options.num_cameras = num_cameras;
  options.start_drift_m = options.start_point_m = options.start_rotation_rad = 0.0;
  options.start_centre_m = options.start_focal_relative = 0.0;
  return options;
}

bool SameBits(const BalProblem& a, const BalProblem& b) {
  return a.observations == b.observations && a.cameras.size() == b.cameras.size() &&
         a.points.size() == b.points.size() &&
         std::memcmp(a.cameras.data(), b.cameras.data(), a.cameras.size() * sizeof(a.cameras[0])) ==
             0 &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(a.points[0])) == 0;
}

std::size_t At(std::int32_t k) {
  return static_cast<std::size_t>(k);
}

Vector3 Centre(const VertexCameraBal& camera) {
  const double* d = camera.data;
  return -(so3::Exp(Vector3(d[0], d[1], d[2])).transpose() * Vector3(d[3], d[4], d[5]));
}

/// Residual of an observation, px.
Vector2 ResidualOf(const BalProblem& p, const BalObservation& o) {
  Vector2 r;
  EXPECT_TRUE(EdgeBal{Vector2(o.u, o.v)}.Evaluate(p.cameras[At(o.camera)], p.points[At(o.point)], r,
                                                  nullptr, nullptr));
  return r;
}

/// First observation of each point, and the end.
std::vector<std::size_t> Tracks(const BalProblem& p) {
  std::vector<std::size_t> begin;
  for (std::size_t k = 0; k < p.observations.size(); ++k) {
    if (k == 0 || p.observations[k].point != p.observations[k - 1].point) begin.push_back(k);
  }
  begin.push_back(p.observations.size());
  return begin;
}

TEST(City, CountsGrowAsInBal) {
  double track_before = 0.0;
  for (const int n : {50, 200, 1000}) {
    const auto city = MakeCity({.num_cameras = n});
    ASSERT_TRUE(city.ok()) << city.status().message();
    ASSERT_EQ(city->cameras.size(), static_cast<std::size_t>(n));
    const auto observations = static_cast<double>(city->observations.size());
    EXPECT_NEAR(observations / n / (576.0 * std::pow(n / 1000.0, 0.24)), 1.0, 0.05) << n;
    const double track = observations / static_cast<double>(city->points.size());
    EXPECT_GT(track, std::max(4.0, track_before)) << n;
    EXPECT_LT(track, 8.0) << n;
    track_before = track;
  }
  CityOptions few = {.num_cameras = 100, .observations_per_camera = 60.0, .min_track = 2};
  const auto city = MakeCity(few);
  ASSERT_TRUE(city.ok());
  EXPECT_NEAR(static_cast<double>(city->observations.size()) / 6000.0, 1.0, 0.1);
}

TEST(City, ObservationsArePointByPointAndNobodySeesTooLittle) {
  for (const double per_camera : {0.0, 30.0}) {
    const auto city = MakeCity({.num_cameras = 150, .observations_per_camera = per_camera});
    ASSERT_TRUE(city.ok());
    const auto& observations = city->observations;
    std::vector<int> seen(city->cameras.size(), 0);
    for (std::size_t k = 0; k < observations.size(); ++k) {
      ++seen[At(observations[k].camera)];
      if (k == 0) continue;
      const bool same = observations[k].point == observations[k - 1].point;
      ASSERT_TRUE(same ? observations[k].camera > observations[k - 1].camera
                       : observations[k].point == observations[k - 1].point + 1);
    }
    EXPECT_GE(*std::min_element(seen.begin(), seen.end()), 20);
    const auto begin = Tracks(*city);
    ASSERT_EQ(begin.size(), city->points.size() + 1);
    std::size_t shortest = 1000, longest = 0;
    for (std::size_t j = 0; j + 1 < begin.size(); ++j) {
      shortest = std::min(shortest, begin[j + 1] - begin[j]);
      longest = std::max(longest, begin[j + 1] - begin[j]);
    }
    EXPECT_EQ(shortest, 3u);
    if (per_camera == 0.0) {
      EXPECT_GE(longest, 20u);
    }
  }
}

TEST(City, TheSameSeedGivesTheSameNumbers) {
  CityOptions options = {.num_cameras = 60, .seed = 7};
  const auto city = MakeCity(options);
  EXPECT_TRUE(SameBits(*city, *MakeCity(options)));
  // Where a solve begins does not change what was seen.
  CityOptions other_start = options;
  other_start.start_drift_m = 2.0;
  other_start.start_rotation_rad = 0.0;
  EXPECT_EQ(city->observations, MakeCity(other_start)->observations);
  EXPECT_FALSE(SameBits(*city, *MakeCity(other_start)));
  options.seed = 8;
  EXPECT_NE(city->observations, MakeCity(options)->observations);

  // On every machine: FNV-1a of indices and pixels, which are multiples of 1/256.
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&](std::int64_t x) {
    hash = (hash ^ static_cast<std::uint64_t>(x)) * 1099511628211u;
  };
  for (const BalObservation& o : city->observations) {
    add(o.camera);
    add(o.point);
    add(static_cast<std::int64_t>(o.u * 256.0));
    add(static_cast<std::int64_t>(o.v * 256.0));
    EXPECT_EQ(o.u * 256.0, std::floor(o.u * 256.0));
  }
  for (const VertexPointXYZ& point : city->points)
    add(static_cast<std::int64_t>(point.data[0] * 0x1p20));
  for (const VertexCameraBal& camera : city->cameras)
    add(static_cast<std::int64_t>(camera.data[1] * 0x1p30));
  EXPECT_EQ(hash, 16267323690978999606u);
}

TEST(City, WhatIsSeenIsBeforeTheCameraInTheImageAndNotBehindAHouse) {
  CityOptions options = Exact(200);
  options.pixel_noise = 0.0;
  const auto city = MakeCity(options);
  ASSERT_TRUE(city.ok());
  const CityMap map = MapOfCity(options).value();
  std::vector<Vector3> centres;
  for (const VertexCameraBal& camera : city->cameras) {
    centres.push_back(Centre(camera));
    EXPECT_TRUE(map.InStreet(centres.back()[0], centres.back()[1]));
  }
  double farthest = 0.0;
  for (const BalObservation& o : city->observations) {
    const EdgeBal edge{Vector2(o.u, o.v)};
    const VertexPointXYZ& point = city->points[At(o.point)];
    ASSERT_GT(edge.Depth(city->cameras[At(o.camera)], point), 0.9);
    ASSERT_LE(std::abs(o.u), 640.0);
    ASSERT_LE(std::abs(o.v), 480.0);
    // Pixels, points and cameras are rounded.
    ASSERT_LT(ResidualOf(*city, o).norm(), 0.01);
    const Vector3 c = centres[At(o.camera)], ray = point.p() - c;
    farthest = std::max(farthest, ray.norm());
    for (int k = 0; k <= 200; ++k) {
      const Vector3 x = c + (k / 200.0) * ray;
      ASSERT_TRUE(map.InStreet(x[0], x[1])) << o.camera << " " << o.point << " " << k;
    }
  }
  EXPECT_GT(farthest, 50.0);
}

TEST(City, HiddenIsWhatSamplesOfTheLineSay) {
  const CityMap map{.blocks_x = 3, .blocks_y = 2, .period_m = 50.0, .street_m = 14.0};
  EXPECT_FALSE(map.InStreet(-1.0, 25.0));
  EXPECT_FALSE(map.InStreet(151.0, 25.0));
  EXPECT_TRUE(map.InStreet(149.0, 25.0));
  EXPECT_FALSE(map.InStreet(50.0, 50.0));
  NoiseSource random(3);
  int hidden = 0, seen = 0;
  while (hidden + seen < 3000) {
    const double x0 = random.Uniform(0.0, 150.0), y0 = random.Uniform(0.0, 100.0);
    const double x1 = random.Uniform(0.0, 150.0), y1 = random.Uniform(0.0, 100.0);
    if (!map.InStreet(x0, y0) || !map.InStreet(x1, y1)) continue;
    constexpr int kSamples = 2000;
    int inside = 0;
    for (int k = 0; k <= kSamples; ++k) {
      const double s = static_cast<double>(k) / kSamples;
      if (!map.InStreet(x0 + s * (x1 - x0), y0 + s * (y1 - y0))) ++inside;
    }
    const bool is_hidden = map.Hidden(x0, y0, x1, y1);
    // A corner that is cut between two samples is not seen by them.
    ASSERT_TRUE(inside == 0 || is_hidden);
    if (inside == 0 && is_hidden) continue;
    ++(is_hidden ? hidden : seen);
  }
  EXPECT_GT(hidden, 300);
  EXPECT_GT(seen, 300);
}

TEST(City, RaysOfAPointAreApart) {
  const auto city = MakeCity(Exact(100));
  const auto begin = Tracks(*city);
  std::vector<Vector3> centres;
  for (const VertexCameraBal& camera : city->cameras)
    centres.push_back(Centre(camera));
  for (std::size_t j = 0; j + 1 < begin.size(); ++j) {
    double smallest = 1.0;
    for (std::size_t a = begin[j]; a < begin[j + 1]; ++a) {
      for (std::size_t b = begin[j]; b < a; ++b) {
        const Vector3 x = city->points[j].p();
        const Vector3 ra = (x - centres[At(city->observations[a].camera)]).normalized();
        const Vector3 rb = (x - centres[At(city->observations[b].camera)]).normalized();
        smallest = std::min(smallest, ra.dot(rb));
      }
    }
    ASSERT_LT(smallest, std::cos(2.0 / 57.2958) + 1e-6) << j;
  }
}

TEST(City, StreetsAreComeBackTo) {
  // Points that two drives saw, the images of which are far apart in number.
  const auto city = MakeCity({.num_cameras = 200});
  const auto begin = Tracks(*city);
  int twice = 0;
  for (std::size_t j = 0; j + 1 < begin.size(); ++j) {
    const auto& o = city->observations;
    if (o[begin[j + 1] - 1].camera - o[begin[j]].camera > 66) ++twice;
  }
  EXPECT_GT(twice, static_cast<int>(city->points.size()) / 4);
}

TEST(City, TheReducedSystemIsSparse) {
  for (const auto& [n, low, high] : {std::tuple{1000, 0.05, 0.15}, std::tuple{2000, 0.03, 0.09}}) {
    const auto city = MakeCity({.num_cameras = n});
    std::vector<bool> pair(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    const auto begin = Tracks(*city);
    for (std::size_t j = 0; j + 1 < begin.size(); ++j) {
      for (std::size_t a = begin[j]; a < begin[j + 1]; ++a) {
        for (std::size_t b = begin[j]; b < begin[j + 1]; ++b) {
          pair[At(city->observations[a].camera) * At(n) + At(city->observations[b].camera)] = true;
        }
      }
    }
    const double density = static_cast<double>(std::count(pair.begin(), pair.end(), true)) /
                           static_cast<double>(pair.size());
    EXPECT_GT(density, low) << n;
    EXPECT_LT(density, high) << n;
  }
}

TEST(City, NoiseAndOutliers) {
  CityOptions options = Exact(200);
  const auto city = MakeCity(options);
  double sum = 0.0, sum2 = 0.0;
  for (const BalObservation& o : city->observations) {
    const Vector2 r = ResidualOf(*city, o);
    sum += r[0] + r[1];
    sum2 += r.squaredNorm();
    ASSERT_LT(r.norm(), 4.0);  // eight sigma
  }
  const double n = 2.0 * static_cast<double>(city->observations.size());
  EXPECT_NEAR(sum / n, 0.0, 5.0 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(sum2 / n / 0.25, 1.0, 5.0 * std::sqrt(2.0 / n));

  options.outlier_share = 0.04;
  const auto with_outliers = MakeCity(options);
  ASSERT_EQ(with_outliers->observations.size(), city->observations.size());
  double outliers = 0.0;
  for (const BalObservation& o : with_outliers->observations) {
    if (ResidualOf(*with_outliers, o).norm() > 4.0) ++outliers;
  }
  EXPECT_NEAR(outliers / (0.5 * n), 0.04, 5.0 * std::sqrt(0.04 / (0.5 * n)) + 0.001);
}

TEST(City, TheStartIsOffSmoothly) {
  CityOptions options = {.num_cameras = 200};
  const auto start = MakeCity(options);
  const auto truth = MakeCity(Exact(200));
  ASSERT_EQ(start->points.size(), truth->points.size());
  const auto moved = [&](std::size_t j) {
    return Vector3(start->points[j].p() - truth->points[j].p());
  };
  double most = 0.0;
  for (std::size_t j = 0; j < start->points.size(); ++j) {
    most = std::max(most, moved(j).norm());
    // What is near moves the same way: 0.05 m a point and 1 % of the distance.
    if (j == 0) continue;
    const double distance = (truth->points[j].p() - truth->points[j - 1].p()).norm();
    ASSERT_LT((moved(j) - moved(j - 1)).norm(), 8.0 * 0.05 + 0.03 * distance);
  }
  EXPECT_GT(most, 0.3);
  EXPECT_LT(most, 2.0);
  double sum2 = 0.0;
  for (const BalObservation& o : start->observations)
    sum2 += ResidualOf(*start, o).squaredNorm();
  const double rms = std::sqrt(sum2 / static_cast<double>(start->observations.size()));
  EXPECT_GT(rms, 3.0);
  EXPECT_LT(rms, 30.0);
}

TEST(City, ASolveEndsAtTheNoise) {
  CityOptions options = {.num_cameras = 60, .observations_per_camera = 150.0};
  const auto city = MakeCity(options);
  Problem problem;
  ASSERT_TRUE(AddToGraph(*city, problem).ok());
  const SolveSummary& summary = problem.Solve({.max_iterations = 60});
  ASSERT_TRUE(summary.ok()) << summary.status.message();
  const double rows = 2.0 * static_cast<double>(city->observations.size());
  const double free = 9.0 * static_cast<double>(city->cameras.size()) +
                      3.0 * static_cast<double>(city->points.size()) - 7.0;
  const double expected = 0.5 * 0.25 * (rows - free);
  EXPECT_NEAR(summary.final_cost / expected, 1.0, 5.0 * std::sqrt(2.0 / (rows - free)));
  EXPECT_GT(summary.initial_cost, 20.0 * expected);
}

TEST(City, OptionsThatMakeNoSenseAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto&& spoil, const char* names) {
    CityOptions options;
    spoil(options);
    const auto city = MakeCity(options);
    EXPECT_EQ(city.status().code(), StatusCode::kInvalidArgument) << names;
    EXPECT_NE(city.status().message().find(names), std::string::npos) << city.status().message();
    EXPECT_FALSE(MapOfCity(options).ok());
  };
  refused([](CityOptions& o) { o.num_cameras = 19; }, "num_cameras");
  refused([](CityOptions& o) { o.num_cameras = 20001; }, "num_cameras");
  refused([](CityOptions& o) { o.observations_per_camera = 29.0; }, "observations_per_camera");
  refused([=](CityOptions& o) { o.observations_per_camera = nan; }, "observations_per_camera");
  refused([](CityOptions& o) { o.min_track = 1; }, "min_track");
  refused([](CityOptions& o) { o.outlier_share = 0.6; }, "outlier_share");
  refused([=](CityOptions& o) { o.outlier_share = nan; }, "outlier_share");
  refused([](CityOptions& o) { o.pixel_noise = -0.1; }, "noise");
  refused([=](CityOptions& o) { o.start_drift_m = nan; }, "noise");
  refused([](CityOptions& o) { o.start_focal_relative = 1e9; }, "noise");
  EXPECT_TRUE(MakeCity({.num_cameras = 20}).ok());
}

}  // namespace
}  // namespace glissade::sim
