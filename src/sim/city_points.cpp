// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "sim/city_plan.h"

namespace glissade::sim::internal {

namespace {

// Of the distance from which a point is seen: P(range > r) = (kNear / r)^2, cut off at kFar.
constexpr double kNear = 10.0;
constexpr double kFar = 65.0;
constexpr double kKerbShare = 0.125;

/// A facade, seen from above: from `begin` on along `along`.
struct Facade {
  double begin[2];
  double along[2];
  double normal[2];  // to the street
  double length;
};

/// The k-th facade at a crossing. 0 to 7: the two streets' facades of the four houses at its
/// corners, as far as the tile goes; then those that close a street.
Facade FacadeAt(const CityMap& map, int i, int j, int k) {
  const double p = map.period_m, w = 0.5 * map.street_m;
  const double cx = (i + 0.5) * p, cy = (j + 0.5) * p;
  if (k < 8) {
    const double sx = (k & 1) != 0 ? 1.0 : -1.0, sy = (k & 2) != 0 ? 1.0 : -1.0;
    const double corner[2] = {cx + sx * w, cy + sy * w};
    const double length = 0.5 * (p - map.street_m);
    if ((k & 4) != 0) return {{corner[0], corner[1]}, {sx, 0.0}, {0.0, -sy}, length};
    return {{corner[0], corner[1]}, {0.0, sy}, {-sx, 0.0}, length};
  }
  const double end_x = map.blocks_x * p, end_y = map.blocks_y * p;
  switch (k) {
    case 8:
      return {{0.0, cy - w}, {0.0, 1.0}, {1.0, 0.0}, 2.0 * w};
    case 9:
      return {{end_x, cy - w}, {0.0, 1.0}, {-1.0, 0.0}, 2.0 * w};
    case 10:
      return {{cx - w, 0.0}, {1.0, 0.0}, {0.0, 1.0}, 2.0 * w};
    default:
      return {{cx - w, end_y}, {1.0, 0.0}, {0.0, -1.0}, 2.0 * w};
  }
}

bool Exists(const CityMap& map, int i, int j, int facade) {
  switch (facade) {
    case 8:
      return i == 0;
    case 9:
      return i == map.blocks_x - 1;
    case 10:
      return j == 0;
    case 11:
      return j == map.blocks_y - 1;
    default:
      return true;
  }
}

}  // namespace

double FacadeLength(const CityMap& map, int i, int j) {
  double length = 0.0;
  for (int k = 0; k < 12; ++k) {
    if (Exists(map, i, j, k)) length += FacadeAt(map, i, j, k).length;
  }
  return length;
}

CityPoint DrawPoint(const CityMap& map, int i, int j, NoiseSource* random) {
  double s = random->Uniform(0.0, FacadeLength(map, i, j));
  Facade facade{};
  for (int k = 0; k < 12; ++k) {
    if (!Exists(map, i, j, k)) continue;
    facade = FacadeAt(map, i, j, k);
    if (s < facade.length) break;
    s -= facade.length;
  }
  s = std::min(s, facade.length);
  const bool kerb = random->Uniform(0.0, 1.0) < kKerbShare;
  const double out = random->Uniform(0.0, 1.0), up = random->Uniform(0.0, 1.0);
  // Facades have relief, but none of it is inside the house: nothing is to hide it from the street.
  const double off = kerb ? 1.0 + 1.5 * out : 0.01 + 0.4 * out;
  CityPoint point{};
  for (int axis = 0; axis < 2; ++axis) {
    point.x[axis] = facade.begin[axis] + s * facade.along[axis] + off * facade.normal[axis];
    point.normal[axis] = kerb ? 0.0 : facade.normal[axis];
  }
  point.x[2] = kerb ? 5.0 * up : 0.3 + 12.0 * up * up;
  point.range = std::min(kFar, kNear / std::sqrt(1.0 - random->Uniform(0.0, 1.0)));
  point.detectable = random->Uniform(0.30, 0.85);
  return point;
}

}  // namespace glissade::sim::internal
