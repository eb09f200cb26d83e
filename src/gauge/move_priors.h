// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/edges/speed_bias_prior.h"
#include "glissade/gauge/orbit.h"
#include "glissade/graph/pools.h"

namespace glissade {

bool IsMarginalPrior(const EdgePoolBase& pool, int edge);
/// Absolute priors that are moved on request.
bool IsMovablePrior(const TypeInfo& type);

/// Moves priors along with the scene, and takes that back.
class PriorMover {
 public:
  PriorMover(Graph* graph, const Orbit& orbit) : graph_(graph), orbit_(orbit) {}

  Status Move(const OrbitMotion& g, bool absolute);
  void TakeBack();
  /// Whether a marginal prior has another Hessian now: what was linearized looks at the one before.
  [[nodiscard]] bool HasMovedMarginal() const { return !marginal_.empty(); }

 private:
  template <class E>
  struct Kept {
    EdgeHandle<E> handle;
    E edge;
    SquareMatrix<E::kResidualDim> sqrt;
  };
  Status MoveMarginal(const OrbitMotion& g, EdgeMarginalPrior* prior,
                      const std::vector<AnyVertex>& vertices);
  template <class E, class State>
  Status MoveAbsolute(const OrbitMotion& g, State&& state, std::vector<Kept<E>>* kept);
  template <class E>
  void PutBack(const std::vector<Kept<E>>& kept);

  Graph* graph_;
  const Orbit& orbit_;
  std::vector<std::pair<EdgeMarginalPrior*, EdgeMarginalPrior>> marginal_;
  std::vector<Kept<EdgeSE3Prior>> se3_;
  std::vector<Kept<EdgePosePriorVec>> vec_;
  std::vector<Kept<EdgeSpeedBiasPrior>> speed_;
};

}  // namespace glissade
