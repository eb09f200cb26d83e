// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sim/city_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glissade/base/index.h"
#include "glissade/lie/so3.h"

namespace glissade::sim {

namespace {

// A drive begins and ends so far from the house that closes the street: from there it has width.
constexpr double kEnd = 10.0;
constexpr double kStep = 2.5;     // along a drive, from image to image
constexpr double kPeriod = 60.0;  // of the streets, about
constexpr double kMinPeriod = 40.0;

/// One way along one street.
struct Drive {
  bool along_x;
  int street;
  bool forward;    // in the direction of the axis
  double lateral;  // to the right of the middle of the street, m
};

/// Every street in one direction, then in the other, then every third once more.
std::vector<Drive> Drives(const CityMap& map, int third) {
  std::vector<Drive> drives;
  for (int pass = 0; pass < 3; ++pass) {
    const int streets = map.blocks_x + map.blocks_y;
    for (int k = 0; k < streets; ++k) {
      if (pass == 2 && (k + third) % 3 != 0) continue;
      const bool along_x = k < map.blocks_y;
      const bool forward = pass == 2 ? (k + third) % 2 == 0 : (k + pass) % 2 == 0;
      drives.push_back({along_x, along_x ? k : k - map.blocks_y, forward, pass == 2 ? 3.5 : 2.0});
    }
  }
  return drives;
}

double LengthOf(const CityMap& map, const Drive& drive) {
  return map.period_m * (drive.along_x ? map.blocks_x : map.blocks_y) - 2.0 * kEnd;
}

/// Where the camera looks, from straight ahead to the left: ahead, right, left, and in turn the two
/// facades.
double LooksTo(int k) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  switch (k % 4) {
    case 0:
      return 0.0;
    case 1:
      return -50.0 * kDegree;
    case 2:
      return 50.0 * kDegree;
    default:
      return (k / 4) % 2 == 0 ? -85.0 * kDegree : 85.0 * kDegree;
  }
}

internal::CityCamera CameraAt(double x, double y, double yaw, NoiseSource* random) {
  const double pitch = 0.12 + random->Normal(0.02);
  const Vector3 ahead(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                      std::sin(pitch));
  const Vector3 right(std::sin(yaw), -std::cos(yaw), 0.0);
  Matrix3 R;
  R << right.transpose(), (right.cross(ahead)).transpose(), -ahead.transpose();
  R = so3::Exp(random->Normal3(0.01)) * R;
  internal::CityCamera camera{};
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col)
      camera.R[3 * row + col] = R(row, col);
  }
  camera.c[0] = x + random->Normal(0.2);
  camera.c[1] = y + random->Normal(0.2);
  camera.c[2] = 2.0 + random->Normal(0.05);
  camera.f = 640.0 + random->Normal(10.0);
  camera.k1 = -0.05 + random->Normal(0.01);
  camera.k2 = 0.01 + random->Normal(0.002);
  return camera;
}

}  // namespace

bool CityMap::InStreet(double x, double y) const {
  if (!(x >= 0.0 && x <= blocks_x * period_m && y >= 0.0 && y <= blocks_y * period_m)) return false;
  const auto from_middle = [&](double z) {
    return std::abs(z - (std::floor(z / period_m) + 0.5) * period_m);
  };
  return from_middle(x) <= 0.5 * street_m || from_middle(y) <= 0.5 * street_m;
}

bool CityMap::Hidden(double x0, double y0, double x1, double y1) const {
  // Blocks are squares around multiples of the period. Of those that the bounding box of the line
  // of sight meets, one is in the way unless the line passes it on one side (separating axis).
  const double half = 0.5 * (period_m - street_m);
  const int i0 = static_cast<int>(std::ceil((std::min(x0, x1) - half) / period_m));
  const int i1 = static_cast<int>(std::floor((std::max(x0, x1) + half) / period_m));
  const int j0 = static_cast<int>(std::ceil((std::min(y0, y1) - half) / period_m));
  const int j1 = static_cast<int>(std::floor((std::max(y0, y1) + half) / period_m));
  const double nx = y0 - y1, ny = x1 - x0;
  const double reach = half * (std::abs(nx) + std::abs(ny));
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      if (std::abs(nx * (i * period_m - x0) + ny * (j * period_m - y0)) < reach) return true;
    }
  }
  return false;
}

namespace internal {

CityMap PlanFor(int num_cameras) {
  // Of blocks_x <= blocks_y <= blocks_x + 1 that whose streets come closest to kPeriod.
  CityMap best;
  double off = std::numeric_limits<double>::infinity();
  for (int n = 1; n < 64; ++n) {
    for (int m = n; m <= n + 1; ++m) {
      CityMap map;
      map.blocks_x = n;
      map.blocks_y = m;
      // 7/3 drives along n streets of m periods and m streets of n, each 2 kEnd shorter.
      const double streets = 3.0 / 7.0 * kStep * num_cameras + 2.0 * kEnd * (n + m);
      const double period = streets / (2.0 * n * m);
      map.period_m = std::max(kMinPeriod, std::round(period * 16.0) / 16.0);
      const double this_off = std::max(period / kPeriod, kPeriod / period);
      if (this_off < off) best = map;
      off = std::min(off, this_off);
    }
  }
  return best;
}

std::vector<CityCamera> DriveThrough(const CityMap& map, int num_cameras, std::uint64_t seed) {
  NoiseSource random(seed, kDriveStream);
  const std::vector<Drive> drives = Drives(map, static_cast<int>(random.Next() % 3));
  double length = 0.0;
  for (const Drive& drive : drives)
    length += LengthOf(map, drive);
  const double step = length / num_cameras;

  std::vector<CityCamera> cameras;
  cameras.reserve(glissade::internal::Index(num_cameras));
  std::size_t d = 0;
  double begun = 0.0;  // what the drives before have of the whole way
  for (int k = 0; k < num_cameras; ++k) {
    const double way = (k + 0.5) * step;
    while (d + 1 < drives.size() && way > begun + LengthOf(map, drives[d]))
      begun += LengthOf(map, drives[d++]);
    const Drive& drive = drives[d];
    const double sign = drive.forward ? 1.0 : -1.0;
    const double from_end = kEnd + (way - begun);
    const double end = LengthOf(map, drive) + 2.0 * kEnd;
    const double along = drive.forward ? from_end : end - from_end;
    const double middle = (drive.street + 0.5) * map.period_m;
    const double looks =
        LooksTo(k) + random.Normal(0.03) + (drive.forward ? 0.0 : std::numbers::pi);
    // To the right of a car along x is -y, along y is +x.
    if (drive.along_x) {
      cameras.push_back(CameraAt(along, middle - sign * drive.lateral, looks, &random));
    } else {
      cameras.push_back(
          CameraAt(middle + sign * drive.lateral, along, looks + 0.5 * std::numbers::pi, &random));
    }
  }
  return cameras;
}

}  // namespace internal

}  // namespace glissade::sim
