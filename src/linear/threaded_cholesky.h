// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/thread_pool.h"

namespace glissade {

/// kernels::KernelTable::cholesky_partial (of a whole matrix where nb == n), shared out among
/// threads where that pays. The same bits for any number of threads; null: the caller alone.
/// Returns 0, or 1 + index of the pivot that is not positive. scratch: kept from call to call, used
/// for large matrices.
int ThreadedCholesky(int n, int nb, double* a, int lda, ThreadPool* threads,
                     std::vector<double>* scratch);

}  // namespace glissade
