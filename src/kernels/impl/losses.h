// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Robust losses of kW squared residuals.

#ifndef GLISSADE_KERNELS_IMPL_LOSSES_H_
#define GLISSADE_KERNELS_IMPL_LOSSES_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

/// Huber's loss rho(s), and its weight rho'(s).
GLISSADE_INLINE vd Huber(vd s, vd width, vd* weight) {
  const vi outside = s > width * width;
  // Inside, the square root is taken of 1 rather than of what may be 0 or denormal.
  const vd root = Sqrt(outside ? s : Splat(1.0));
  *weight = outside ? width / root : Splat(1.0);
  return outside ? Splat(2.0) * width * root - width * width : s;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_LOSSES_H_
