// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/information_root.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade::internal {

namespace {

using internal::Index;

double Cut(int n, double relative_cut) {
  return relative_cut > 0.0 ? relative_cut : 4.0 * n * std::numeric_limits<double>::epsilon();
}

/// 1 / sqrt(H_ii), 0 where H_ii is not positive; false where it is not finite.
bool Scales(int n, const double* A, int lda, std::vector<double>* scale) {
  scale->resize(Index(n));
  for (int i = 0; i < n; ++i) {
    const double h = A[Index(i) * Index(lda) + Index(i)];
    if (!std::isfinite(h)) return false;
    (*scale)[Index(i)] = h > 0.0 ? 1.0 / std::sqrt(h) : 0.0;
  }
  return true;
}

/// The scaled lower triangle with g as row n.
void FillScaled(int n, const double* A, int lda, const std::vector<double>& scale,
                std::vector<double>* block) {
  const std::size_t ld = Index(n) + 1;
  block->resize(ld * ld);
  for (int c = 0; c < n; ++c) {
    const double* from = A + Index(c) * Index(lda);
    double* to = block->data() + Index(c) * ld;
    for (int r = c; r < n; ++r)
      to[r] = scale[Index(r)] * scale[Index(c)] * from[r];
    to[n] = scale[Index(c)] * from[n];
  }
}

/// Cholesky with diagonal pivoting of the scaled triangle, right-looking; its row n takes part as
/// a right-hand side. Returns the rank; order[k] is the variable of pivot k.
int PivotedCholesky(int n, double cut, double* L, std::vector<int>* order) {
  const std::size_t ld = Index(n) + 1;
  const auto at = [&](int row, int col) -> double& { return L[Index(row) + Index(col) * ld]; };
  order->resize(Index(n));
  std::iota(order->begin(), order->end(), 0);
  const auto& axpy = kernels::Kernels().axpy;
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int i = k + 1; i < n; ++i) {
      if (at(i, i) > at(best, best)) best = i;
    }
    if (!(at(best, best) > cut)) return k;
    if (best != k) {
      std::swap((*order)[Index(k)], (*order)[Index(best)]);
      std::swap(at(k, k), at(best, best));
      for (int c = 0; c < k; ++c)
        std::swap(at(k, c), at(best, c));
      for (int i = k + 1; i < best; ++i)
        std::swap(at(i, k), at(best, i));
      for (int r = best + 1; r <= n; ++r)
        std::swap(at(r, k), at(r, best));
    }
    const double root = std::sqrt(at(k, k));
    at(k, k) = root;
    for (int r = k + 1; r <= n; ++r)
      at(r, k) /= root;
    for (int c = k + 1; c < n; ++c)
      axpy(n + 1 - c, -at(c, k), &at(c, k), &at(c, c));
  }
  return n;
}

}  // namespace

int CholeskyRoot(int n, const double* A, int lda, double relative_cut, DenseScratch* scratch,
                 std::vector<double>* r0, std::vector<double>* jacobian, double* constant) {
  const double cut = Cut(n, relative_cut);
  if (!Scales(n, A, lda, &scratch->scale)) return -1;
  const std::vector<double>& scale = scratch->scale;
  std::vector<double>& L = scratch->block;
  FillScaled(n, A, lda, scale, &L);
  scratch->work.resize(Index(n));  // rounding may decide from time to time whether it is needed
  const std::size_t ld = Index(n) + 1;
  const kernels::KernelTable& k = kernels::Kernels();
  std::vector<int>& order = scratch->order;
  bool definite = k.cholesky(n, L.data(), n + 1) == 0;
  for (int i = 0; i < n && definite; ++i) {
    const double pivot = L[Index(i) * ld + Index(i)];
    definite = pivot * pivot > cut;
  }
  int rank = n;
  if (definite) {
    order.resize(Index(n));
    std::iota(order.begin(), order.end(), 0);
    for (int i = 0; i < n; ++i)
      scratch->work[Index(i)] = scale[Index(i)] * A[Index(i) * Index(lda) + Index(n)];
    k.forward_solve(n, L.data(), n + 1, scratch->work.data());
    for (int i = 0; i < n; ++i)
      L[Index(i) * ld + Index(n)] = scratch->work[Index(i)];
  } else {
    FillScaled(n, A, lda, scale, &L);
    rank = PivotedCholesky(n, cut, L.data(), &order);
  }
  jacobian->reserve(Index(n) * Index(n));  // the rank may differ from time to time
  r0->reserve(Index(n));
  jacobian->assign(Index(rank) * Index(n), 0.0);
  r0->resize(Index(rank));
  double squared = 0.0;
  for (int row = 0; row < rank; ++row) {
    double* to = jacobian->data() + Index(row) * Index(n);
    const double* from = L.data() + Index(row) * ld;
    for (int i = row; i < n; ++i) {
      const int v = order[Index(i)];
      to[v] = scale[Index(v)] > 0.0 ? from[i] / scale[Index(v)] : 0.0;
    }
    const double r = from[n];
    (*r0)[Index(row)] = r;
    squared += r * r;
  }
  *constant = A[Index(n) * Index(lda) + Index(n)] - squared;
  return rank;
}

int EigenRoot(int n, const double* A, int lda, double relative_cut, std::vector<double>* r0,
              std::vector<double>* jacobian, double* constant) {
  std::vector<double> scale;
  std::vector<double> block;
  jacobian->clear();
  r0->clear();
  *constant = A[Index(n) * Index(lda) + Index(n)];
  if (n == 0) return 0;
  if (!Scales(n, A, lda, &scale)) return -1;
  FillScaled(n, A, lda, scale, &block);
  const auto ld = static_cast<Eigen::Index>(n) + 1;
  const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> H(block.data(), n, n,
                                                                     Eigen::OuterStride<>(ld));
  const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>> g(block.data() + n, n,
                                                                     Eigen::InnerStride<>(ld));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
  if (eigen.info() != Eigen::Success || !eigen.eigenvalues().allFinite()) return -1;
  const double cut = Cut(n, relative_cut) * (n > 0 ? eigen.eigenvalues()[n - 1] : 0.0);
  int first = 0;
  while (first < n && !(eigen.eigenvalues()[first] > cut && eigen.eigenvalues()[first] > 0.0))
    ++first;
  const int rank = n - first;
  jacobian->assign(Index(rank) * Index(n), 0.0);
  r0->resize(Index(rank));
  double squared = 0.0;
  for (int row = 0; row < rank; ++row) {
    const auto vector = eigen.eigenvectors().col(first + row);
    const double root = std::sqrt(eigen.eigenvalues()[first + row]);
    double* to = jacobian->data() + Index(row) * Index(n);
    for (int i = 0; i < n; ++i)
      to[i] = scale[Index(i)] > 0.0 ? root * vector[i] / scale[Index(i)] : 0.0;
    const double r = vector.dot(g) / root;
    (*r0)[Index(row)] = r;
    squared += r * r;
  }
  *constant = A[Index(n) * Index(lda) + Index(n)] - squared;
  return rank;
}

}  // namespace glissade::internal
