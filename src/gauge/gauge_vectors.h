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
  /// The first direction that landmarks in groups move in, as they do in those after it; dim():
  /// none.
  [[nodiscard]] int first_of_lanes() const { return first_of_lanes_; }
  /// One direction over all variables, in the order of NormalEquations::step().
  [[nodiscard]] std::vector<double> Whole(const Structure& structure, int direction) const;
  /// The same with zeros for all but the landmarks in groups.
  [[nodiscard]] std::vector<double> Lanes(const Structure& structure, int direction) const;

 private:
  void FillLanes(const Graph& graph, const Structure& structure, const LinearizedStates& point,
                 const Orbit& orbit);
  [[nodiscard]] const double* At(int block) const {
    const int begin = begin_[static_cast<std::size_t>(block)];
    return begin < 0 ? nullptr : values_.data() + begin;
  }

  int dim_ = 0;
  int num_poses_ = 0;
  std::vector<int> begin_;  // per pose block, then per landmark
  std::vector<double> values_;
  int first_of_lanes_ = 0;
  std::vector<double> lanes_;  // rows of landmarks in groups, in the order of their step
};

}  // namespace glissade
