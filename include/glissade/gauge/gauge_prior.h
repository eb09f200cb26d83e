// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "glissade/edges/dynamic.h"
#include "glissade/gauge/constraint.h"

namespace glissade {

/// Pulls a scene to its gauge: r = sqrt(weight) c(x), c of GaugeConstraint (Zhang et al., RA-L
/// 2018, Eq. 11). Vertices: the anchor; for kMono the second pose too.
class EdgeGaugePrior final : public DynamicEdge {
 public:
  EdgeGaugePrior(const GaugeConstraint& constraint, double weight)
      : constraint_(constraint), weight_(weight) {}

  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override { return constraint_.dim(); }
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<EdgeGaugePrior>(*this);
  }

 private:
  GaugeConstraint constraint_;
  double weight_;
};

}  // namespace glissade
