// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "glissade/base/matrix.h"
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
namespace glissade {

template <class C>
concept CameraModel = std::copyable<C> && std::default_initializable<C> &&
    std::equality_comparable<C> &&
    requires(const C camera, const Vector3& p_c, const Vector2& in, Vector2& out,
             Matrix<2, 3>* d_uv_d_p, Matrix2* d_xy_d_uv) {
  { camera.Project(p_c, out, d_uv_d_p) } -> std::same_as<bool>;
  { camera.Unproject(in, out, d_xy_d_uv) } -> std::same_as<bool>;
};

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
