// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/matrix.h"
#include "glissade/edges/concept.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/vector.h"

/// \file
/// Vertices, edges and losses as a user of the library would write them: nothing in the library
/// knows these types.
namespace glissade::test {

/// Direction in the world of a point at infinity: a landmark on the unit sphere, tangent 2.
struct VertexBearing {
  static constexpr int kAmbientDim = 3;
  static constexpr int kTangentDim = 2;
  static constexpr bool kEliminated = true;

  double data[3] = {0.0, 0.0, 1.0};

  double* Data() { return data; }
  const double* Data() const { return data; }
  [[nodiscard]] Vector3 d() const { return {data[0], data[1], data[2]}; }

  /// Orthonormal basis of the tangent plane.
  [[nodiscard]] Matrix<3, 2> Basis() const {
    const Vector3 x = d();
    int smallest = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(x[i]) < std::abs(x[smallest])) smallest = i;
    }
    Vector3 axis = Vector3::Zero();
    axis[smallest] = 1.0;
    const Vector3 b1 = axis.cross(x).normalized();
    const Vector3 b2 = x.cross(b1);
    Matrix<3, 2> basis;
    for (int i = 0; i < 3; ++i) {
      basis(i, 0) = b1[i];
      basis(i, 1) = b2[i];
    }
    return basis;
  }
  /// Along the great circle.
  void Plus(const double* delta) {
    const Vector2 step(delta[0], delta[1]);
    const double x = step.squaredNorm();
    const double t = std::sqrt(x);
    const double sin_over_t = x < 1e-8 ? 1.0 - x / 6.0 : std::sin(t) / t;
    const Vector3 moved = (std::cos(t) * d() + sin_over_t * Vector3(Basis() * step)).normalized();
    for (int i = 0; i < 3; ++i)
      data[i] = moved[i];
  }
  void Minus(const VertexBearing& x0, double* delta) const {
    const Vector2 tangent = x0.Basis().transpose() * d();
    const double sin_t = tangent.norm();
    const double t = std::atan2(sin_t, x0.d().dot(d()));
    const double scale = sin_t < 1e-8 ? 1.0 : t / sin_t;
    delta[0] = scale * tangent[0];
    delta[1] = scale * tangent[1];
  }
};

/// A positive factor, moved in its logarithm: as many numbers as degrees of freedom, not additive.
struct VertexScale {
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;

  double s = 1.0;

  double* Data() { return &s; }
  const double* Data() const { return &s; }
  void Plus(const double* delta) { s *= std::exp(delta[0]); }
  void Minus(const VertexScale& x0, double* delta) const { delta[0] = std::log(s / x0.s); }
};

/// A line (x, y) = a + b z in the world: a landmark with the largest tangent allowed, 4.
struct VertexLine {
  static constexpr int kAmbientDim = 4;
  static constexpr int kTangentDim = 4;
  static constexpr bool kEliminated = true;

  double data[4] = {};  ///< a, b

  double* Data() { return data; }
  const double* Data() const { return data; }
  void Plus(const double* delta) {
    for (int i = 0; i < 4; ++i)
      data[i] += delta[i];
  }
  void Minus(const VertexLine& x0, double* delta) const {
    for (int i = 0; i < 4; ++i)
      delta[i] = data[i] - x0.data[i];
  }
};

/// Normalized coordinates of a bearing in the body frame (body z forward).
struct EdgeBearing {
  using Vertices = VertexList<VertexPose, VertexBearing>;
  static constexpr int kResidualDim = 2;

  Vector2 xy = Vector2::Zero();

  bool Evaluate(const VertexPose& pose, const VertexBearing& bearing, Vector2& r,
                Jacobian<2, 6>* d_r_d_pose, Jacobian<2, 2>* d_r_d_bearing) const {
    const Matrix3 R = pose.pose.R();
    const Vector3 d_b = R.transpose() * bearing.d();
    if (d_b[2] == 0.0) return false;
    const double inv_z = 1.0 / d_b[2];
    r = inv_z * d_b.head<2>() - xy;
    Matrix<2, 3> d_r_d_b;
    d_r_d_b << inv_z, 0.0, -d_b[0] * inv_z * inv_z,  //
        0.0, inv_z, -d_b[1] * inv_z * inv_z;
    if (d_r_d_pose != nullptr) {
      d_r_d_pose->setZero();
      d_r_d_pose->rightCols<3>() = d_r_d_b * so3::Hat(d_b);
    }
    if (d_r_d_bearing != nullptr) *d_r_d_bearing = d_r_d_b * R.transpose() * bearing.Basis();
    return true;
  }
};

