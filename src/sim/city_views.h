// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "sim/city_plan.h"

namespace glissade::sim::internal {

/// A camera that sees a point, and where in its image (px, exact).
struct CityView {
  std::int32_t camera;
  double u, v;
};

/// Who sees a point: looks at the cameras near it only.
class CityViews {
 public:
  CityViews(const CityMap& map, const std::vector<CityCamera>& cameras);

  /// The cameras that see it, in their order. Empty where they are fewer than min_track, or where
  /// their rays are so close to each other that its distance is not known.
  void Of(const CityPoint& point, int min_track, NoiseSource* random,
          std::vector<CityView>* views) const;

 private:
  [[nodiscard]] bool Sees(const CityCamera& camera, const CityPoint& point, CityView* view) const;
  [[nodiscard]] bool HaveParallax(const CityPoint& point, const std::vector<CityView>& views) const;

  const CityMap& map_;
  const std::vector<CityCamera>& cameras_;
  // Cameras by the cell of the ground that they are in, row by row: those of cell c are
  // sorted_[begin_[c] .. begin_[c + 1]), number_ says which they are.
  int cells_x_, cells_y_;
  std::vector<std::int32_t> begin_;
  std::vector<std::int32_t> number_;
  std::vector<CityCamera> sorted_;
};

}  // namespace glissade::sim::internal
