// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/gauge/orbit.h"

namespace glissade {

/// A gauge as equations c(x) = 0, one per direction of its group, on the anchor and, for kMono, on
/// the second camera:
///     kVisualInertial   p - p0, e_z' Log(R R0')                              (Eqs. 9-11)
///     kStereo           p - p0, Log(R R0')
///     kMono             the same, and b_k - b0 with b = R' (centre of the second camera - centre
///     of
///                       the anchor's), k its largest coordinate when the gauge was first named
struct GaugeConstraint {
  GaugeGroup group = GaugeGroup::kVisualInertial;
  GaugeReference reference;
  double lever[3] = {0, 0, 0};  ///< p_B_C

  [[nodiscard]] int dim() const { return Dimension(group); }
  [[nodiscard]] bool HasSecond() const { return group == GaugeGroup::kMono; }

  /// The gauge's reference: its own, else what the graph remembers, else the present pose. Refuses
  /// handles that are not in the graph, a reference that is no pose, and kMono without a second
  /// camera apart from the anchor.
  static Result<GaugeConstraint> Of(const Gauge& gauge, const Orbit& orbit, const Graph& graph);

  /// kMono: names the largest coordinate of the baseline between these poses, at its value now.
  /// False if there is no baseline.
  bool SetBaseline(const double* anchor, const double* second);

  /// c (dim()), and its derivatives in the tangents of anchor and second, dim() x 6 row-major,
  /// which may be null. These are the rows of V' in Eq. (14). `second` is not read but for kMono.
  void Evaluate(const double* anchor, const double* second, double* c, double* d_anchor,
                double* d_second) const;
  /// The g of Eq. (13): c(g(x)) = 0.
  [[nodiscard]] OrbitMotion MotionTo(const double* anchor, const double* second) const;
};

/// Makes it what the graph remembers for its anchor.
void Remember(const GaugeReference& reference, Graph* graph);

}  // namespace glissade
