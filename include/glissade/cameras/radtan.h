// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/cameras/concept.h"
#include "glissade/cameras/pinhole.h"

namespace glissade {

/// Pinhole camera with radial-tangential distortion (D. Brown 1966; the model of OpenCV, Kalibr's
/// and EuRoC's "radtan"). With (x, y) normalized and r^2 = x^2 + y^2:
///     x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
///     y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
///     u = fx x_d + cx, v = fy y_d + cy (px).
/// Evaluated behind the camera and far outside the image as well; no value at z = 0.
struct CameraRadtan {
  CameraPinhole pinhole;
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;

  bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const {
    Vector2 xy;
    if (!CameraIdentity().Project(p_c, xy, d_uv_d_p)) return false;
    Matrix2 d_distorted_d_xy;
    const Vector2 distorted = Distort(xy, d_uv_d_p != nullptr ? &d_distorted_d_xy : nullptr);
    uv[0] = pinhole.fx * distorted[0] + pinhole.cx;
    uv[1] = pinhole.fy * distorted[1] + pinhole.cy;
    if (d_uv_d_p != nullptr) {
      d_distorted_d_xy.row(0) *= pinhole.fx;
      d_distorted_d_xy.row(1) *= pinhole.fy;
      *d_uv_d_p = (d_distorted_d_xy * *d_uv_d_p).eval();
    }
    return true;
  }

  /// By Newton's method. False where it finds no ray on the branch that contains the image centre:
  /// outside the area where the distortion is invertible.
  bool Unproject(const Vector2& uv, Vector2& xy, Matrix2* d_xy_d_uv) const {
    Vector2 distorted;
    pinhole.Unproject(uv, distorted, nullptr);
    Matrix2 J;
    Vector2 x = distorted;
    Vector2 error = Distort(x, &J) - distorted;
    const double tolerance = 1e-14 * (1.0 + distorted.norm());
    for (int iteration = 0; iteration < 50 && !(error.norm() <= tolerance); ++iteration) {
      const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
      const Vector2 step((J(1, 1) * error[0] - J(0, 1) * error[1]) / det,
                         (J(0, 0) * error[1] - J(1, 0) * error[0]) / det);
      // Shorter steps until the error falls keep the iteration from jumping to another branch.
      double length = 1.0;
      Vector2 trial, trial_error;
      do {
        trial = x - length * step;
        trial_error = Distort(trial, &J) - distorted;
        length *= 0.5;
      } while (!(trial_error.norm() < error.norm()) && length > 1e-4);
      if (!(trial_error.norm() < error.norm())) break;  // rounding, or no solution
      x = trial;
      error = trial_error;
    }
    error = Distort(x, &J) - distorted;
    const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    if (!(error.norm() <= 100.0 * tolerance) || !(det > 0.0) || !(RadialSlope(x) > 0.0))
      return false;
    xy = x;
    if (d_xy_d_uv != nullptr) {
      *d_xy_d_uv << J(1, 1) / (det * pinhole.fx), -J(0, 1) / (det * pinhole.fy),
          -J(1, 0) / (det * pinhole.fx), J(0, 0) / (det * pinhole.fy);
    }
    return true;
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = pinhole.Validate(); !s.ok()) return s;
    const double k[5] = {k1, k2, p1, p2, k3};
    return ValidateFinite(k, 5, "radial-tangential distortion");
  }

  friend bool operator==(const CameraRadtan&, const CameraRadtan&) = default;

 private:
  [[nodiscard]] Vector2 Distort(const Vector2& xy, Matrix2* J) const {
    const double x = xy[0], y = xy[1], n = x * x + y * y;
    const double radial = 1.0 + n * (k1 + n * (k2 + n * k3));
    if (J != nullptr) {
      const double slope = 2.0 * (k1 + n * (2.0 * k2 + n * 3.0 * k3));  // d radial / d n * 2
      const double off = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
      *J << radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x, off,  //
          off, radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
    }
    return {x * radial + 2.0 * p1 * x * y + p2 * (n + 2.0 * x * x),
            y * radial + p1 * (n + 2.0 * y * y) + 2.0 * p2 * x * y};
  }

  /// Smallest d(r radial(r)) / dr on the way from the centre to |xy|: positive on the first branch.
  [[nodiscard]] double RadialSlope(const Vector2& xy) const {
    const double n_end = xy.squaredNorm();
    constexpr int kSamples = 32;
    double smallest = 1.0;
    for (int i = 1; i <= kSamples; ++i) {
      const double n = n_end * i / kSamples;
      smallest = std::min(smallest, 1.0 + n * (3.0 * k1 + n * (5.0 * k2 + n * 7.0 * k3)));
    }
    return smallest;
  }
};

static_assert(CameraModel<CameraRadtan>);

}  // namespace glissade
