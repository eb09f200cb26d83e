// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/camera.h"

#include <cmath>
#include <type_traits>

namespace glissade::vision {

bool Camera::Undistort(const double uv[2], double xy[2]) const {
  Vector2 out;
  const bool ok = std::visit(
      [&](const auto& lens_) { return lens_.Unproject(Vector2(uv[0], uv[1]), out, nullptr); },
      lens);
  if (!ok || !std::isfinite(out[0]) || !std::isfinite(out[1])) return false;
  xy[0] = out[0];
  xy[1] = out[1];
  return true;
}

bool Camera::Distort(const double xy[2], double uv[2]) const {
  Vector2 out;
  const bool ok = std::visit(
      [&](const auto& lens_) { return lens_.Project(Vector3(xy[0], xy[1], 1.0), out, nullptr); },
      lens);
  if (!ok || !std::isfinite(out[0]) || !std::isfinite(out[1])) return false;
  uv[0] = out[0];
  uv[1] = out[1];
  return true;
}

const CameraPinhole& Camera::pinhole() const {
  return std::visit(
      [](const auto& lens_) -> const CameraPinhole& {
        if constexpr (std::is_same_v<std::decay_t<decltype(lens_)>, CameraPinhole>) {
          return lens_;
        } else {
          return lens_.pinhole;
        }
      },
      lens);
}

Status Camera::Validate() const {
  if (Status s = std::visit([](const auto& lens_) { return lens_.Validate(); }, lens); !s.ok()) {
    return s;
  }
  if (width < 1 || height < 1) {
    return {StatusCode::kNotPositive, "an image has a width and a height of at least 1"};
  }
  return ValidatePose(T_b_c.data, "T_b_c");
}

WindowCamera WithoutDistortion(const Camera& camera, double sigma_px) {
  const CameraPinhole& pinhole = camera.pinhole();
  WindowCamera out;
  out.fx = pinhole.fx;
  out.fy = pinhole.fy;
  out.cx = pinhole.cx;
  out.cy = pinhole.cy;
  out.sigma_px = sigma_px;
  out.T_b_c = camera.T_b_c;
  return out;
}

}  // namespace glissade::vision
