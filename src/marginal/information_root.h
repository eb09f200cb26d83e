// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "marginal/dense_schur.h"

namespace glissade::internal {

/// A square root of what a Schur complement left: J (rows x n, row-major) and r0 with J'J = H and
/// J'r0 = g, from the augmented A = [H g; g' c] (n + 1 columns, lower triangle). Both scale H to a
/// unit diagonal first, so that nothing depends on units.

/// J = upper triangular where H is positive definite; else by Cholesky with diagonal pivoting,
/// stopped where the largest pivot left is below relative_cut (<= 0: 4 n eps). Returns the rows, or
/// -1 where A is not finite. *constant = c - r0'r0.
int CholeskyRoot(int n, const double* A, int lda, double relative_cut, DenseScratch* scratch,
                 std::vector<double>* r0, std::vector<double>* jacobian, double* constant);

/// J = Lambda^1/2 V' P with the eigenvalues above relative_cut times the largest.
int EigenRoot(int n, const double* A, int lda, double relative_cut, std::vector<double>* r0,
              std::vector<double>* jacobian, double* constant);

}  // namespace glissade::internal
