// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/threaded_cholesky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {

/// Below that all of the matrix is in the second-level cache.
constexpr int kLarge = 448;
/// Multiply-adds of an update below which handing out parts costs more than it saves.
constexpr double kWorthwhile = 1e6;
constexpr int kPartsPerThread = 4;

/// S -= W W', lower triangle, in strips of columns of about equal work.
void Update(int n, int k, const double* w, double* s, int lda, ThreadPool* threads,
            std::vector<double>* scratch) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const bool shares =
      threads != nullptr && threads->num_threads() > 1 && 0.5 * n * n * k >= kWorthwhile;
  if (n < kLarge && !shares) return kernel.syrk_lower_sub(n, k, w, lda, s, lda);
  const std::int64_t rows =
      (n + kernels::kPackedRows - 1) / kernels::kPackedRows * std::int64_t{kernels::kPackedRows};
  // As many columns at a time as syrk_lower_sub takes, which does the same for smaller n; of wide
  // panels, which have large n alone, all.
  const int depth = k == kernels::kWidePanel ? k : kernels::kUpdateDepth;
  scratch->resize(std::max(scratch->size(), internal::Index(rows * std::min(k, depth))));
  const int parts = shares ? kPartsPerThread * threads->num_threads() : 1;
  // A triangle of which the part of [0, c) of the columns is 1 - (1 - c / n)^2.
  const auto cut = [&](int part) {
    if (part == parts) return n;
    const double share = static_cast<double>(part) / parts;
    const int column = static_cast<int>(n * (1.0 - std::sqrt(1.0 - share)));
    return column - column % kernels::kColumnBlock;
  };
  for (int first = 0; first < k; first += depth) {
    const int columns = std::min(depth, k - first);
    kernel.pack_rows(n, columns, w + static_cast<std::ptrdiff_t>(first) * lda, lda,
                     scratch->data());
    const auto update = [&](int part) {
      const int begin = cut(part), end = cut(part + 1);
      if (begin < end) kernel.syrk_packed_sub(n, columns, scratch->data(), s, lda, begin, end);
    };
    if (shares) {
      threads->Run(parts, [&](int part) { update(part); });
    } else {
      update(0);
    }
  }
}

}  // namespace

int ThreadedCholesky(int n, int nb, double* a, int lda, ThreadPool* threads,
                     std::vector<double>* scratch) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const bool alone = threads == nullptr || threads->num_threads() == 1;
  if (alone && n < kLarge) return kernel.cholesky_partial(n, nb, a, lda);
  for (int j = 0; j < nb;) {
    const int columns = kernels::CholeskyPanelColumns(nb - j);
    double* const panel = a + j + static_cast<std::ptrdiff_t>(j) * lda;
    const int info = kernel.cholesky_panel(n - j, columns, panel, lda);
    if (info != 0) return j + info;
    j += columns;
    if (j == n) break;
    double* const rest = a + j + static_cast<std::ptrdiff_t>(j) * lda;
    Update(n - j, columns, panel + columns, rest, lda, threads, scratch);
  }
  return 0;
}

}  // namespace glissade
