// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "glissade/base/status.h"
#include "glissade/vertices/concept.h"

namespace glissade {

class EdgeBatch;

/// An edge whose number of vertices and residual size are known at run time: the marginal prior,
/// language bindings, and whatever does not fit a typed edge. One virtual call per edge.
///
/// The residual is already whitened (weights are the edge's own business); a robust loss can be
/// given when the edge is added, unless the edge has a constant Hessian. Like a typed edge it is a
/// stateless function, safe to call from several threads.
class DynamicEdge {
 public:
  virtual ~DynamicEdge() = default;

  /// Refuses vertices of the wrong number or type; asked once, when the edge is added.
  [[nodiscard]] virtual Status CheckVertices(std::span<const VertexOps* const> vertices) const = 0;

  [[nodiscard]] virtual int ResidualDim() const = 0;

  /// Writes the residual and, through each pointer of jacobians that is not null, the derivative
  /// with respect to that vertex's tangent, row-major ResidualDim x tangent_dim. jacobians itself
  /// may be null. False only where no number exists.
  virtual bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                        double* const* jacobians) const = 0;

  /// H = J'J where J does not depend on the state: D x D row-major with D the sum of the tangent
  /// dimensions, in the order of the vertices; null (default) where J varies. Building J'J of a
  /// 165 x 165 prior anew in each iteration would cost more than the rest of a window's iteration.
  /// An edge that has a LinearizationPoint() x0 too is r0 + J (x boxminus x0), and J is constant in
  /// the tangent at x0.
  [[nodiscard]] virtual const double* ConstantHessian() const { return nullptr; }

  /// For edges with a constant Hessian: gradient[D] = J'r and *squared_norm = r'r at the given
  /// states. The gradient pointer may be null.
  virtual bool LinearizeQuadratic(std::span<const VertexRef> vertices, double* gradient,
                                  double* squared_norm) const {
    static_cast<void>(vertices);
    static_cast<void>(gradient);
    static_cast<void>(squared_norm);
    return false;
  }

  /// Where a linear edge (a marginal prior) was linearized: ambient states of its vertices, one
  /// after the other; null (default) for others. Adding such an edge to a graph gives vertices that
  /// have none a linearization point (graph/first_estimates.h).
  [[nodiscard]] virtual const double* LinearizationPoint() const { return nullptr; }

  /// What evaluates this edge together with others (edges/edge_batch.h); null (default): nothing.
  /// The same as long as the edge lives. Asked for edges without a constant Hessian only.
  [[nodiscard]] virtual const EdgeBatch* batch() const { return nullptr; }

  /// A copy that lives apart from this one. Graph::Clone() fails where it is null.
  [[nodiscard]] virtual std::unique_ptr<DynamicEdge> Clone() const = 0;
};

}  // namespace glissade
