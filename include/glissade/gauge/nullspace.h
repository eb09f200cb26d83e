// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/gauge/orbit.h"

namespace glissade {

class NormalEquations;
class Structure;

struct NullspaceOptions {
  GaugeGroup group = GaugeGroup::kAuto;
  /// kappa up to which a direction counts as unobserved, and an edge as blind to it. A
  /// linearization off by 1 mm and 0.02 deg makes about 1e-8, rounding 1e-16.
  double tolerance = 1e-12;
  /// Edges that the report lists; all are counted.
  int max_edges = 100;
};

/// One direction u of the gauge group: 1 rad, 1 m, or (scale) 1.
struct NullspaceDirection {
  std::string_view name;
  /// u'Hu / sum over vertices k of u_k' H_kk u_k: 0 where nothing observes u, at most about 1.
  double kappa = 0.0;
  /// u'Hu: information about u [1/rad^2, 1/m^2]. 1/sqrt of it is the sigma that the graph claims.
  double information = 0.0;
};

/// An edge with J u != 0.
struct GaugeBreach {
  AnyEdge edge;
  /// Its part of each direction's kappa.
  std::array<double, Orbit::kMaxDim> kappa{};
};

struct NullspaceReport {
  GaugeGroup group = GaugeGroup::kAuto;
  std::vector<NullspaceDirection> directions;
  /// The first NullspaceOptions::max_edges edges whose part of some kappa exceeds the tolerance; in
  /// the order of pools, edges that are not observations first. As u'Hu is the sum of |J_e u|^2,
  /// none is overlooked. Where linearization points differ from edge to edge, as they do outside
  /// FirstEstimates::kFull, that can be all of them.
  std::vector<GaugeBreach> edges;
  int num_edges = 0;  ///< all such edges, also those that are not listed
  /// Vertices that would move with the gauge but are fixed, or cannot follow in part. They are left
  /// out of u'Hu, which then is no property of the measurements alone.
  std::vector<AnyVertex> held;

  [[nodiscard]] double MaxKappa() const;
};

/// How far H is from having the null space that the measurements have. u is taken at each vertex's
/// linearization point: its first estimate where it has one, else where H was linearized. From a
/// linearization that is there already, such as the one the last solve left: microseconds.
/// kInvalidArgument where there is none, or the graph's structure has changed since, or the options
/// make no sense.
Result<NullspaceReport> CheckNullspace(const Graph& graph, const Structure& structure,
                                       NormalEquations* equations,
                                       const NullspaceOptions& options = {});

/// The same from a fresh linearization at the present values (compacts the graph).
Result<NullspaceReport> CheckNullspace(Graph* graph, const NullspaceOptions& options = {});

}  // namespace glissade
