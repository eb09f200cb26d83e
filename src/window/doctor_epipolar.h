// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "window/doctor_two_view.h"

namespace glissade::internal::epipolar {

struct Motion {
  Matrix3 R = Matrix3::Identity();
  Vector3 t = Vector3(1.0, 0.0, 0.0);
};

/// Noise of the image coordinates.
struct Noise {
  double x = 1.0, y = 1.0;
};

/// Two unit vectors at right angles to t and to each other, as columns.
inline Matrix<3, 2> TangentsAt(const Vector3& t) {
  const Vector3 off = std::abs(t[2]) < 0.7 ? Vector3(0, 0, 1) : Vector3(1, 0, 0);
  Matrix<3, 2> b;
  b.col(0) = t.cross(off).normalized();
  b.col(1) = t.cross(Vector3(b.col(0)));
  return b;
}

inline Vector3 First(const TwoViewMatch& m) {
  return {m.x1, m.y1, 1.0};
}
inline Vector3 Second(const TwoViewMatch& m) {
  return {m.x2, m.y2, 1.0};
}

/// Error x2' [t]x R x1 of a match over its sigma, and its derivative by (rotation, translation).
/// The sigma's derivative is part of it: without that, noise draws the rotation towards none and
/// the translation into the image plane (the bias of reweighted least squares; K. Kanatani,
/// "Statistical Optimization for Geometric Computation", 1996).
struct Epipolar {
  Epipolar(const Motion& at, const TwoViewMatch& m, const Noise& noise)
      : y(at.R * First(m)), f(Second(m)), g(f.cross(at.t)) {
    const Vector3 line = at.t.cross(y);         // epipolar line in the second image,
    const Vector3 back = at.R.transpose() * g;  // and in the first
    const double xx = noise.x * noise.x, yy = noise.y * noise.y;
    p = Vector3(xx * line[0], yy * line[1], 0.0);
    q = Vector3(xx * back[0], yy * back[1], 0.0);
    const double variance = p.dot(line) + q.dot(back);
    weight = variance > 0.0 ? 1.0 / std::sqrt(variance) : 0.0;
    error = weight * f.dot(line);
  }
  void Derivatives(const Motion& at, Vector3* by_rotation, Vector3* by_translation) const {
    const Vector3 turned = at.R * q;
    const double part = error * weight * weight;
    *by_rotation = weight * y.cross(g) - part * (y.cross(p.cross(at.t)) + turned.cross(g));
    *by_translation = weight * y.cross(f) - part * (y.cross(p) + turned.cross(f));
  }
  Vector3 y, f, g, p, q;
  double weight = 0.0;
  double error = 0.0;  ///< in sigmas
};

}  // namespace glissade::internal::epipolar
