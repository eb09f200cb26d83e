// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::internal {

// Dense symmetric matrices here are column-major, given by their lower triangle, and "augmented":
// with [J | r] the last row and column stand for the residual,
//     A = [J r]'[J r] = [H g; g' c],   g = J'r = -b,   c = r'r,
// so that one operation on A does what has to be done to H, to b and to the cost.

/// Storage that is kept from call to call.
struct DenseScratch {
  std::vector<double> scale, block, panel, rows, work;
  std::vector<int> order;
};

/// Refuses a relative_cut that is not finite (kNotFinite) or would cut everything.
Status ValidateRelativeCut(double relative_cut, std::string_view whose);

/// Eliminates the first m of n variables: the trailing lower triangle becomes the Schur complement
/// A22 - A21 A11^+ A12; the first m columns are void. A11 is scaled to a unit diagonal; Cholesky
/// where it is safely positive definite, else eigenvalues below relative_cut (<= 0: 4 m eps) times
/// the largest are cut. Returns the rank of A11, or -1 if it has an eigenvalue that is negative
/// beyond rounding or is not finite. weak: set to 1 for variables that take part in a direction
/// that was cut, may be null.
int EliminateLeading(int n, int m, double* A, int lda, double relative_cut, DenseScratch* scratch,
                     unsigned char* weak);

}  // namespace glissade::internal
