// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections between two cameras; see kernels/two_view.h.

#ifndef GLISSADE_KERNELS_IMPL_TWO_VIEW_H_
#define GLISSADE_KERNELS_IMPL_TWO_VIEW_H_

#include "kernels/impl/losses.h"
#include "kernels/impl/simd.h"
#include "kernels/two_view.h"

namespace glissade::kernels {
namespace {

/// Host camera in the target's.
struct TwoViewPose {
  double A[9], d[3];
};

inline TwoViewPose HostInTarget(const TwoViewRun& run) {
  TwoViewPose pose;
  const double *R_t = run.target->R_wc, *R_h = run.host->R_wc;
  const double *c_t = run.target->c, *c_h = run.host->c;
  for (int i = 0; i < 3; ++i) {
    pose.d[i] = 0.0;
    for (int k = 0; k < 3; ++k)
      pose.d[i] += R_t[3 * k + i] * (c_h[k] - c_t[k]);
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k)
        sum += R_t[3 * k + i] * R_h[3 * k + j];
      pose.A[3 * i + j] = sum;
    }
  }
  return pose;
}

/// row . (x, y, 1) + d rho.
GLISSADE_INLINE vd Affine(const double* row, double d, vd x, vd y, vd rho) {
  return Splat(row[0]) * x + (Splat(row[1]) * y + (Splat(d) * rho + Splat(row[2])));
}

/// kW points in the target camera; those of lanes that do not count are finite.
struct TwoViewPoint {
  vd u, v, inverse_z, rho;
};

template <bool kMasked>
GLISSADE_INLINE TwoViewPoint ProjectLanes(const TwoViewRun& run, const TwoViewPose& pose, Index s) {
  const Index n = run.lanes;
  TwoViewPoint point;
  point.rho = Load(run.depth + s);
  const vd x = Load(run.uv + s), y = Load(run.uv + n + s);
  vi counts{};
  if (kMasked) {
    counts = Load(run.mask + s) != Zero();
    point.rho = counts ? point.rho : Zero();
  }
  const vd qx = Affine(pose.A, pose.d[0], x, y, point.rho);
  const vd qy = Affine(pose.A + 3, pose.d[1], x, y, point.rho);
  vd qz = Affine(pose.A + 6, pose.d[2], x, y, point.rho);
  if (kMasked) qz = counts ? qz : Splat(1.0);
  point.inverse_z = Splat(1.0) / qz;
  point.u = Rounded(qx * point.inverse_z);
  point.v = Rounded(qy * point.inverse_z);
  return point;
}

template <bool kMasked>
void TwoViewValuesOf(const TwoViewRun& run, const TwoViewValues& values) {
  const TwoViewPose pose = HostInTarget(run);
  const Index n = run.lanes;
  for (Index s = 0; s < n; s += kW) {
    const TwoViewPoint point = ProjectLanes<kMasked>(run, pose, s);
    const vd u = point.u, v = point.v, inverse_z = point.inverse_z;
    Store(values.r + s, u - Load(run.uv + 2 * n + s));
    Store(values.r + n + s, v - Load(run.uv + 3 * n + s));
    if (values.J_l == nullptr) continue;
    // Rows of f: (1, 0, -u) / z and (0, 1, -v) / z.
    const vd fu = -(u * inverse_z), fv = -(v * inverse_z);
    Store(values.J_l + s, inverse_z * Splat(pose.d[0]) + fu * Splat(pose.d[2]));
    Store(values.J_l + n + s, inverse_z * Splat(pose.d[1]) + fv * Splat(pose.d[2]));
    // f x q, in units of z where it cancels: q / z = (u, v, 1).
    const vd one = Splat(1.0);
    const vd minus_rho = -point.rho;
    const vd rows[12] = {minus_rho * inverse_z, Zero(),      minus_rho * fu, u * v,
                         -(one + u * u),        v,           Zero(),         minus_rho * inverse_z,
                         minus_rho * fv,        one + v * v, -(u * v),       -u};
#pragma GCC unroll 12
    for (int k = 0; k < 12; ++k)
      Store(values.J + k * n + s, rows[k]);
  }
}

