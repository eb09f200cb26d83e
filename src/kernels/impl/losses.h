// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Robust losses of kW squared residuals.

#ifndef GLISSADE_KERNELS_IMPL_LOSSES_H_
#define GLISSADE_KERNELS_IMPL_LOSSES_H_

#include "kernels/impl/simd.h"
#include "kernels/losses.h"

namespace glissade::kernels {
namespace {

/// log(1 + x) for x >= 0, infinity and NaN included, to less than an ulp. inverse: 1 / (1 + x).
///
/// u = 1 + x is 2^k m, m in [sqrt(1/2), sqrt(2)). What u was rounded by goes into the result as a
/// correction. With m = 1 + f and t = f / (2 + f), log(m) = 2 t + 2/3 t^3 + 2/5 t^5 + ..., written
/// such that what is rounded is small beside f.
GLISSADE_INLINE vd Log1p(vd x, vd* inverse) {
  const vd one = Splat(1.0), u = one + x;
  *inverse = one / u;
  const vd rounded = x < one ? x - (u - one) : one - (u - x);
  const vd correction = rounded * *inverse;
  constexpr uint64_t kOne = 0x3ff0000000000000, kRootOfHalf = 0x3fe6a09e667f3bcd;
  // Unsigned, so that bits of a NaN may overflow; and the exponent is made a double by putting it
  // under the last bits of 2^52.
  typedef uint64_t vu __attribute__((vector_size(8 * kW)));
  const vu bits = reinterpret_cast<vu>(u) + (kOne - kRootOfHalf);
  const vd biased = reinterpret_cast<vd>((bits >> 52) | 0x4330000000000000);
  const vd k = biased - Splat(0x1p52 + 1023.0);
  const vd f = reinterpret_cast<vd>((bits & 0x000fffffffffffff) + kRootOfHalf) - one;
  const vd t = f / (Splat(2.0) + f), z = t * t;
  vd series = Splat(2.0 / 23.0);
#pragma GCC unroll 10
  for (int odd = 21; odd >= 3; odd -= 2)
    series = series * z + Splat(2.0 / odd);
  const vd half_square = Splat(0.5) * f * f;
  // The first has zeros enough at its end for a product with k to be exact.
  const vd ln2_high = Splat(0x1.62e42feep-1), ln2_low = Splat(0x1.a39ef35793c76p-33);
  const vd low = t * (half_square + z * series) + (k * ln2_low + correction);
  const vd result = k * ln2_high - ((half_square - low) - f);
  return x < Splat(__builtin_inf()) ? result : x;
}

/// rho(s) of a loss, and its weight rho'(s).
GLISSADE_INLINE vd Huber(vd s, vd width, vd* weight) {
  const vi outside = s > width * width;
  // Inside, the square root is taken of 1 rather than of what may be 0 or denormal.
  const vd root = Sqrt(outside ? s : Splat(1.0));
  *weight = outside ? width / root : Splat(1.0);
  return outside ? Splat(2.0) * width * root - width * width : s;
}

GLISSADE_INLINE vd Cauchy(vd s, vd width, vd* weight) {
  const vd square = width * width;
  const vi wide = square == Splat(__builtin_inf());
  vd inverse;
  const vd log = Log1p(s / square, &inverse);
  *weight = inverse;  // 1 where there is no loss, as s / infinity is 0
  return wide ? s : square * log;
}

GLISSADE_INLINE vd Tukey(vd s, vd width, vd* weight) {
  const vd square = width * width;
  const vi wide = square == Splat(__builtin_inf());
  const vi inside = s <= square;
  const vd v = Splat(1.0) - s / square;
  *weight = inside ? v * v : Zero();
  const vd third = square / Splat(3.0);
  const vd loss = inside ? third * (Splat(1.0) - v * v * v) : third;
  return wide ? s : loss;
}

template <LaneLoss kLoss>
GLISSADE_INLINE vd LossOf(vd s, vd width, vd* weight) {
  if (kLoss == LaneLoss::kHuber) return Huber(s, width, weight);
  if (kLoss == LaneLoss::kCauchy) return Cauchy(s, width, weight);
  return Tukey(s, width, weight);
}

template <LaneLoss kLoss>
double LossLanesOf(int lanes, const double* squares, const double* width, double* root) {
  vd cost = Zero();
  for (int lane = 0; lane < lanes; lane += kW) {
    vd weight;
    cost += LossOf<kLoss>(Load(squares + lane), Load(width + lane), &weight);
    Store(root + lane, Sqrt(weight));
  }
  return 0.5 * Sum(cost);
}

double LossLanes(LaneLoss loss, int lanes, const double* squares, const double* width,
                 double* root) {
  if (loss == LaneLoss::kHuber) return LossLanesOf<LaneLoss::kHuber>(lanes, squares, width, root);
  if (loss == LaneLoss::kCauchy) return LossLanesOf<LaneLoss::kCauchy>(lanes, squares, width, root);
  return LossLanesOf<LaneLoss::kTukey>(lanes, squares, width, root);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_LOSSES_H_
