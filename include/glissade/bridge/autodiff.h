// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/jet.h>

#include <cmath>
#include <concepts>
#include <type_traits>

#include "glissade/bridge/manifold.h"
#include "glissade/edges/concept.h"

namespace glissade::bridge {

/// A typed edge from a templated functor, differentiated with ceres::Jet: what a
/// ceres::AutoDiffCostFunction takes works here as it is. The functor gets one pointer per vertex
/// to its ambient state (VertexPose: px py pz qx qy qz qw) and the residual:
///
///     struct Range {
///       double measured;
///       template <class T>
///       bool operator()(const T* pose, const T* point, T* r) const {
///         const T x = point[0] - pose[0], y = point[1] - pose[1], z = point[2] - pose[2];
///         r[0] = sqrt(x * x + y * y + z * z) - measured;
///         return true;
///       }
///     };
///     using EdgeRange = bridge::EdgeAutodiff<Range, 1, VertexPose, VertexPointXYZ>;
///     problem.AddEdge(EdgeRange{{2.0}}, {pose, point});
///
/// The Jets carry derivatives along the vertices' tangents from the start, so no ambient Jacobian
/// is formed. No value (false) where the functor returns false or a derivative is not finite, as at
/// the tip of a square root. Validate() of the functor is used if it has one.
template <class Functor, int ResidualDim, VertexType... V>
struct EdgeAutodiff {
  using Vertices = VertexList<V...>;
  static constexpr int kResidualDim = ResidualDim;

  Functor functor;

  bool Evaluate(const V&... vertices, Vector<ResidualDim>& r,
                Jacobian<ResidualDim, V::kTangentDim>*... jacobians) const {
    if (((jacobians == nullptr) && ...)) return functor(vertices.Data()..., r.data());

    constexpr int kTotal = (V::kTangentDim + ...);
    using Jet = ceres::Jet<double, kTotal>;
    Jet x[(V::kAmbientDim + ...)];
    Jet residual[ResidualDim];
    int ambient = 0, tangent = 0;
    (Seed(vertices, x, &ambient, &tangent), ...);

    const Jet* next = x;
    const auto take = [&next](int n) {
      const Jet* begin = next;
      next += n;
      return begin;
    };
    // Braces: evaluated from left to right, other than the arguments of a call.
    const struct { const Jet* of[sizeof...(V)]; } blocks{{take(V::kAmbientDim)...}};
    const bool ok = [&]<std::size_t... I>(std::index_sequence<I...>) {
      return functor(blocks.of[I]..., residual);
    }
    (std::index_sequence_for<V...>{});
    if (!ok) return false;

    for (int k = 0; k < ResidualDim; ++k)
      r[k] = residual[k].a;
    tangent = 0;
    (Extract(residual, &tangent, jacobians), ...);
    return true;
  }

  [[nodiscard]] Status Validate() const {
    if constexpr (requires {
                    { functor.Validate() } -> std::same_as<Status>;
                  }) {
      return functor.Validate();
    } else {
      return {};
    }
  }

 private:
  /// x[ambient ...] = the vertex's state, with d x / d tangent as derivatives.
  template <class Vertex, class Jet>
  static void Seed(const Vertex& vertex, Jet* x, int* ambient, int* tangent) {
    constexpr int kAmbient = Vertex::kAmbientDim, kTangent = Vertex::kTangentDim;
    double plus[kAmbient * kTangent];
    PlusJacobian(kVertexOps<Vertex>, vertex.Data(), plus);
    for (int i = 0; i < kAmbient; ++i) {
      Jet& jet = x[*ambient + i];
      jet.a = vertex.Data()[i];
      jet.v.setZero();
      for (int k = 0; k < kTangent; ++k)
        jet.v[*tangent + k] = plus[i * kTangent + k];
    }
    *ambient += kAmbient;
    *tangent += kTangent;
  }

  template <class Jet, class Block>
  static void Extract(const Jet* residual, int* tangent, Block* jacobian) {
    constexpr int kCols = Block::ColsAtCompileTime;
    for (int k = 0; jacobian != nullptr && k < ResidualDim; ++k) {
      for (int c = 0; c < kCols; ++c)
        (*jacobian)(k, c) = residual[k].v[*tangent + c];
    }
    *tangent += kCols;
  }
};

}  // namespace glissade::bridge
