// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/losses/loss.h"

namespace glissade::internal {

/// Whitens the rows in `panel` (rows x stride, row-major; columns: J, then r at dims) by L (rows x
/// rows, row-major; null: identity), weighs them by the loss and puts -[J r]'[J r] into `products`
/// (stride x stride): products[c * stride + k] for k >= c. Adds 1/2 rho to the cost.
/// False where something is not finite. `work` is as large as the panel; both are overwritten.
bool SquareRows(int rows, int dims, int stride, const double* L, const Loss& loss, double* panel,
                double* work, double* products, double* cost);

}  // namespace glissade::internal
