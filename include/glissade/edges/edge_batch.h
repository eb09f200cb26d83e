// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/vertices/concept.h"

namespace glissade {

class DynamicEdge;

/// One edge of a batch: the states it is wanted at, and where its values go.
struct BatchedEdge {
  const DynamicEdge* edge = nullptr;
  std::span<const VertexRef> vertices;
  double* residual = nullptr;  ///< ResidualDim() numbers, whitened
  /// As in DynamicEdge::Evaluate, none of them null; null where the residual alone is wanted.
  double* const* jacobians = nullptr;
  bool has_value = false;  ///< for Evaluate to say: what DynamicEdge::Evaluate returns
};

/// Evaluates many dynamic edges in one call, where calls are dear: a language binding, a device.
/// Edges name it by DynamicEdge::batch(). All edges of a graph that name the same one are evaluated
/// together in every linearization and every cost of a solve, on the thread that called Solve, and
/// must get what their own Evaluate would say, which is asked everywhere else.
class EdgeBatch {
 public:
  virtual ~EdgeBatch() = default;
  virtual void Evaluate(std::span<BatchedEdge> edges) const = 0;
};

}  // namespace glissade
