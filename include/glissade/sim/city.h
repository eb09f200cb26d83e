// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/status.h"
#include "glissade/io/bal.h"

/// \file
/// Large bundle adjustment problems in the form of "Bundle Adjustment in the Large": what a car
/// with cameras sees of a city, of any size. Who sees what is decided by the geometry of streets
/// and houses, so that the reduced system is as sparse as that of a real drive.
namespace glissade::sim {

/// Ground plan of a city, z up, in metres: the square [0, blocks_x period] x [0, blocks_y period].
/// Streets of width `street_m` run along x at y = (j + 1/2) period and along y at
/// x = (i + 1/2) period. Everything between them is houses, with facades along the streets; houses
/// also close every street at its ends, where the square ends.
struct CityMap {
  int blocks_x = 1;  ///< streets along y
  int blocks_y = 1;  ///< streets along x
  double period_m = 60.0;
  double street_m = 16.0;

  /// Inside the square and not in a house.
  [[nodiscard]] bool InStreet(double x, double y) const;
  /// Whether a house is in the way between two places in the streets. Houses are higher than all
  /// that is looked at: z plays no part.
  [[nodiscard]] bool Hidden(double x0, double y0, double x1, double y1) const;
};

/// A car drives along every street at least twice, once in each direction, and along every third
/// one once more, all streets before it comes back to one. Every 2.5 m or so it takes an image: in
/// turn straight ahead, obliquely to the right, obliquely to the left, and at a facade. Images are
/// 1280 x 960 px and 90 degrees wide.
///
/// Points are on facades and, one in eight, at the kerb (lamp posts, parked cars). Each is seen
/// from up to its own distance, of which few are large, by cameras that have it in the image and no
/// house in between; a facade not from its back or at a grazing angle. Of these a part that belongs
/// to the point misses it.
struct CityOptions {
  int num_cameras = 200;  ///< 20 to 20 000
  /// Mean over the cameras, 30 to 5000; 0: what is usual at this size, 576 (num_cameras /
  /// 1000)^0.24 and at most 1000. It is met to some per cent.
  double observations_per_camera = 0.0;
  int min_track = 3;           ///< a point is seen by at least so many cameras; 2 to 10
  double pixel_noise = 0.5;    ///< sigma (px)
  double outlier_share = 0.0;  ///< of the observations, which are anywhere in the image; 0 to 0.5

  // Where a solve begins. The drift bends the whole city smoothly, over some hundred metres, and
  // carries cameras and points along; what is near each other stays consistent.
  double start_drift_m = 0.5;          ///< size of the drift
  double start_point_m = 0.05;         ///< sigma, each axis
  double start_rotation_rad = 0.002;   ///< sigma, each axis
  double start_centre_m = 0.02;        ///< sigma of a camera's centre, each axis
  double start_focal_relative = 2e-3;  ///< sigma of f / f; ten times that in k1 and k2
  std::uint64_t seed = 1;

  [[nodiscard]] Status Validate() const;
};

/// The plan of the city that MakeCity makes. kInvalidArgument where the options make no sense.
[[nodiscard]] Result<CityMap> MapOfCity(const CityOptions& options);

/// Where a solve begins, and noisy observations, point by point and in the order of the cameras at
/// each. Every camera has 20 observations or more, every point min_track or more under rays that
/// are at least 2 degrees apart. With all start_* = 0 cameras and points are the true ones.
///
/// The same numbers for the same seed: what is drawn does not depend on the machine, what is
/// computed from it is rounded to 1/256 px in the image, 2^-20 m and 2^-30 rad, so that the last
/// bits of sin() and log() do not show. kInvalidArgument where the options make no sense.
[[nodiscard]] Result<BalProblem> MakeCity(const CityOptions& options);

}  // namespace glissade::sim
