// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Products with a reduced system that is not stored.

#include "glissade/base/index.h"
#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/landmark_view.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

// A chunk's part of H_pp x.
void NormalEquations::MultiplyPoses(const Hessian& H, int chunk, int num_chunks, const double* x,
                                    double* y) const {
  const auto part = [&](int c) { return H.num_pairs() * Index(c) / Index(num_chunks); };
  for (std::size_t k = part(chunk); k < part(chunk + 1); ++k) {
    const Hessian::PosePair pair = H.Pair(k);
    const double *x_row = x + H.offset(pair.row), *x_col = x + H.offset(pair.col);
    double *y_row = y + H.offset(pair.row), *y_col = y + H.offset(pair.col);
    const double* row = pair.H.data;
    for (int r = 0; r < pair.H.rows; ++r, row += pair.H.cols) {
      double sum = 0.0;
      for (int c = 0; c < pair.H.cols; ++c)
        sum += row[c] * x_col[c];
      y_row[r] += sum;
      for (int c = 0; c < pair.H.cols && pair.row != pair.col; ++c)
        y_col[c] += row[c] * x_row[r];
    }
  }
}

// y = (H_pp + damping) x - W H_ll^-1 W' x, landmark by landmark: each chunk has its own y.
void NormalEquations::MultiplyReduced(const double* x, double* y) {
  const Structure& structure = *eliminated_;
  const int num_chunks = structure.num_chunks();
  const std::size_t n = Index(num_poses_scalars_);
  const Hessian H = GetHessian(structure);
  threads_->Run(num_chunks, [&](int chunk) {
    std::vector<double>& product = chunks_[Index(chunk)].product;
    product.assign(n, 0.0);
    MultiplyPoses(H, chunk, num_chunks, x, product.data());
    for (int l = structure.landmark_chunks()[Index(chunk)];
         l < structure.landmark_chunks()[Index(chunk) + 1]; ++l) {
      const kernels::SchurLandmark landmark =
          LandmarkOf(structure, structure.landmarks()[Index(l)], landmarks_,
                     h_ll_factor_.data() + factor_begin_[Index(l)]);
      kernels::Kernels().schur_multiply(&landmark, x, product.data());
    }
    twists_->SubtractProduct(structure, x, chunk, product.data());
  });
  for (std::size_t k = 0; k < n; ++k) {
    double sum = damping_.lambda * DampingOf(damping_, diagonal_[k]) * x[k];
    for (int c = 0; c < num_chunks; ++c)
      sum += chunks_[Index(c)].product[k];
    y[k] = held_[k] != 0 ? x[k] : sum;
  }
}

bool NormalEquations::PoseDiagonal(std::int32_t vertex, double* block) {
  const Hessian H = GetHessian(*eliminated_);
  if (H.num_pairs() != eliminated_->poses().size()) return false;
  const DenseBlock diagonal = H.Diagonal(vertex);
  const std::int32_t offset = H.offset(vertex);
  for (int c = 0; c < diagonal.cols; ++c) {
    const std::size_t scalar = Index(offset + c);
    for (int r = 0; r < diagonal.rows; ++r)
      block[r + c * diagonal.rows] = diagonal.data[r * diagonal.cols + c];
    double& pivot = block[c + c * diagonal.rows];
    pivot = held_[scalar] != 0 ? 1.0 : pivot + DampingAt(scalar);
  }
  return true;
}

}  // namespace glissade
