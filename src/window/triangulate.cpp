// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/triangulate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/base/validate.h"

namespace glissade {

namespace {

/// Solves the symmetric positive definite A x = b and inverts A; false where A, scaled to a unit
/// diagonal, has a pivot below 1e-12.
bool InvertSymmetric(const Matrix3& A, Matrix3* inverse) {
  double scale[3];
  for (int i = 0; i < 3; ++i) {
    if (!(A(i, i) > 0.0)) return false;
    scale[i] = 1.0 / std::sqrt(A(i, i));
  }
  double L[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = A(i, j) * scale[i] * scale[j];
      for (int k = 0; k < j; ++k)
        sum -= L[i][k] * L[j][k];
      if (i == j) {
        if (!(sum > 1e-12)) return false;
        L[i][i] = std::sqrt(sum);
      } else {
        L[i][j] = sum / L[j][j];
      }
    }
  }
  double inv[3][3] = {};  // L^-1
  for (int i = 0; i < 3; ++i) {
    inv[i][i] = 1.0 / L[i][i];
    for (int j = 0; j < i; ++j) {
      double sum = 0.0;
      for (int k = j; k < i; ++k)
        sum -= L[i][k] * inv[k][j];
      inv[i][j] = sum / L[i][i];
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = std::max(i, j); k < 3; ++k)
        sum += inv[k][i] * inv[k][j];
      (*inverse)(i, j) = sum * scale[i] * scale[j];
    }
  }
  return true;
}

Vector3 RayInWorld(const TriangulationView& view) {
  Vector3 ray = view.T_w_c.R() * Vector3(view.uv[0], view.uv[1], 1.0);
  return ray / ray.norm();
}

/// The point nearest to all rays: sum of (I - d d')(X - c) = 0.
bool NearestToRays(std::span<const TriangulationView> views, Vector3* X, double* parallax) {
  Matrix3 A = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  double least_cosine = 1.0;
  const Vector3 first = RayInWorld(views[0]);
  for (const TriangulationView& view : views) {
    const Vector3 d = RayInWorld(view);
    const Matrix3 P = Matrix3::Identity() - d * d.transpose();
    A += P;
    b += P * view.T_w_c.p();
    least_cosine = std::min(least_cosine, first.dot(d));
  }
  *parallax = std::acos(std::clamp(least_cosine, -1.0, 1.0));
  Matrix3 inverse;
  if (!InvertSymmetric(A, &inverse)) return false;
  *X = inverse * b;
  return true;
}

/// Residual in sigmas and its derivative by the point; false at depth 0.
bool Linearize(const TriangulationView& view, const Vector3& X, Vector2* r, Matrix<2, 3>* J,
               double* depth) {
  const Matrix3 R_c_w = view.T_w_c.R().transpose();
  const Vector3 x = R_c_w * (X - view.T_w_c.p());
  *depth = x[2];
  if (!(std::abs(x[2]) > 1e-12)) return false;
  const double inv_z = 1.0 / x[2], weight = 1.0 / view.sigma;
  const double u = x[0] * inv_z, v = x[1] * inv_z;
  (*r)[0] = weight * (u - view.uv[0]);
  (*r)[1] = weight * (v - view.uv[1]);
  J->row(0) = weight * inv_z * (R_c_w.row(0) - u * R_c_w.row(2));
  J->row(1) = weight * inv_z * (R_c_w.row(1) - v * R_c_w.row(2));
  return true;
}

Status CheckViews(std::span<const TriangulationView> views) {
  if (views.size() < 2) {
    return {StatusCode::kInvalidArgument, "a point needs at least two views"};
  }
  for (const TriangulationView& view : views) {
    if (Status s = ValidatePose(view.T_w_c.data, "camera of a view"); !s.ok()) return s;
    if (Status s = ValidateFinite(view.uv.data(), 2, "observation"); !s.ok()) return s;
    if (Status s = ValidatePositive(view.sigma, "sigma of a view"); !s.ok()) return s;
  }
  return {};
}

}  // namespace

internal::TriangulationVerdict internal::TryToTriangulate(std::span<const TriangulationView> views,
                                                          const TriangulationOptions& options,
                                                          TriangulatedPoint* triangulated) {
  TriangulatedPoint& point = *triangulated;
  point = {};
  if (!NearestToRays(views, &point.X_w, &point.parallax)) {
    return {StatusCode::kSingular, "the rays are parallel: parallax in rad ", point.parallax};
  }
  for (int iteration = 0;; ++iteration) {
    Matrix3 H = Matrix3::Zero();
    Vector3 b = Vector3::Zero();
    double least_depth = 1e300;
    point.max_chi2 = 0.0;
    for (const TriangulationView& view : views) {
      Vector2 r;
      Matrix<2, 3> J;
      double depth = 0.0;
      if (!Linearize(view, point.X_w, &r, &J, &depth)) {
        return {StatusCode::kEvaluationFailed, "the point is in a camera's plane: depth ", depth};
      }
      H += J.transpose() * J;
      b -= J.transpose() * r;
      least_depth = std::min(least_depth, depth);
      point.max_chi2 = std::max(point.max_chi2, r.squaredNorm());
    }
    if (!InvertSymmetric(H, &point.covariance)) {
      return {StatusCode::kSingular, "the rays are parallel: parallax in rad ", point.parallax};
    }
    const Vector3 dx = point.covariance * b;
    const double promised = b.dot(dx);  // (dx in sigmas)^2
    if (iteration < options.max_iterations && promised > 1e-6) {
      point.X_w += dx;
      continue;
    }
    if (!std::isfinite(promised)) return {StatusCode::kNotFinite, "triangulated point: ", promised};
    if (!(least_depth >= options.min_depth)) {
      return {StatusCode::kEvaluationFailed, "the point is behind a camera or too near: m ",
              least_depth};
    }
    if (promised > 1.0) {
      return {StatusCode::kSingular, "no minimum nearby: last step in sigmas ",
              std::sqrt(promised)};
    }
    if (point.max_chi2 > options.max_chi2) {
      return {StatusCode::kEvaluationFailed, "a view does not fit: chi2 ", point.max_chi2};
    }
    break;
  }
  const Vector3 ray = point.X_w - views[0].T_w_c.p();
  const double distance = ray.norm();
  point.relative_sigma = std::sqrt(ray.dot(point.covariance * ray)) / (distance * distance);
  if (!(point.relative_sigma <= options.max_relative_sigma)) {
    return {StatusCode::kSingular, "the distance is not known: sigma / distance ",
            point.relative_sigma};
  }
  return {};
}

Result<TriangulatedPoint> Triangulate(std::span<const TriangulationView> views,
                                      const TriangulationOptions& options) {
  if (Status s = CheckViews(views); !s.ok()) return s;
  TriangulatedPoint point;
  const internal::TriangulationVerdict verdict = internal::TryToTriangulate(views, options, &point);
  if (verdict.code == StatusCode::kOk) return point;
  return Status(verdict.code, std::string(verdict.what).append(std::to_string(verdict.figure)));
}

}  // namespace glissade
