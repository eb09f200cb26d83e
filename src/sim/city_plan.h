// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/sim/city.h"
#include "glissade/sim/noise_source.h"

namespace glissade::sim::internal {

/// Streams of a seed. Those of tiles begin at kTileStream.
enum : std::uint64_t {
  kDriveStream = 200,
  kPilotStream = 201,
  kMoreStream = 202,
  kCityNoiseStream = 203,
  kCityStartStream = 204,
  kDriftStream = 205,
  kTileStream = 1000,
};

/// Size of an image, px.
inline constexpr double kImageWidth = 1280.0;
inline constexpr double kImageHeight = 960.0;

/// A camera as it is. It looks along its -z axis, y up: x_C = R (X - c).
struct CityCamera {
  double R[9];  ///< world to camera, row by row: right, up, back
  double c[3];  ///< centre
  double f, k1, k2;
};

/// A plan for so many cameras, 2.5 m apart or so along the drives.
CityMap PlanFor(int num_cameras);
/// The cameras of all drives, in the order in which they were there.
std::vector<CityCamera> DriveThrough(const CityMap& map, int num_cameras, std::uint64_t seed);

/// Something to be seen.
struct CityPoint {
  double x[3];
  double normal[2];   ///< of the facade, horizontal; 0 0: seen from all sides
  double range;       ///< seen from up to here, m
  double detectable;  ///< part of the cameras that could see it and do
};
/// One that belongs to the crossing (i, j) and the houses at its corners. Each seed's draws are as
/// many for every point.
CityPoint DrawPoint(const CityMap& map, int i, int j, NoiseSource* random);
/// Metres of facades there: what the number of points goes with.
double FacadeLength(const CityMap& map, int i, int j);

}  // namespace glissade::sim::internal
