// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/wide_rows.h"

#include "glissade/graph/robust.h"
#include "kernels/kernels.h"

namespace glissade::internal {

namespace {
/// J <- the corrected Jacobian, r <- the corrected residual.
void Robustify(const RobustScale& scale, int rows, int dims, int stride, double* panel) {
  for (int c = 0; c < dims; ++c) {
    double projection = 0.0;
    for (int k = 0; k < rows; ++k)
      projection += panel[k * stride + dims] * panel[k * stride + c];
    for (int k = 0; k < rows; ++k) {
      double* row = panel + k * stride;
      row[c] = scale.jacobian_scale * (row[c] - scale.alpha_over_s * projection * row[dims]);
    }
  }
  for (int k = 0; k < rows; ++k)
    panel[k * stride + dims] *= scale.residual_scale;
}
}  // namespace

bool SquareRows(int rows, int dims, int stride, const double* L, const Loss& loss, double* panel,
                double* work, double* products, double* cost) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  if (L != nullptr) kernel.left_multiply(rows, L, panel, work, stride);
  double* const whitened = L != nullptr ? work : panel;
  if (!loss.trivial()) {
    double s = 0.0;
    for (int k = 0; k < rows; ++k)
      s += whitened[k * stride + dims] * whitened[k * stride + dims];
    const RobustScale scale(loss, s);
    *cost += scale.cost;
    Robustify(scale, rows, dims, stride, whitened);
  }
  // Row-major rows are the columns of [J r]'.
  kernel.syrk_lower_set_negative(dims + 1, rows, whitened, stride, products, stride);
  if (loss.trivial()) *cost -= 0.5 * products[dims * stride + dims];
  // What is not finite in J or r is not finite on the diagonal of the products.
  double poison = 0.0 * *cost;
  for (int c = 0; c <= dims; ++c)
    poison += 0.0 * products[c * stride + c];
  return poison == 0.0;
}

}  // namespace glissade::internal
