// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "glissade/base/small_matrix.h"

/// \file
/// A camera whose parameters are a vertex (edges/reprojection_intrinsics.h), shared by as many
/// images as were taken with it:
///
///     static constexpr int kDim = 5;          // numbers
///     template <class T>
///     static bool Project(const T* intrinsics, const Vec<T, 3>& p_c, Vec<T, 2>& uv,
///                         Mat<T, 2, 3>* d_uv_d_p, Mat<T, 2, kDim>* d_uv_d_intrinsics);
///
/// Project is that of a CameraModel (cameras/concept.h) for any scalar, of `kDim` numbers, and has
/// the derivatives by these too. Either pointer may be null.
namespace glissade {

template <class C>
concept IntrinsicsModel = requires(const double* intrinsics, const Vec<double, 3>& p_c,
                                   Vec<double, 2>& uv, Mat<double, 2, 3>* d_uv_d_p,
                                   Mat<double, 2, C::kDim>* d_uv_d_intrinsics) {
  { C::Project(intrinsics, p_c, uv, d_uv_d_p, d_uv_d_intrinsics) } -> std::same_as<bool>;
};

}  // namespace glissade
