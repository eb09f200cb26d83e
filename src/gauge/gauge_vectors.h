// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/gauge/orbit.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/linearized_states.h"
#include "glissade/structure/structure.h"

namespace glissade {

/// Where a vertex is linearized for the sake of the gauge: its first estimate, else where H was.
const double* GaugeState(const VertexPoolBase& pool, int index, const LinearizedStates& point);

/// U of all free vertices in the order of a Structure, in the free coordinates of partly fixed
/// ones.
class GaugeVectors {
 public:
  /// held: vertices that would move but cannot (appended).
  GaugeVectors(const Graph& graph, const Structure& structure, const LinearizedStates& point,
               const Orbit& orbit, std::vector<AnyVertex>* held);

  [[nodiscard]] int dim() const { return dim_; }
  /// Rows of a pose block, dim(block) x dim() row-major; null where they are zero.
  [[nodiscard]] const double* Pose(int block) const { return At(block); }
  [[nodiscard]] const double* Landmark(int landmark) const { return At(num_poses_ + landmark); }
  /// Whether landmarks in groups move.
  [[nodiscard]] bool has_lanes() const { return !lanes_.empty(); }
  /// One direction over all variables, in the order of NormalEquations::step().
  [[nodiscard]] std::vector<double> Whole(const Structure& structure, int direction) const;

 private:
  [[nodiscard]] const double* At(int block) const {
    const int begin = begin_[static_cast<std::size_t>(block)];
    return begin < 0 ? nullptr : values_.data() + begin;
  }

  int dim_ = 0;
  int num_poses_ = 0;
  std::vector<int> begin_;  // per pose block, then per landmark
  std::vector<double> values_;
  std::vector<double> lanes_;  // scale only
};

}  // namespace glissade
