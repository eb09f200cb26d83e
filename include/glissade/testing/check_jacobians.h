// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "glissade/edges/concept.h"

namespace glissade {

struct JacobianCheckOptions {
  /// Largest accepted error of a column, relative to its largest entry.
  double tolerance = 1e-7;
  /// First and largest step of the numeric differentiation, in units of the tangent. It is halved
  /// 19 times; the extrapolation picks what is most accurate.
  double step = 1e-2;
};

/// What CheckJacobians found. Converts to true if all is well.
struct JacobianCheck {
  bool ok = false;
  /// Largest relative error of a Jacobian entry, and where: argument of Evaluate, residual row,
  /// tangent coordinate.
  double worst_error = 0.0;
  int vertex = -1;
  int row = -1;
  int column = -1;
  double analytic = 0.0;
  double numeric = 0.0;
  /// Empty when ok; else one line for people.
  std::string message;

  explicit operator bool() const { return ok; }
};

namespace internal {

/// What the checker needs of an edge with its vertices, whatever their types.
struct EdgeUnderTest {
  std::string_view name;
  int rows = 0;
  int vertices = 0;
  std::function<int(int vertex)> columns;
  /// Evaluates with all outputs poisoned. Vertex `moved` is moved by t along tangent coordinate
  /// `column` (-1: none is moved); bit i of `wanted` asks for Jacobian i, which is appended to J in
  /// row-major order (null: none).
  std::function<bool(int moved, int column, double t, unsigned wanted, double* r, double* J)>
      evaluate;
};

JacobianCheck RunJacobianCheck(const EdgeUnderTest& edge, const JacobianCheckOptions& options);

template <class E, class List>
struct JacobianChecker;

template <class E, class... V>
struct JacobianChecker<E, VertexList<V...>> {
  static_assert(sizeof...(V) <= 32);

  static bool Evaluate(const E& edge, std::tuple<V...> x, int moved, int column, double t,
                       unsigned wanted, double* r_out, double* J_out) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    Vector<E::kResidualDim> r;
    std::tuple<Jacobian<E::kResidualDim, V::kTangentDim>...> J;
    r.setConstant(kNan);
    const bool ok = [&]<std::size_t... I>(std::index_sequence<I...>) {
      (Move(std::get<I>(x), moved == static_cast<int>(I) ? column : -1, t), ...);
      (std::get<I>(J).setConstant(kNan), ...);
      return EvaluateEdge(edge, std::tuple<const V&...>(std::get<I>(x)...), r,
                          ((wanted >> I) & 1u ? &std::get<I>(J) : nullptr)...);
    }
    (std::index_sequence_for<V...>{});
    for (int i = 0; i < r.size(); ++i)
      *r_out++ = r[i];
    const auto append = [&](int index, const auto& jacobian) {
      if (J_out == nullptr || ((wanted >> index) & 1u) == 0) return;
      for (int row = 0; row < jacobian.rows(); ++row) {
        for (int col = 0; col < jacobian.cols(); ++col)
          *J_out++ = jacobian(row, col);
      }
    };
    ForEachIndex<static_cast<int>(sizeof...(V))>(
        [&](auto index) { append(index, std::get<index()>(J)); });
    return ok;
  }

  template <class Vertex>
  static void Move(Vertex& vertex, int column, double t) {
    if (column < 0) return;
    double delta[Vertex::kTangentDim] = {};
    delta[column] = t;
    vertex.Plus(delta);
  }

  static JacobianCheck Run(const E& edge, const V&... vertices,
                           const JacobianCheckOptions& options = {}) {
    static constexpr int kColumns[] = {V::kTangentDim...};
    const std::tuple<V...> x(vertices...);
    return RunJacobianCheck(
        {kTypeInfo<E>.name, E::kResidualDim, static_cast<int>(sizeof...(V)),
         [](int vertex) { return kColumns[vertex]; },
         [&](int moved, int column, double t, unsigned wanted, double* r, double* J) {
           return Evaluate(edge, x, moved, column, t, wanted, r, J);
         }},
        options);
  }
};

}  // namespace internal

/// Checks the analytic Jacobians of a typed edge at the given vertices:
///
///     JacobianCheck check = CheckJacobians(EdgeRange{2.0}, pose, point);
///     EXPECT_TRUE(check.ok) << check.message;
///     CheckJacobians(edge, pose, point, JacobianCheckOptions{.tolerance = 1e-6});
///
/// Every output is poisoned first and must be written; the residual must be the same whether or not
/// Jacobians are asked for, and each Jacobian the same whether or not the others are; each must
/// equal central differences of the residual along the vertex's own Plus, extrapolated to step
/// zero. Choose a point where Evaluate returns true and that is no closer to a discontinuity of the
/// residual (an angle of pi) than about 1e-6.
template <EdgeType E, class... Args>
JacobianCheck CheckJacobians(const E& edge, const Args&... vertices_and_options) {
  return internal::JacobianChecker<E, typename E::Vertices>::Run(edge, vertices_and_options...);
}

}  // namespace glissade
