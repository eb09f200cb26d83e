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

  template <class T>
  bool Project(const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) const {
    Vec<T, 2> xy;
    if (!CameraIdentity().Project(p_c, xy, d_uv_d_p)) return false;
    Mat<T, 2, 2> d_distorted_d_xy;
    const Vec<T, 2> distorted = Distort(xy, d_uv_d_p != nullptr ? &d_distorted_d_xy : nullptr);
    uv = {{T(pinhole.fx) * distorted[0] + T(pinhole.cx),
           T(pinhole.fy) * distorted[1] + T(pinhole.cy)}};
    if (d_uv_d_p != nullptr) {
      for (int c = 0; c < 2; ++c) {
        d_distorted_d_xy(0, c) *= T(pinhole.fx);
        d_distorted_d_xy(1, c) *= T(pinhole.fy);
      }
      *d_uv_d_p = d_distorted_d_xy * *d_uv_d_p;
    }
    return true;
  }
  bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const {
    return internal::ProjectEigen(*this, p_c, uv, d_uv_d_p);
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
  template <class T>
  [[nodiscard]] Vec<T, 2> Distort(const Vec<T, 2>& xy, Mat<T, 2, 2>* J) const {
    const T x = xy[0], y = xy[1], n = x * x + y * y;
    const T radial = T(1.0) + n * (T(k1) + n * (T(k2) + n * T(k3)));
    if (J != nullptr) {
      // d radial / d n * 2
      const T slope = T(2.0) * (T(k1) + n * (T(2.0 * k2) + n * T(3.0 * k3)));
      const T off = slope * x * y + T(2.0 * p1) * x + T(2.0 * p2) * y;
      *J = {{radial + slope * x * x + T(2.0 * p1) * y + T(6.0 * p2) * x, off,  //
             off, radial + slope * y * y + T(6.0 * p1) * y + T(2.0 * p2) * x}};
    }
    return {{x * radial + T(2.0 * p1) * x * y + T(p2) * (n + T(2.0) * x * x),
             y * radial + T(p1) * (n + T(2.0) * y * y) + T(2.0 * p2) * x * y}};
  }
  [[nodiscard]] Vector2 Distort(const Vector2& xy, Matrix2* J) const {
    Mat<double, 2, 2> d;
    const Vec<double, 2> out = Distort(Vec<double, 2>{{xy[0], xy[1]}}, J != nullptr ? &d : nullptr);
    for (int i = 0; J != nullptr && i < 4; ++i)
      (*J)(i / 2, i % 2) = d[i];
    return {out[0], out[1]};
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
