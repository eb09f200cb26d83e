// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/city_plan.h"

namespace glissade::sim::internal {

/// Turns true cameras and points into where a solve begins.
class CityStart {
 public:
  explicit CityStart(const CityOptions& options);

  VertexCameraBal Camera(const CityCamera& truth);
  VertexPointXYZ Point(const double* truth);

 private:
  /// A plane wave that moves what is at x by size sin(way . x + phase).
  struct Wave {
    double way[2];
    double phase;
    double size[3];
    double turn[3];
  };
  /// Displacement at x, m, and, where asked for, rotation, rad.
  void DriftAt(const double* x, double* moved, double* turned) const;

  const CityOptions& options_;
  NoiseSource random_;
  std::vector<Wave> waves_;
};

}  // namespace glissade::sim::internal
