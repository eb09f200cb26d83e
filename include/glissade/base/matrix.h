// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

/// \file
/// Fixed-size matrix types for everything that is stored or passed between translation units.
///
/// They are Eigen types without alignment requirement. Eigen's defaults align fixed-size members to
/// 16, 32 or 64 bytes depending on the instruction set a translation unit is compiled for, so that
/// a library built for plain x86-64 and a program built with -march=native would disagree about the
/// layout of every struct that holds one. With DontAlign the layout is the same everywhere.
///
/// A function of matrices in a widely included header is a template, if need be with a parameter
/// that nobody gives (`template <int = 0>`): the expressions in its body are then compiled where it
/// is called, and not in every translation unit that includes the header.
namespace glissade {

namespace internal {
// Eigen insists on column-major column vectors and row-major row vectors.
template <int Rows, int Cols>
inline constexpr int kRowMajorUnlessVector =
    (Cols == 1 ? Eigen::ColMajor : Eigen::RowMajor) | Eigen::DontAlign;
}  // namespace internal

/// Row-major matrix of doubles.
template <int Rows, int Cols>
using Matrix = Eigen::Matrix<double, Rows, Cols, internal::kRowMajorUnlessVector<Rows, Cols>>;

/// Column vector of doubles.
template <int Rows>
using Vector = Matrix<Rows, 1>;

template <int Size>
using SquareMatrix = Matrix<Size, Size>;

/// d(residual)/d(tangent): Rows = residual dimension, Cols = tangent dimension, row-major.
template <int Rows, int Cols>
using Jacobian = Matrix<Rows, Cols>;

using Vector2 = Vector<2>;
using Vector3 = Vector<3>;
using Vector6 = Vector<6>;
using Matrix2 = SquareMatrix<2>;
using Matrix3 = SquareMatrix<3>;
using Matrix6 = SquareMatrix<6>;

}  // namespace glissade
