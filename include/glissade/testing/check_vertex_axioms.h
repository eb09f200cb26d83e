// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "glissade/testing/format_number.h"
#include "glissade/vertices/concept.h"

namespace glissade {

struct VertexCheckOptions {
  /// Largest accepted deviation, relative to 1 + the largest number involved.
  double tolerance = 1e-9;
  /// Largest coordinate of the random tangent vectors; smaller ones, down to 1e-8 of it, are tried
  /// as well. Must stay inside the region where Minus inverts Plus (below pi / sqrt(3) for poses).
  double max_delta = 1.0;
  int trials = 50;
  std::uint64_t seed = 1;
};

/// What CheckVertexAxioms found. Converts to true if all is well.
struct VertexCheck {
  bool ok = false;
  double worst_error = 0.0;  ///< relative, over all axioms
  std::string message;       ///< empty when ok; else one line for people

  explicit operator bool() const { return ok; }
};

namespace internal {

template <VertexType V>
class VertexChecker {
 public:
  VertexChecker(const V& x, const VertexCheckOptions& options) : x_(x), options_(options) {}

  VertexCheck Run() {
    scale_ = 1.0 + MaxAbs(x_.Data(), V::kAmbientDim);
    double zero[kTangent] = {};
    V moved = x_;
    moved.Plus(zero);
    Record(Difference(moved.Data(), x_.Data(), V::kAmbientDim), "x boxplus 0 = x");
    CheckMinus(x_, x_, zero, "x boxminus x = 0");
    std::uint64_t state = options_.seed;
    for (int trial = 0; trial < options_.trials; ++trial) {
      double delta[kTangent];
      const double size = options_.max_delta * std::pow(10.0, -8.0 * NextUniform(state));
      for (double& d : delta)
        d = size * (2.0 * NextUniform(state) - 1.0);
      CheckDelta(delta);
    }
    result_.ok = result_.message.empty();
    return result_;
  }

 private:
  static constexpr int kTangent = V::kTangentDim;
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  void CheckDelta(const double* delta) {
    V y = x_;
    y.Plus(delta);
    CheckMinus(y, x_, delta, "(x boxplus d) boxminus x = d");
    double back[kTangent];
    y.Minus(x_, back);
    if constexpr (kIsAdditive<V>) {
      double sum[kTangent];
      for (int i = 0; i < kTangent; ++i)
        sum[i] = x_.Data()[i] + delta[i];
      Record(Difference(y.Data(), sum, kTangent), "kAdditive: x boxplus d = x + d");
    }
    if constexpr (VertexHasMinusJacobian<V>) CheckMinusJacobian(y);
    V again = x_;
    again.Plus(back);
    const double zero[kTangent] = {};
    // Compared on the manifold: one state may have several representations (q and -q).
    CheckMinus(again, y, zero, "x boxplus (y boxminus x) = y");
    if constexpr (requires {
                    { y.Validate() } -> std::same_as<Status>;
                  }) {
      if (const Status status = y.Validate(); !status.ok()) {
        Fail("Validate refuses x boxplus d: " + status.message());
      }
    }
  }

  /// Against differences of fourth order, good to about 1e-12.
  void CheckMinusJacobian(const V& y) {
    constexpr double kStep = 1e-3;
    constexpr double kWeights[] = {1.0 / 12, -2.0 / 3, 0.0, 2.0 / 3, -1.0 / 12};
    double D[kTangent * kTangent], expected[kTangent * kTangent] = {};
    std::fill_n(D, kTangent * kTangent, kNan);
    y.MinusJacobian(x_, D);
    for (int c = 0; c < kTangent; ++c) {
      for (int at = -2; at <= 2; ++at) {
        double step[kTangent] = {}, value[kTangent];
        step[c] = at * kStep;
        V moved = y;
        moved.Plus(step);
        moved.Minus(x_, value);
        for (int r = 0; r < kTangent; ++r)
          expected[r * kTangent + c] += kWeights[at + 2] / kStep * value[r];
      }
    }
    Record(Difference(D, expected, kTangent * kTangent), "MinusJacobian = d(x boxminus x0)/dx");
  }

  void CheckMinus(const V& a, const V& b, const double* expected, const char* axiom) {
    double delta[kTangent];
    std::fill_n(delta, kTangent, kNan);
    a.Minus(b, delta);
    Record(Difference(delta, expected, kTangent), axiom);
  }

  void Record(double difference, const char* axiom) {
    const double error = difference / scale_;
    if (!(error <= result_.worst_error)) result_.worst_error = error;
    if (!(error <= options_.tolerance)) {
      Fail(
          std::string(axiom).append(" does not hold, relative error ").append(FormatNumber(error)));
    }
  }

  void Fail(const std::string& message) {
    if (result_.message.empty()) {
      result_.message = std::string(kTypeInfo<V>.name) + ": " + message;
    }
  }

  static double MaxAbs(const double* x, int n) {
    double max = 0.0;
    for (int i = 0; i < n; ++i)
      max = std::max(max, std::abs(x[i]));
    return max;
  }

  /// Largest |a - b|; NaN if there is one.
  static double Difference(const double* a, const double* b, int n) {
    double max = 0.0;
    for (int i = 0; i < n; ++i) {
      const double d = std::abs(a[i] - b[i]);
      if (!(d <= max)) max = d;
      if (std::isnan(d)) return d;
    }
    return max;
  }

  /// In [0, 1), the same on every machine (splitmix64, S. Vigna).
  static double NextUniform(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

  V x_;
  VertexCheckOptions options_;
  double scale_ = 1.0;
  VertexCheck result_;
};

}  // namespace internal

/// Checks the axioms of a vertex type (vertices/concept.h) around the state x for random tangent
/// vectors d of many sizes: x boxplus 0 = x, x boxminus x = 0, (x boxplus d) boxminus x = d,
/// x boxplus (y boxminus x) = y, every output written, and Validate() (if there is one) content
/// with every state reached; and that kAdditive and MinusJacobian(), if they are there, are true.
template <VertexType V>
VertexCheck CheckVertexAxioms(const V& x, const VertexCheckOptions& options = {}) {
  return internal::VertexChecker<V>(x, options).Run();
}

}  // namespace glissade
