// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "glissade/base/status.h"

namespace glissade {

/// The normal equations of what is kept.
struct DenseSchurComplement {
  Eigen::MatrixXd H;  ///< in the order of `keep`
  Eigen::VectorXd b;
  int rank =
      0;  ///< of the marginalized block: less than its size where something has no information
};

namespace internal {
/// H: n x n symmetric; S: keep.size()^2, b_s: keep.size().
Status SchurComplement(int n, const double* H, const double* b, std::span<const int> keep,
                       std::span<const int> marginalize, double relative_cut, double* S,
                       double* b_s, int* rank);
}  // namespace internal

/// Marginalizes variables out of the quadratic 1/2 x'H x - b'x (H dx = b, H = J'J, b = -J'r):
///     S = H_kk - H_km H_mm^+ H_mk,    b_s = b_k - H_km H_mm^+ b_m.
///
/// H_mm is scaled to a unit diagonal (Jacobi), so that the outcome does not depend on units, and
/// factored by Cholesky; where it is close to singular, eigenvalues of the scaled block below
/// relative_cut times the largest are left out (pseudo-inverse). relative_cut <= 0: 4 n eps.
/// Variables in neither list are held where they are.
///
/// Refused: relative_cut that is not finite or not below 1, sizes that do not match, an index out
/// of range or twice (kInvalidArgument), H not symmetric to 1e-9 (kInvalidArgument), not finite
/// (kNotFinite), H_mm with an eigenvalue that is negative beyond rounding (kNotPositive).
///
/// Source: Leutenegger et al., "Keyframe-Based Visual-Inertial Odometry Using Nonlinear
/// Optimization" (IJRR 2015), Eqs. (25)-(27).
template <int = 0>
Result<DenseSchurComplement> SchurComplement(const Eigen::MatrixXd& H, const Eigen::VectorXd& b,
                                             const std::vector<int>& keep,
                                             const std::vector<int>& marginalize,
                                             double relative_cut = 0.0) {
  if (H.rows() != H.cols() || b.size() != H.rows()) {
    return Status(StatusCode::kInvalidArgument, "SchurComplement: H must be square, b as long");
  }
  DenseSchurComplement out;
  const auto n = static_cast<Eigen::Index>(keep.size());
  out.H.resize(n, n);
  out.b.resize(n);
  Status status =
      internal::SchurComplement(static_cast<int>(H.rows()), H.data(), b.data(), keep, marginalize,
                                relative_cut, out.H.data(), out.b.data(), &out.rank);
  if (!status.ok()) return status;
  return out;
}

}  // namespace glissade