/// Distance from a pose to a point by a device of unknown scale.
struct EdgeScaledRange {
  using Vertices = VertexList<VertexPose, VertexPointXYZ, VertexScale>;
  static constexpr int kResidualDim = 1;

  double measured = 1.0;

  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, const VertexScale& scale,
                Vector<1>& r, Jacobian<1, 6>* d_r_d_pose, Jacobian<1, 3>* d_r_d_point,
                Jacobian<1, 1>* d_r_d_scale) const {
    const Vector3 to_point = point.p() - pose.pose.p();
    const double distance = to_point.norm();
    if (distance == 0.0) return false;
    r[0] = scale.s * distance - measured;
    const Vector3 direction = scale.s / distance * to_point;
    if (d_r_d_pose != nullptr) {
      d_r_d_pose->setZero();
      d_r_d_pose->leftCols<3>() = -direction.transpose();
    }
    if (d_r_d_point != nullptr) *d_r_d_point = direction.transpose();
    if (d_r_d_scale != nullptr) (*d_r_d_scale)(0, 0) = scale.s * distance;
    return true;
  }
};

/// The body's place on a line, at the body's height.
struct EdgeOnLine {
  using Vertices = VertexList<VertexPose, VertexLine>;
  static constexpr int kResidualDim = 2;

  Vector2 offset = Vector2::Zero();

  bool Evaluate(const VertexPose& pose, const VertexLine& line, Vector2& r,
                Jacobian<2, 6>* d_r_d_pose, Jacobian<2, 4>* d_r_d_line) const {
    const auto p = pose.pose.p();
    const double* l = line.data;
    r = Vector2(l[0] + l[2] * p[2] - p[0], l[1] + l[3] * p[2] - p[1]) - offset;
    if (d_r_d_pose != nullptr) {
      d_r_d_pose->setZero();
      d_r_d_pose->leftCols<3>() << -1.0, 0.0, l[2],  //
          0.0, -1.0, l[3];
    }
    if (d_r_d_line != nullptr) {
      *d_r_d_line << 1.0, 0.0, p[2], 0.0,  //
          0.0, 1.0, 0.0, p[2];
    }
    return true;
  }
};

/// Some nonlinear function of a pose and two plain numbers.
struct EdgeOffset {
  using Vertices = VertexList<VertexPose, VertexVector<2>>;
  static constexpr int kResidualDim = 3;

  Vector3 measured = Vector3::Zero();

  bool Evaluate(const VertexPose& pose, const VertexVector<2>& offset, Vector3& r,
                Jacobian<3, 6>* d_r_d_pose, Jacobian<3, 2>* d_r_d_offset) const {
    const double u = offset.value[0], v = offset.value[1];
    const Matrix3 R = pose.pose.R();
    const Vector3 lever(std::sin(u), u * v, v);
    r = pose.pose.p() + R * lever - measured;
    if (d_r_d_pose != nullptr) {
      d_r_d_pose->leftCols<3>().setIdentity();
      d_r_d_pose->rightCols<3>() = -(R * so3::Hat(lever));
    }
    if (d_r_d_offset != nullptr) {
      Matrix<3, 2> d_lever;
      d_lever << std::cos(u), 0.0,  //
          v, u,                     //
          0.0, 1.0;
      *d_r_d_offset = R * d_lever;
    }
    return true;
  }
};

/// Geman and McClure's loss.
struct GemanMcClure {
  double width = 1.0;
  void Evaluate(double s, double rho[3]) const {
    const double c = 1.0 / (1.0 + s / (width * width));
    rho[0] = s * c;
    rho[1] = c * c;
    rho[2] = -2.0 * c * c * c / (width * width);
  }
};

/// Convex in s, rho'' > 0: the only kind for which the second-order term of the robust correction
/// is used.
struct Amplify {
  double a = 1e-3;
  void Evaluate(double s, double rho[3]) const {
    rho[0] = s + a * s * s;
    rho[1] = 1.0 + 2.0 * a * s;
    rho[2] = 2.0 * a;
  }
};

}  // namespace glissade::test
