// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "glissade/edges/concept.h"
#include "glissade/edges/evaluate_in_packs.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"

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
  /// For an edge that is evaluated in packs, else empty: `count` such edges on the same vertices
  /// but for vertex `landmark`, in `lanes` lanes (a multiple of 8). Landmark and kLanes of edge s
  /// are moved by steps[s] from what is given, unless the edge has no value there. Both buffers
  /// take residual and Jacobians as LaneValues has them, one after the other: of the edges in
  /// packs, and of one edge at a time. Returns the first edge that has no value in packs, or -1.
  std::function<int(int landmark, int count, int lanes, const double* steps, double* packs,
                    double* single)>
      in_packs;
  /// For an edge with a FirstEstimateRule of a relative pose or point, else empty: how vertices 0
  /// and 1 move when everything is translated along and turned about the world's axes, by vertex
  /// columns x 6, row-major, one after the other.
  std::vector<double> motions;
};

JacobianCheck RunJacobianCheck(const EdgeUnderTest& edge, const JacobianCheckOptions& options);

/// Adds t to the numbers of an edge that differ from lane to lane, in units of their size.
template <class E>
void MoveLanes(E* edge, double t) {
  const auto move = [&](auto member) {
    constexpr std::size_t kCount = sizeof(edge->*member) / sizeof(double);
    double numbers[kCount];
    std::memcpy(numbers, &(edge->*member), sizeof(numbers));
    for (double& x : numbers)
      x += t * (1.0 + (x < 0.0 ? -x : x));
    std::memcpy(static_cast<void*>(&(edge->*member)), numbers, sizeof(numbers));
  };
  [&]<std::size_t... K>(std::index_sequence<K...>) {
    (move(LaneMember<E, K>()), ...);
  }
  (LaneIndices<E>{});
}

template <class E, class Unit, class List>
struct JacobianChecker;

template <class E, class Unit, class... V>
struct JacobianChecker<E, Unit, VertexList<V...>> {
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

  static constexpr int kColumns[] = {V::kTangentDim...};

  /// See EdgeUnderTest::in_packs.
  static int InPacks(const E& edge, const std::tuple<V...>& x, int landmark, int count, int lanes,
                     const double* steps, double* packs, double* single) {
    constexpr int kRows = E::kResidualDim, kNumbers = kRows * (1 + (V::kTangentDim + ... + 0));
    const auto size = static_cast<std::size_t>(lanes);
    std::vector<E> edges(size, edge);
    std::vector<std::tuple<V...>> vertices(size, x);
    std::vector<std::int32_t> edge_of_lane;
    std::vector<const double*> landmarks;
    for (int s = 0; s < lanes; ++s) {
      const auto at = static_cast<std::size_t>(s);
      // Padding repeats the last edge.
      const int k = s < count ? s : count - 1;
      const int column = k % kColumns[landmark];
      double r[kRows], J[kNumbers - kRows];
      MoveLanes(&edges[at], steps[k]);
      bool moves = Evaluate(edges[at], x, landmark, column, steps[k], ~0u, r, J);
      for (int n = 0; n < kNumbers; ++n)
        moves = moves && IsFinite(n < kRows ? r[n] : J[n - kRows]);
      if (!moves) {
        edges[at] = edge;
        Evaluate(edge, x, -1, -1, 0.0, ~0u, r, J);
      }
      ForEachIndex<static_cast<int>(sizeof...(V))>([&](auto i) {
        auto& vertex = std::get<i()>(vertices[at]);
        if (i != landmark) return;
        Move(vertex, moves ? column : -1, steps[k]);
        landmarks.push_back(vertex.Data());
      });
      edge_of_lane.push_back(s < count ? s : count - 1);
      for (int n = 0; n < kNumbers; ++n)
        single[n * lanes + s] = n < kRows ? r[n] : J[n - kRows];
    }
    LaneRun run;
    run.count = count;
    run.lanes = lanes;
    run.edges = edge_of_lane.data();
    run.landmark = landmark;
    run.landmark_states = landmarks.data();
    const double* states[sizeof...(V)];
    double* J[sizeof...(V)];
    double* next = packs + kRows * lanes;
    ForEachIndex<static_cast<int>(sizeof...(V))>([&](auto i) {
      states[i] = std::get<i()>(x).Data();
      J[i] = next;
      next += kRows * kColumns[i] * lanes;
    });
    run.states = states;
    return PackEvaluator<E, Unit>::Evaluate(edges.data(), run, {packs, J, nullptr});
  }
  static bool IsFinite(double x) { return x - x == 0.0; }

  /// See EdgeUnderTest::motions. Turns are about `center`.
  static void AddMotion(const VertexPose& vertex, const Vector3& center,
                        std::vector<double>* motions) {
    const Vector3 lever = vertex.pose.p() - center;
    const Matrix3 R = vertex.pose.R();
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) {
        const int r = row % 3, c = column % 3;
        if (row >= 3) {
          motions->push_back(column < 3 ? 0.0 : R(c, r));
        } else {
          motions->push_back(column < 3 ? double(r == c) : -so3::Hat(lever)(r, c));
        }
      }
    }
  }
  static void AddMotion(const VertexPointXYZ& vertex, const Vector3& center,
                        std::vector<double>* motions) {
    const Vector3 lever = vertex.p() - center;
    for (int r = 0; r < 3; ++r) {
      for (int column = 0; column < 6; ++column)
        motions->push_back(column < 3 ? double(r == column) : -so3::Hat(lever)(r, column - 3));
    }
  }

  static JacobianCheck Run(const E& edge, const V&... vertices,
                           const JacobianCheckOptions& options = {}) {
    const std::tuple<V...> x(vertices...);
    EdgeUnderTest test{kTypeInfo<E>.name,
                       E::kResidualDim,
                       static_cast<int>(sizeof...(V)),
                       [](int vertex) { return kColumns[vertex]; },
                       [&](int moved, int column, double t, unsigned wanted, double* r, double* J) {
                         return Evaluate(edge, x, moved, column, t, wanted, r, J);
                       },
                       {},
                       {}};
    if constexpr (kEvaluatesInPacks<E>) {
      test.in_packs = [&](int landmark, int count, int lanes, const double* steps, double* packs,
                          double* single) {
        return InPacks(edge, x, landmark, count, lanes, steps, packs, single);
      };
    }
    if constexpr (FirstEstimateRuleOf<E>() != FirstEstimateRule::kWhole) {
      constexpr int kObserver = FirstEstimateRuleOf<E>() == FirstEstimateRule::kRelativePose;
      const Vector3 center = std::get<kObserver>(x).pose.p();
      AddMotion(std::get<0>(x), center, &test.motions);
      AddMotion(std::get<1>(x), center, &test.motions);
    }
    return RunJacobianCheck(test, options);
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
/// zero. An edge whose Evaluate is a template over its scalar is also evaluated in packs of this
/// unit, edges with other measurements and landmarks beside it, and must be what it is alone. One
/// that knows its vertices by a relative pose or point, as its kFirstEstimateRule says, must not
/// see them move together.
/// Choose a point where Evaluate returns true and that is no closer to a discontinuity of the
/// residual (an angle of pi) than about 1e-6.
template <EdgeType E,
          class Unit = std::conditional_t<kEvaluatesInPacks<E>, internal::ThisUnit, void>,
          class... Args>
JacobianCheck CheckJacobians(const E& edge, const Args&... vertices_and_options) {
  return internal::JacobianChecker<E, Unit, typename E::Vertices>::Run(edge,
                                                                       vertices_and_options...);
}

}  // namespace glissade
