// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sim/city_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glissade/lie/so3.h"

namespace glissade::sim::internal {

namespace {

double Rounded(double x, double unit) {
  return std::round(x / unit) * unit;
}

constexpr int kWaves = 6;
constexpr double kShortest = 150.0;  // wave lengths, m
constexpr double kLongest = 600.0;
constexpr double kTurnPerMetre = 0.005;  // rotation that comes with the drift, rad

}  // namespace

CityStart::CityStart(const CityOptions& options)
    : options_(options), random_(options.seed, kCityStartStream) {
  NoiseSource random(options.seed, kDriftStream);
  const double size = options.start_drift_m / std::sqrt(kWaves / 2.0);
  for (int k = 0; k < kWaves; ++k) {
    Wave wave{};
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const double number = 2.0 * std::numbers::pi / random.Uniform(kShortest, kLongest);
    wave.way[0] = number * std::cos(angle);
    wave.way[1] = number * std::sin(angle);
    wave.phase = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3 moves = size * random.Direction();
    const Vector3 turns = kTurnPerMetre * size * random.Direction();
    std::copy_n(moves.data(), 3, wave.size);
    std::copy_n(turns.data(), 3, wave.turn);
    waves_.push_back(wave);
  }
}

void CityStart::DriftAt(const double* x, double* moved, double* turned) const {
  for (int i = 0; i < 3; ++i) {
    moved[i] = 0.0;
    if (turned != nullptr) turned[i] = 0.0;
  }
  if (options_.start_drift_m == 0.0) return;
  for (const Wave& wave : waves_) {
    const double s = std::sin(wave.way[0] * x[0] + wave.way[1] * x[1] + wave.phase);
    for (int i = 0; i < 3; ++i) {
      moved[i] += s * wave.size[i];
      if (turned != nullptr) turned[i] += s * wave.turn[i];
    }
  }
}

VertexCameraBal CityStart::Camera(const CityCamera& truth) {
  double moved[3], turned[3];
  DriftAt(truth.c, moved, turned);
  Matrix3 R;
  R << truth.R[0], truth.R[1], truth.R[2], truth.R[3], truth.R[4], truth.R[5], truth.R[6],
      truth.R[7], truth.R[8];
  const Vector3 turn = random_.Normal3(options_.start_rotation_rad);
  R = so3::Exp(turn) * R * so3::Exp(Vector3(turned[0], turned[1], turned[2]));
  const Vector3 off = random_.Normal3(options_.start_centre_m);
  const Vector3 c(truth.c[0] + moved[0] + off[0], truth.c[1] + moved[1] + off[1],
                  truth.c[2] + moved[2] + off[2]);
  const Vector3 w = so3::Log(R);
  const Vector3 t = -(R * c);
  const double focal = random_.Normal(options_.start_focal_relative);
  VertexCameraBal camera;
  for (int i = 0; i < 3; ++i) {
    camera.data[i] = Rounded(w[i], 0x1p-30);
    camera.data[3 + i] = Rounded(t[i], 0x1p-20);
  }
  camera.data[6] = Rounded(truth.f * (1.0 + focal), 0x1p-20);
  camera.data[7] =
      Rounded(truth.k1 + random_.Normal(10.0 * options_.start_focal_relative), 0x1p-30);
  camera.data[8] =
      Rounded(truth.k2 + random_.Normal(10.0 * options_.start_focal_relative), 0x1p-30);
  return camera;
}

VertexPointXYZ CityStart::Point(const double* truth) {
  double moved[3];
  DriftAt(truth, moved, nullptr);
  VertexPointXYZ point;
  for (int i = 0; i < 3; ++i) {
    point.data[i] = Rounded(truth[i] + moved[i] + random_.Normal(options_.start_point_m), 0x1p-20);
  }
  return point;
}

}  // namespace glissade::sim::internal
