// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

/// Prior on velocity and biases: r = [v ba bg] - [v ba bg]_0 (m/s, m/s^2, rad/s). Nine rows.
struct EdgeSpeedBiasPrior {
  using Vertices = VertexList<VertexSpeedBias>;
  static constexpr int kResidualDim = 9;
  static constexpr auto kScaleRule = ScaleRule::kPrior;

  VertexSpeedBias prior;

  template <int = 0>
  bool Evaluate(const VertexSpeedBias& speed_bias, Vector<9>& r,
                Jacobian<9, 9>* d_r_d_speed_bias) const {
    speed_bias.Minus(prior, r.data());
    if (d_r_d_speed_bias) d_r_d_speed_bias->setIdentity();
    return true;
  }

  [[nodiscard]] Status Validate() const { return prior.Validate(); }
};

extern template struct internal::EdgeOpsOf<EdgeSpeedBiasPrior>;

}  // namespace glissade
