// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "glissade/edges/concept.h"
#include "glissade/testing/format_number.h"
#include "glissade/testing/numeric_derivative.h"

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

template <class E, class List>
class JacobianChecker;

template <class E, class... V>
class JacobianChecker<E, VertexList<V...>> {
 public:
  static JacobianCheck Run(const E& edge, const V&... vertices,
                           const JacobianCheckOptions& options = {}) {
    JacobianChecker checker(edge, options, vertices...);
    checker.CheckAll();
    checker.result_.ok = checker.result_.message.empty();
    return checker.result_;
  }

 private:
  static constexpr int kRows = E::kResidualDim;
  using Residual = Vector<kRows>;
  using Jacobians = std::tuple<Jacobian<kRows, V::kTangentDim>...>;
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  JacobianChecker(const E& edge, const JacobianCheckOptions& options, const V&... vertices)
      : edge_(edge), options_(options), x_(vertices...) {}

  /// Evaluates at x with poisoned outputs; Jacobians only where `wanted(index)`.
  template <class Wanted>
  bool Evaluate(const std::tuple<V...>& x, Residual& r, Jacobians& J, const Wanted& wanted) const {
    r.setConstant(kNan);
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      (std::get<I>(J).setConstant(kNan), ...);
      return edge_.Evaluate(std::get<I>(x)..., r,
                            (wanted(static_cast<int>(I)) ? &std::get<I>(J) : nullptr)...);
    }
    (std::index_sequence_for<V...>{});
  }

  void CheckAll() {
    if (!Evaluate(x_, r_, J_, [](int) { return true; })) return Fail("Evaluate returned false");
    for (int row = 0; row < kRows; ++row) {
      if (!std::isfinite(r_[row])) {
        return Fail("residual " + std::to_string(row) + " is not written or not finite");
      }
    }
    Residual r;
    Jacobians unused;
    if (!Evaluate(x_, r, unused, [](int) { return false; }) || !SameResidual(r)) {
      return Fail("the residual without Jacobians differs from the one with Jacobians");
    }
    ForEachIndex<static_cast<int>(sizeof...(V))>([&](auto index) {
      if (result_.message.empty()) CheckVertex<index()>();
    });
  }

  template <int I>
  void CheckVertex() {
    const auto& J = std::get<I>(J_);
    const std::string name = "Jacobian " + std::to_string(I);
    for (int row = 0; row < J.rows(); ++row) {
      for (int column = 0; column < J.cols(); ++column) {
        if (std::isfinite(J(row, column))) continue;
        return Fail(name + ": entry (" + std::to_string(row) + ", " + std::to_string(column) +
                    ") is not written or not finite");
      }
    }
    Residual r;
    Jacobians alone;
    if (!Evaluate(x_, r, alone, [](int i) { return i == I; }) || !SameResidual(r) ||
        !((std::get<I>(alone) - J).cwiseAbs().maxCoeff() <= 1e-12 * J.cwiseAbs().maxCoeff())) {
      return Fail(name + ": asked for alone it differs from all together");
    }
    CompareToNumeric<I>(J);
  }

  template <int I, class Matrix>
  void CompareToNumeric(const Matrix& J) {
    constexpr int kCols = Matrix::ColsAtCompileTime;
    // Absolute floor: a column of zeros has no scale of its own.
    const double floor = 1e-6 * std::max(J.cwiseAbs().maxCoeff(), 1e-3);
    for (int column = 0; column < kCols; ++column) {
      const auto along = [&](double t, Residual& r) {
        std::tuple<V...> x = x_;
        double delta[kCols] = {};
        delta[column] = t;
        std::get<I>(x).Plus(delta);
        Jacobians unused;
        return Evaluate(x, r, unused, [](int) { return false; }) && r.allFinite();
      };
      const auto numeric = Differentiate<kRows>(along, options_.step);
      const double scale = std::max(
          {J.col(column).cwiseAbs().maxCoeff(), numeric.value.cwiseAbs().maxCoeff(), floor});
      for (int row = 0; row < kRows; ++row) {
        const double error = std::abs(J(row, column) - numeric.value[row]) / scale;
        if (error > result_.worst_error || result_.vertex < 0) {
          result_.worst_error = error;
          result_.vertex = I;
          result_.row = row;
          result_.column = column;
          result_.analytic = J(row, column);
          result_.numeric = numeric.value[row];
        }
      }
    }
    if (!(result_.worst_error <= options_.tolerance)) {
      Fail("Jacobian " + std::to_string(result_.vertex) + ", entry (" +
           std::to_string(result_.row) + ", " + std::to_string(result_.column) + "): analytic " +
           FormatNumber(result_.analytic) + ", numeric " + FormatNumber(result_.numeric) +
           ", relative error " + FormatNumber(result_.worst_error));
    }
  }

  [[nodiscard]] bool SameResidual(const Residual& r) const {
    // Not to the bit: the compiler may contract the two evaluations differently.
    return (r - r_).cwiseAbs().maxCoeff() <= 1e-12 * (1.0 + r_.cwiseAbs().maxCoeff());
  }

  void Fail(std::string message) {
    result_.message = std::string(kTypeInfo<E>.name) + ": " + std::move(message);
  }

  const E& edge_;
  const JacobianCheckOptions& options_;
  std::tuple<V...> x_;
  Residual r_;
  Jacobians J_;
  JacobianCheck result_;
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
