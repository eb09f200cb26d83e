// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "glissade/base/matrix.h"

namespace glissade::sim {

/// Uniform quintic B-spline in R^3: four continuous derivatives, so that what an IMU reads along it
/// is smooth. Source: C. de Boor, "A Practical Guide to Splines", the recurrence for equal knots.
class BSpline {
 public:
  static constexpr int kDegree = 5;

  /// Control point k pulls most at t = (k - 2) interval. At least six; the spline is defined from
  /// t = 0 to Duration().
  BSpline() : BSpline(std::vector<Vector3>(kDegree + 1, Vector3::Zero()), 1.0) {}
  BSpline(std::vector<Vector3> control, double interval)
      : control_(std::move(control)), interval_(interval) {
    if (control_.size() < kDegree + 1) control_.resize(kDegree + 1, Vector3::Zero());
  }

  [[nodiscard]] double Duration() const {
    return static_cast<double>(control_.size() - kDegree) * interval_;
  }

  /// The spline (order 0) or its derivative of order up to 4 at t, clamped to the duration.
  [[nodiscard]] Vector3 Evaluate(double t, int order = 0) const {
    const double s = std::clamp(t / interval_, 0.0, static_cast<double>(control_.size() - kDegree));
    const auto first = std::min(static_cast<std::size_t>(s), control_.size() - kDegree - 1);
    const double u = s - static_cast<double>(first);
    Vector3 c[kDegree + 1];
    std::copy_n(control_.begin() + static_cast<std::ptrdiff_t>(first), kDegree + 1, c);
    // The derivative is a spline of one degree less on the differences of the control points.
    for (int r = 0; r < order; ++r) {
      for (int k = 0; k + 1 <= kDegree - r; ++k)
        c[k] = (c[k + 1] - c[k]) / interval_;
    }
    const int degree = kDegree - order;
    double w[kDegree + 1] = {1.0};
    for (int d = 1; d <= degree; ++d) {
      for (int k = d; k >= 0; --k) {
        w[k] = ((k > 0 ? (u + d - k) * w[k - 1] : 0.0) + (k < d ? (1.0 - u + k) * w[k] : 0.0)) / d;
      }
    }
    Vector3 x = Vector3::Zero();
    for (int k = 0; k <= degree; ++k)
      x += w[k] * c[k];
    return x;
  }

 private:
  std::vector<Vector3> control_;
  double interval_;
};

}  // namespace glissade::sim
