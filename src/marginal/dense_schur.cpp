// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/dense_schur.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade::internal {

namespace {

using internal::Index;

/// Y (m x columns) <- Lambda^+1/2 V' Y with the eigenvectors of the scaled block, of which those
/// under the cut are left out. Returns the rank or -1.
int ApplyInverseRoot(int m, const double* block, double cut, int columns, double* Y,
                     unsigned char* weak) {
  const Eigen::Map<const Eigen::MatrixXd> lower(block, m, m);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(lower);
  if (eigen.info() != Eigen::Success || !eigen.eigenvalues().allFinite()) return -1;
  const double largest = eigen.eigenvalues()[m - 1];
  // What rounding of a positive semi-definite matrix can leave; more is not one.
  if (eigen.eigenvalues()[0] < -std::max(cut, 1e-8) * std::max(largest, 0.0)) return -1;
  Eigen::VectorXd inverse_root(m);
  int rank = 0;
  for (int k = 0; k < m; ++k) {
    const double lambda = eigen.eigenvalues()[k];
    const bool kept = lambda > cut * largest && lambda > 0.0;
    inverse_root[k] = kept ? 1.0 / std::sqrt(lambda) : 0.0;
    if (kept) {
      ++rank;
    } else if (weak != nullptr) {
      for (int i = 0; i < m; ++i)
        if (std::abs(eigen.eigenvectors()(i, k)) > 0.1 / std::sqrt(m)) weak[i] = 1;
    }
  }
  Eigen::Map<Eigen::MatrixXd> y(Y, m, columns);
  y = inverse_root.asDiagonal() * (eigen.eigenvectors().transpose() * y).eval();
  return rank;
}

}  // namespace

Status ValidateRelativeCut(double relative_cut, std::string_view whose) {
  if (!std::isfinite(relative_cut)) {
    return {StatusCode::kNotFinite, std::string(whose) + ": relative_cut is not finite"};
  }
  if (relative_cut < 1.0) return {};
  return {StatusCode::kInvalidArgument, std::string(whose) + ": relative_cut must be below 1"};
}

int EliminateLeading(int n, int m, double* A, int lda, double relative_cut, DenseScratch* scratch,
                     unsigned char* weak) {
  if (m == 0) return 0;
  const kernels::KernelTable& k = kernels::Kernels();
  const double cut =
      relative_cut > 0.0 ? relative_cut : 4.0 * m * std::numeric_limits<double>::epsilon();
  const auto at = [&](int row, int col) { return A + row + Index(col) * Index(lda); };
  const int kept = n - m;
  scratch->scale.resize(Index(m));
  scratch->block.resize(Index(m) * Index(m));
  scratch->panel.resize(Index(m) * Index(kept));
  double* const block = scratch->block.data();
  double* const scale = scratch->scale.data();
  double* const Y = scratch->panel.data();
  for (int i = 0; i < m; ++i) {
    const double h = *at(i, i);
    if (!std::isfinite(h) || h < 0.0) return -1;
    scale[i] = h > 0.0 ? 1.0 / std::sqrt(h) : 0.0;
  }
  const auto fill_block = [&] {
    for (int c = 0; c < m; ++c) {
      for (int r = c; r < m; ++r)
        block[r + Index(c) * Index(m)] = scale[r] * scale[c] * *at(r, c);
    }
  };
  fill_block();
  for (int c = 0; c < kept; ++c) {
    for (int r = 0; r < m; ++r)
      Y[r + Index(c) * Index(m)] = scale[r] * *at(m + c, r);
  }
  int rank = m;
  bool safe = k.cholesky(m, block, m) == 0;
  for (int i = 0; i < m && safe; ++i) {
    const double pivot = block[i + Index(i) * Index(m)];
    safe = pivot * pivot > 1e3 * cut;  // well above the cut: no eigenvalue is under it
  }
  if (safe) {
    k.forward_solve_many(m, block, m, kept, Y, m);
  } else {
    fill_block();
    rank = ApplyInverseRoot(m, block, cut, kept, Y, weak);
    if (rank < 0) return rank;
  }
  // W = Y' column-major, as the kernel wants it.
  scratch->rows.resize(Index(m) * Index(kept));
  double* const W = scratch->rows.data();
  for (int c = 0; c < m; ++c) {
    for (int r = 0; r < kept; ++r)
      W[r + Index(c) * Index(kept)] = Y[c + Index(r) * Index(m)];
  }
  k.syrk_lower_sub(kept, m, W, kept, at(m, m), lda);
  return rank;
}

}  // namespace glissade::internal
