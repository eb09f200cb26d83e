// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/graph/graph.h"

namespace glissade {

/// An element g of the gauge group: x' = scale R x + t for points of the world. With IMU, R turns
/// about z and scale is 1.
struct OrbitMotion {
  double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  double t[3] = {0, 0, 0};                    ///< m
  double scale = 1.0;
};

/// The states that a gauge group takes a scene through (Zhang et al., RA-L 2018, Eq. 5): which
/// vertices move, and how. Poses, velocities and XYZ points move; inverse depths move with the
/// scale only; biases, extrinsics and all types that the library does not know stay.
class Orbit {
 public:
  static constexpr int kMaxDim = 7;
  static constexpr int kMaxTangent = 9;

  Orbit() = default;
  /// kAuto: kVisualInertial where the graph has a VertexSpeedBias; else kMono where all edges but
  /// priors are rays of one camera (ScaleRule, edges/concept.h); else kStereo. Refused: a graph
  /// without a VertexPose, a group that is none.
  static Result<Orbit> Of(const Graph& graph, GaugeGroup group = GaugeGroup::kAuto);

  [[nodiscard]] GaugeGroup group() const { return group_; }
  [[nodiscard]] int dim() const { return Dimension(group_); }
  /// p_B_C of the camera: its centre scales, the lever arm does not. Zero except for kMono. Taken
  /// from the edges that are rays.
  [[nodiscard]] const double* lever() const { return lever_; }
  [[nodiscard]] bool Moves(AnyVertex vertex) const;

  /// d(x)/d(group) of a vertex that Moves(), tangent_dim x dim() row-major: the null space of H is
  /// spanned by these (Eq. 15, rewritten for tangents in body axes). Columns in the order of
  /// GaugeDirectionName().
  void Directions(AnyVertex vertex, const double* state, double* U) const;
  /// x <- g(x), Eq. (5); nothing for a vertex that does not move.
  void Move(const OrbitMotion& g, AnyVertex vertex, double* state) const;
  /// d(g(x))/dx of a vertex that Moves(), in the tangents at x and g(x), tangent_dim x tangent_dim
  /// row-major.
  void Derivative(const OrbitMotion& g, AnyVertex vertex, const double* state, double* D) const;

 private:
  GaugeGroup group_ = GaugeGroup::kVisualInertial;
  double lever_[3] = {0, 0, 0};
  std::vector<AnyVertex> extrinsics_;
};

}  // namespace glissade
