// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "glissade/base/matrix.h"
#include "glissade/base/small_matrix.h"
#include "glissade/base/status.h"

/// \file
/// What a type must offer to be a camera model of the observation edges: a plain value with
///
///     bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const;
///     bool Unproject(const Vector2& uv, Vector2& xy, Matrix2* d_xy_d_uv) const;
///     Status Validate() const;   // optional: refuse impossible parameters
///
/// Project takes a point in camera axes (x right, y down, z forward) to image coordinates (pixels,
/// or whatever the model's focal length is in). It depends on the point's direction only, is
/// defined behind the camera too where the formula is, and returns false where no number exists.
/// Unproject takes image coordinates to the ray (x/z, y/z, 1) of an ideal camera and returns false
/// where there is no such ray. Each derivative is written unless its pointer is null.
///
/// With a Project for any scalar besides,
///
///     template <class T>
///     bool Project(const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) const;
///
/// the observation edges are evaluated in packs (base/pack.h). In a pack `return false` is for all
/// lanes: `if (z == T(0.0)) return false;` works, and evaluates once more one by one where the
/// lanes disagree. Without the condition a lane that has no value must give a uv that is not
/// finite, which the library finds, and so must what is computed from it: on top of CameraIdentity,
/// whose quotient at z = 0 is infinite or NaN in packs and is not refused there, a bounded function
/// (atan) would make a finite uv of the infinite one. Ask for z == 0 yourself in such a model.
namespace glissade {

template <class C>
concept CameraModel = std::copyable<C> && std::default_initializable<C> &&
    std::equality_comparable<C> &&
    requires(const C camera, const Vector3& p_c, const Vector2& in, Vector2& out,
             Matrix<2, 3>* d_uv_d_p, Matrix2* d_xy_d_uv) {
  { camera.Project(p_c, out, d_uv_d_p) } -> std::same_as<bool>;
  { camera.Unproject(in, out, d_xy_d_uv) } -> std::same_as<bool>;
};

namespace internal {
/// Whether the camera projects with any scalar.
template <class C>
concept LaneCamera = requires(const C camera, const Vec<double, 3>& p_c, Vec<double, 2>& uv,
                              Mat<double, 2, 3>* d_uv_d_p) {
  { camera.Project(p_c, uv, d_uv_d_p) } -> std::same_as<bool>;
};

/// Project of a camera that projects with any scalar, for double.
template <class C>
bool ProjectEigen(const C& camera, const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) {
  const Vec<double, 3> p = {{p_c[0], p_c[1], p_c[2]}};
  Vec<double, 2> out;
  Mat<double, 2, 3> d;
  if (!camera.Project(p, out, d_uv_d_p != nullptr ? &d : nullptr)) return false;
  for (int i = 0; i < 2; ++i)
    uv[i] = out[i];
  for (int i = 0; d_uv_d_p != nullptr && i < 6; ++i)
    d_uv_d_p->data()[i] = d[i];
  return true;
}

/// Any camera's Project on small matrices; other scalars than double for a LaneCamera only.
template <class T, class C>
bool ProjectLanes(const C& camera, const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) {
  if constexpr (LaneCamera<C>) {
    return camera.Project(p_c, uv, d_uv_d_p);
  } else {
    Vector2 out;
    Matrix<2, 3> d;
    if (!camera.Project(Vector3(p_c[0], p_c[1], p_c[2]), out, d_uv_d_p != nullptr ? &d : nullptr))
      return false;
    for (int i = 0; i < 2; ++i)
      uv[i] = out[i];
    for (int i = 0; d_uv_d_p != nullptr && i < 6; ++i)
      (*d_uv_d_p)[i] = d.data()[i];
    return true;
  }
}
}  // namespace internal

/// The camera's own Validate(), if it has one.
template <CameraModel Camera>
Status ValidateCamera(const Camera& camera) {
  if constexpr (requires {
                  { camera.Validate() } -> std::same_as<Status>;
                }) {
    return camera.Validate();
  } else {
    static_cast<void>(camera);
    return {};
  }
}

}  // namespace glissade
