// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "glissade/base/validate.h"
#include "glissade/cameras/concept.h"
#include "glissade/cameras/pinhole.h"

namespace glissade {

/// Fisheye camera (J. Kannala, S. Brandt, PAMI 2006; OpenCV's fisheye, Kalibr's "equidistant").
/// With theta the angle between ray and optical axis and r = sqrt(x^2 + y^2):
///     theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///     u = fx theta_d x / r + cx, v = fy theta_d y / r + cy (px).
/// Rays of up to 180 degrees off the axis have an image, also those with z <= 0; the backward axis
/// itself (x = y = 0, z <= 0) has none.
struct CameraKannalaBrandt {
  CameraPinhole pinhole;
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, k4 = 0.0;

  template <class T>
  bool Project(const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) const {
    using std::atan2;
    using std::sqrt;
    const T x = p_c[0], y = p_c[1], z = p_c[2];
    const T r2 = x * x + y * y;
    // s = theta_d / r and A = (d theta_d / dr - s) / r^2; theta_d' = d theta_d / d theta.
    T s, A, slope;
    if ((z > T(0.0)) & (r2 < T(1e-10) * z * z)) {
      s = (T(1.0) + T(k1 - 1.0 / 3) * (r2 / (z * z))) / z;
      A = T(2.0 * (k1 - 1.0 / 3)) / (z * z * z);
      slope = T(1.0) + T(3.0 * k1) * (r2 / (z * z));
    } else {
      const T r = sqrt(r2);
      if (!(r > T(0.0))) return false;
      const T theta = atan2(r, z);
      s = Distort(theta, slope) / r;
      A = (slope * z / (r2 + z * z) - s) / r2;
    }
    const T fx(pinhole.fx), fy(pinhole.fy);
    uv = {{fx * s * x + T(pinhole.cx), fy * s * y + T(pinhole.cy)}};
    if (d_uv_d_p != nullptr) {
      const T d_z = -slope / (r2 + z * z);
      *d_uv_d_p = {{fx * (s + A * x * x), fx * A * x * y, fx * d_z * x,  //
                    fy * A * x * y, fy * (s + A * y * y), fy * d_z * y}};
    }
    return true;
  }
  bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const {
    return internal::ProjectEigen(*this, p_c, uv, d_uv_d_p);
  }

  /// By Newton's method on theta. False where there is no ray (x/z, y/z, 1): 90 degrees and more
  /// off the axis, or outside what the polynomial reaches before it turns back.
  bool Unproject(const Vector2& uv, Vector2& xy, Matrix2* d_xy_d_uv) const {
    Vector2 m;
    pinhole.Unproject(uv, m, nullptr);
    const double theta_d2 = m.squaredNorm(), theta_d = std::sqrt(theta_d2);
    double theta, slope;
    if (!Undistort(theta_d, theta, slope)) return false;
    // xy = g m with g = tan(theta) / theta_d; B = (d tan(theta) / d theta_d - g) / theta_d^2.
    double g, B;
    if (theta_d2 < 1e-10) {
      g = 1.0 + (1.0 / 3 - k1) * theta_d2;
      B = 2.0 * (1.0 / 3 - k1);
    } else {
      const double tangent = std::tan(theta);
      g = tangent / theta_d;
      B = ((1.0 + tangent * tangent) / slope - g) / theta_d2;
    }
    xy = g * m;
    if (d_xy_d_uv != nullptr) {
      *d_xy_d_uv << (g + B * m[0] * m[0]) / pinhole.fx, B * m[0] * m[1] / pinhole.fy,  //
          B * m[0] * m[1] / pinhole.fx, (g + B * m[1] * m[1]) / pinhole.fy;
    }
    return true;
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = pinhole.Validate(); !s.ok()) return s;
    const double k[4] = {k1, k2, k3, k4};
    return ValidateFinite(k, 4, "Kannala-Brandt distortion");
  }

  friend bool operator==(const CameraKannalaBrandt&, const CameraKannalaBrandt&) = default;

 private:
  /// theta_d and d theta_d / d theta.
  template <class T>
  T Distort(const T& theta, T& slope) const {
    const T n = theta * theta;
    slope = T(1.0) + n * (T(3.0 * k1) + n * (T(5.0 * k2) + n * (T(7.0 * k3) + n * T(9.0 * k4))));
    return theta * (T(1.0) + n * (T(k1) + n * (T(k2) + n * (T(k3) + n * T(k4)))));
  }

  /// The smallest theta in [0, pi/2) with this theta_d. Safeguarded: theta_d grows from 0 on the
  /// first branch, so that the bracket [low, high] holds the solution while the slope is positive.
  bool Undistort(double theta_d, double& theta, double& slope) const {
    constexpr double kLimit = std::numbers::pi / 2 - 1e-9;
    double low = 0.0, high = kLimit;
    constexpr int kSamples = 32;  // first sample that passes theta_d, as long as the branch rises
    bool bracketed = false;
    for (int i = 1; i <= kSamples && !bracketed; ++i) {
      const double at = kLimit * i / kSamples;
      double d_at;
      bracketed = Distort(at, d_at) >= theta_d;
      if (!bracketed && !(d_at > 0.0)) return false;
      (bracketed ? high : low) = at;
    }
    if (!bracketed) return false;
    theta = 0.5 * (low + high);
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double error = Distort(theta, slope) - theta_d;
      (error > 0.0 ? high : low) = theta;
      double next = theta - error / slope;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      const double step = std::abs(next - theta);
      theta = next;
      if (step <= 4e-16 * (1.0 + theta)) break;
    }
    Distort(theta, slope);
    return slope > 0.0;
  }
};

static_assert(CameraModel<CameraKannalaBrandt>);

}  // namespace glissade
