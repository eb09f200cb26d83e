// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/gauge/nullspace.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/linearized_states.h"

namespace glissade {

/// Where J and u are taken.
enum class BreachPoint {
  kAsLinearized,  ///< as in a solve: u at first estimates, J there too in FirstEstimates::kFull
  kPresent,       ///< both at the given states: what an edge is blind to, whatever the solve does
};

/// Finds the edges with J u != 0. Also serves MoveAlongOrbit, which asks about edges one by one.
class GaugeBreaches {
 public:
  GaugeBreaches(const Graph& graph, const LinearizedStates& point, const Orbit& orbit,
                double tolerance, BreachPoint where = BreachPoint::kAsLinearized);

  /// Edges whose |J u|^2 is more than tolerance * scale of a direction. information: u'Hu. Edges
  /// that are no observations are looked at first, and the rest only if those do not explain all of
  /// u'Hu: a window has a thousand observations, and none of them can see the gauge alone. Returns
  /// their number; the first max_listed are added to *found.
  int Find(const double* information, const double* scale, int max_listed,
           std::vector<GaugeBreach>* found);

  /// |J u|^2 per direction, robust weight included; two sums: over free vertices only, as in u'Hu,
  /// and over all. False where the edge has no value.
  bool Evaluate(const EdgePoolBase& pool, int edge, double* free_sum, double* sum);
  /// Whether J u was 0 beside the terms it is the sum of, in the last Evaluate(): up to the
  /// rounding of these, about (1e-15)^2, or that of a constant Hessian.
  [[nodiscard]] bool blind() const { return blind_; }

 private:
  bool Quadratic(const EdgePoolBase& pool, int edge, const double* H, double* free_sum,
                 double* sum);
  void Gather(const EdgePoolBase& pool, int edge);

  const Graph& graph_;
  const LinearizedStates& point_;
  const Orbit& orbit_;
  double tolerance_;
  BreachPoint where_;
  bool blind_ = false;
  struct Vertex {
    int dim = 0;
    bool moves = false, free = false;
    double U[Orbit::kMaxTangent * Orbit::kMaxDim] = {};
    double state[16] = {};
  };
  std::vector<Vertex> vertices_;
  std::vector<const double*> states_;
  std::vector<double*> jacobian_of_;
  std::vector<double> residual_, jacobian_, products_;
};

}  // namespace glissade
