// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "glissade/cameras/intrinsics_fisheye.h"
#include "glissade/cameras/intrinsics_radial.h"
#include "glissade/cameras/intrinsics_radtan.h"
#include "glissade/io/colmap.h"

namespace glissade::internal {

/// How a camera model of COLMAP is one of the library's: its parameters are the first ones of that.
struct ColmapIntrinsics {
  enum class Family : std::uint8_t { kNone, kRadial, kRadtan, kFisheye };
  Family family = Family::kNone;
  int num_focal = 0;       ///< focal lengths, then two numbers of the principal point
  int num_parameters = 0;  ///< of COLMAP's model

  [[nodiscard]] int dim() const {
    switch (family) {
      case Family::kRadial:
        return IntrinsicsRadial::kDim;
      case Family::kRadtan:
        return IntrinsicsRadtan::kDim;
      case Family::kFisheye:
        return IntrinsicsFisheye::kDim;
      case Family::kNone:
        break;
    }
    return 0;
  }
  /// For Graph::SetFixedNumbers.
  [[nodiscard]] std::uint32_t Held(bool free_focal_length, bool free_principal_point,
                                   bool free_distortion) const {
    std::uint32_t held = 0;
    for (int k = 0; k < dim(); ++k) {
      const bool is_free = k < num_focal        ? free_focal_length
                           : k < num_focal + 2  ? free_principal_point
                           : k < num_parameters ? free_distortion
                                                : false;
      if (!is_free) held |= 1u << k;
    }
    return held;
  }
};

inline ColmapIntrinsics IntrinsicsOf(ColmapCameraModel model) {
  using Family = ColmapIntrinsics::Family;
  const int count = ColmapNumParameters(model);
  switch (model) {
    case ColmapCameraModel::kSimplePinhole:
    case ColmapCameraModel::kSimpleRadial:
    case ColmapCameraModel::kRadial:
      return {Family::kRadial, 1, count};
    case ColmapCameraModel::kPinhole:
    case ColmapCameraModel::kOpenCv:
      return {Family::kRadtan, 2, count};
    case ColmapCameraModel::kOpenCvFisheye:
      return {Family::kFisheye, 2, count};
    default:
      return {};
  }
}

/// Of a point in the camera; false where it has no image, or the model is none of the library's.
inline bool ProjectColmap(const ColmapCamera& camera, const Vec<double, 3>& p_c,
                          Vec<double, 2>& uv) {
  double numbers[8] = {};
  std::copy_n(camera.parameters.begin(), std::min<std::size_t>(8, camera.parameters.size()),
              numbers);
  switch (IntrinsicsOf(camera.model).family) {
    case ColmapIntrinsics::Family::kRadial:
      return IntrinsicsRadial::Project<double>(numbers, p_c, uv, nullptr, nullptr);
    case ColmapIntrinsics::Family::kRadtan:
      return IntrinsicsRadtan::Project<double>(numbers, p_c, uv, nullptr, nullptr);
    case ColmapIntrinsics::Family::kFisheye:
      return IntrinsicsFisheye::Project<double>(numbers, p_c, uv, nullptr, nullptr);
    case ColmapIntrinsics::Family::kNone:
      break;
  }
  return false;
}

}  // namespace glissade::internal
