// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/graph/fix.h"

namespace glissade {

/// x <- P'x for the part x of a vector or matrix that belongs to a partly fixed vertex: E'x, then
/// zeros where a coordinate is held.
inline void Project(const FreeTangent& tangent, double* x, int stride) {
  double free[FreeTangent::kMaxTangentDim] = {};
  for (int c = 0; c < tangent.free_dim; ++c) {
    for (int r = 0; r < tangent.tangent_dim; ++r) {
      free[c] += tangent.basis[r * tangent.free_dim + c] * x[r * stride];
    }
  }
  for (int k = 0; k < tangent.tangent_dim; ++k)
    x[k * stride] = free[k];
}

}  // namespace glissade
