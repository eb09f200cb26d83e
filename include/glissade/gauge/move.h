// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/gauge/orbit.h"
#include "glissade/graph/graph.h"

namespace glissade {

struct MoveOptions {
  GaugeGroup group = GaugeGroup::kAuto;
  /// EdgeSE3Prior, EdgePosePriorVec and EdgeSpeedBiasPrior go along, measurement and information:
  /// what was measured in the old world frame is then said in the new one.
  bool move_absolute_priors = false;
};

/// Slides a scene along its orbit (Zhang et al., RA-L 2018, Eq. 5): all poses, velocities and
/// points (for scale, inverse depths), fixed ones too, with first estimates, gauge references and
/// charts. Marginal priors go along: x0 <- g(x0), J_p <- J_p R'/s, J_v <- J_v R', J_X <- J_X R'/s,
/// J_theta and r0 as they are. The cost stays as it is.
///
/// Refused, with the graph unchanged: where an edge is not blind to the gauge and cannot or must
/// not go along (kInvalidArgument; names the first, lists all); a motion that is none of the
/// group's.
Status MoveAlongOrbit(Graph* graph, const OrbitMotion& g, const MoveOptions& options = {});

/// The same by the g of Eq. (13): puts the gauge's anchor to the gauge's reference (its own, else
/// the one the graph remembers), and makes it the remembered one. Gauge::Free does nothing;
/// Gauge::FixedPoses is refused.
Status MoveToGauge(Graph* graph, const Gauge& gauge, const MoveOptions& options = {});

}  // namespace glissade