void TwoViewLanes(const TwoViewRun* run, const TwoViewValues* values) {
  run->mask != nullptr ? TwoViewValuesOf<true>(*run, *values)
                       : TwoViewValuesOf<false>(*run, *values);
}

/// The residual of kW reprojections but for its scale, and rho'(s) scale^2 of each row.
struct TwoViewResidual {
  vd r0, r1, weight0, weight1;
};

/// uv: two arrays of n.
template <bool kMasked, LaneLoss kLoss>
GLISSADE_INLINE TwoViewResidual WeighLanes(const double* uv, Index n, const double* mask,
                                           const TwoViewWeights& weights, vd u, vd v, Index s,
                                           vd* cost) {
  const double* scale = weights.scale;
  TwoViewResidual out;
  out.r0 = u - Load(uv + s);
  out.r1 = v - Load(uv + n + s);
  out.weight0 = Splat(scale[0] * scale[0]);
  out.weight1 = Splat(scale[1] * scale[1]);
  if (kMasked) {
    out.weight0 *= Load(mask + s);
    out.weight1 *= Load(mask + s);
  }
  const vd square = out.weight0 * (out.r0 * out.r0) + out.weight1 * (out.r1 * out.r1);
  if (kLoss == LaneLoss::kNone) {
    *cost += square;
    return out;
  }
  vd weight;
  *cost += LossOf<kLoss>(square, Load(weights.width + s), &weight);
  out.weight0 *= weight;
  out.weight1 *= weight;
  return out;
}

template <bool kMasked, LaneLoss kLoss>
double TwoViewCostOf(const TwoViewRun& run, const TwoViewWeights& weights) {
  const TwoViewPose pose = HostInTarget(run);
  vd cost = Zero();
  for (Index s = 0; s < run.lanes; s += kW) {
    const TwoViewPoint point = ProjectLanes<kMasked>(run, pose, s);
    WeighLanes<kMasked, kLoss>(run.uv + 2 * Index{run.lanes}, run.lanes, run.mask, weights, point.u,
                               point.v, s, &cost);
  }
  return 0.5 * Sum(cost);
}

/// The same bits as the cost that comes with the sums: near an optimum, the minimizer compares the
/// one with the other.
struct TwoViewCostKernel {
  template <bool kMasked, LaneLoss kLoss>
  static double Run(const TwoViewRun& run, const TwoViewWeights& weights) {
    return TwoViewCostOf<kMasked, kLoss>(run, weights);
  }
};

/// Kernel::Run with what the compiler should know of a run.
template <class Kernel, bool kMasked, class Run, class... Args>
auto WithLoss(const Run& run, const TwoViewWeights& weights, Args... args) {
  switch (weights.loss) {
    case LaneLoss::kNone:
      return Kernel::template Run<kMasked, LaneLoss::kNone>(run, weights, args...);
    case LaneLoss::kHuber:
      return Kernel::template Run<kMasked, LaneLoss::kHuber>(run, weights, args...);
    case LaneLoss::kCauchy:
      return Kernel::template Run<kMasked, LaneLoss::kCauchy>(run, weights, args...);
    default:
      return Kernel::template Run<kMasked, LaneLoss::kTukey>(run, weights, args...);
  }
}
template <class Kernel, class Run, class... Args>
auto ForRun(const Run& run, const TwoViewWeights& weights, Args... args) {
  return run.mask != nullptr ? WithLoss<Kernel, true>(run, weights, args...)
                             : WithLoss<Kernel, false>(run, weights, args...);
}

double TwoViewCost(const TwoViewRun* run, const TwoViewWeights* weights) {
  return ForRun<TwoViewCostKernel>(*run, *weights);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWO_VIEW_H_
