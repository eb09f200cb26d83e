// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What reprojections between two cameras add to the sums of kernels/twists.h, in one pass: their
// values need not be written down where weights are but factors.
//
// In the axes of the target camera, about its center, rows are, with g = rho / z,
//     [f; q]_u = [g, 0, -g u; -u v, 1 + u^2, -v],   [f; q]_v = [0, g, -g v; -(1 + v^2), u v, u].
// Of the 21 sums over [f; q][f; q]' two are zero and two are others' there, and what they are made
// of is shared: so they are taken there, and turned to the common frame when they are done.

#ifndef GLISSADE_KERNELS_IMPL_TWO_VIEW_SUMS_H_
#define GLISSADE_KERNELS_IMPL_TWO_VIEW_SUMS_H_

#include "kernels/impl/two_view.h"
#include "kernels/impl/two_view_row.h"
#include "kernels/twists.h"

namespace glissade::kernels {
namespace {

/// In the camera's axes: F = sum f f', M = sum f q', Q = sum q q' of both rows, and sum r [f; q].
enum TwoViewSum {
  kF00,  // and F11; F01 = 0
  kMinusF02,
  kMinusF12,
  kF22,
  kMinusM00,  // and M11
  kM01,
  kMinusM02,
  kMinusM10,
  kM12,
  kM20,
  kMinusM21,  // M22 = 0
  kQ00,
  kMinusQ10,
  kQ11,
  kMinusQ20,
  kMinusQ21,
  kQ22,
  kRf0,
  kRf1,
  kMinusRf2,
  kMinusRq0,
  kRq1,
  kRq2,
  kTwoViewSums
};
constexpr int kTwoViewVectors = (kTwoViewSums + kW - 1) / kW * kW;

/// Rows of a 3 x 3, the fourth number is anything.
struct Rows3 {
  v4 row[3];
};

GLISSADE_INLINE v4 Row3(double a, double b, double c) {
  return v4{a, b, c, c};
}
/// (a, b, c) B.
GLISSADE_INLINE v4 Times3(double a, double b, double c, const Rows3& B) {
  return B.row[0] * a + (B.row[1] * b + B.row[2] * c);
}
GLISSADE_INLINE v4 Cross3(const v4& a, const v4& b) {
  const v4i yzx{1, 2, 0, 3}, zxy{2, 0, 1, 3};
  return __builtin_shuffle(a, yzx) * __builtin_shuffle(b, zxy) -
         __builtin_shuffle(a, zxy) * __builtin_shuffle(b, yzx);
}

/// Adds the camera's sums to those of the common frame, in which f is R f and q is R q + p x R f.
GLISSADE_INLINE void TurnSums(const TwistFrame& frame, const double* x, double* sums) {
  const double *R = frame.R, *p = frame.p;
  const v4 pv = Row3(p[0], p[1], p[2]);
  const Rows3 Rt{{Row3(R[0], R[3], R[6]), Row3(R[1], R[4], R[7]), Row3(R[2], R[5], R[8])}};
  // F = F00 I + e_z y' + y e_z'.
  const double f00 = x[kF00];
  const v4 Ry = Times3(-x[kMinusF02], -x[kMinusF12], 0.5 * (x[kF22] - f00), Rt);
  Rows3 F;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const v4 unit = Row3(i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0);
    F.row[i] = Rt.row[2] * Ry[i] + (Ry * R[3 * i + 2] + unit * f00);
  }
  // By rows of q: R M' R' and R Q R'.
  const Rows3 MR{{Times3(-x[kMinusM00], -x[kMinusM10], x[kM20], Rt),
                  Times3(x[kM01], x[kMinusM00], -x[kMinusM21], Rt),
                  Rt.row[0] * -x[kMinusM02] + Rt.row[1] * x[kM12]}};
  const Rows3 QR{{Times3(x[kQ00], -x[kMinusQ10], -x[kMinusQ20], Rt),
                  Times3(-x[kMinusQ10], x[kQ11], -x[kMinusQ21], Rt),
                  Times3(-x[kMinusQ20], -x[kMinusQ21], x[kQ22], Rt)}};
  // With P = [p]x: sum q f' = R M' R' + P F, and sum q q' = R Q R' + K + K',
  // K = (R M' R' + P F / 2) P'.
  const Rows3 PF{{F.row[2] * p[1] - F.row[1] * p[2], F.row[0] * p[2] - F.row[2] * p[0],
                  F.row[1] * p[0] - F.row[0] * p[1]}};
  double f[12], m[12], q[12], k[12];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const v4 N = Times3(R[3 * i], R[3 * i + 1], R[3 * i + 2], MR);
    Store4(f + 4 * i, F.row[i]);
    Store4(m + 4 * i, N + PF.row[i]);
    Store4(q + 4 * i, Times3(R[3 * i], R[3 * i + 1], R[3 * i + 2], QR));
    Store4(k + 4 * i, Cross3(pv, N + 0.5 * PF.row[i]));
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
    for (int j = 0; j <= i; ++j)
      *sums++ += f[4 * i + j];
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
      *sums++ += m[4 * i + j];
#pragma GCC unroll 3
    for (int j = 0; j <= i; ++j)
      *sums++ += q[4 * i + j] + (k[4 * i + j] + k[4 * j + i]);
  }
  // r [f; q].
  const v4 Rf = Times3(x[kRf0], x[kRf1], -x[kMinusRf2], Rt);
  const v4 Rq = Times3(-x[kMinusRq0], x[kRq1], x[kRq2], Rt) + Cross3(pv, Rf);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    sums[i] += Rf[i];
    sums[3 + i] += Rq[i];
  }
}

/// Landmarks and forces of lanes [begin, end).
template <bool kMasked, LaneLoss kLoss>
GLISSADE_INLINE void AddForces(const TwoViewRun& run, const TwoViewWeights& weights,
                               const TwoViewPose& pose, const TwistTotals& to, Index begin,
                               Index end, vd& squares, vd& poison, TwoViewScratch& out) {
  const TwistFrame& frame = *to.frame;
#pragma GCC unroll 1
  for (Index s = begin; s < end; s += kW) {
    const TwoViewPoint point = ProjectLanes<kMasked>(run, pose, s);
    const vd u = point.u, v = point.v, inverse_z = point.inverse_z;
    const TwoViewResidual residual = WeighLanes<kMasked, kLoss>(
        run.uv + 2 * Index{run.lanes}, run.lanes, run.mask, weights, u, v, s, &squares);
    const vd w = residual.weight0, r0 = residual.r0, r1 = residual.r1;
    const vd g = inverse_z * point.rho;
    const Index at = s - begin;
    Store(out.u + at, u);
    Store(out.v + at, v);
    Store(out.g + at, g);
    Store(out.w + at, w);
    Store(out.r0 + at, r0);
    Store(out.r1 + at, r1);
    // By rho.
    const vd j0 = inverse_z * (Splat(pose.d[0]) - u * Splat(pose.d[2]));
    const vd j1 = inverse_z * (Splat(pose.d[1]) - v * Splat(pose.d[2]));
    const vd wj0 = w * j0, wj1 = residual.weight1 * j1;
    const vd h = wj0 * j0 + wj1 * j1;
    poison += Zero() * h;
    Store(to.h + s, Load(to.h + s) + h);
    Store(to.b + s, Load(to.b + s) - (wj0 * r0 + wj1 * r1));
    // w j [f; q].
    const vd k = u * wj0 + v * wj1;
    const vd f[3] = {g * wj0, g * wj1, -(g * k)};
    const vd q[3] = {-(wj1 + v * k), wj0 + u * k, u * wj1 - v * wj0};
    vd force[6], m[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const vd R0 = Splat(frame.R[3 * i]), R1 = Splat(frame.R[3 * i + 1]),
               R2 = Splat(frame.R[3 * i + 2]);
      force[i] = R0 * f[0] + (R1 * f[1] + R2 * f[2]);
      m[i] = R0 * q[0] + (R1 * q[1] + R2 * q[2]);
    }
    const vd px = Splat(frame.p[0]), py = Splat(frame.p[1]), pz = Splat(frame.p[2]);
    force[3] = m[0] + (py * force[2] - pz * force[1]);
    force[4] = m[1] + (pz * force[0] - px * force[2]);
    force[5] = m[2] + (px * force[1] - py * force[0]);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double* to_force = to.force + i * to.force_lanes + s;
      Store(to_force, to.sets_force ? force[i] : Load(to_force) + force[i]);
    }
  }
}

GLISSADE_INLINE void AddTwoViewSums(const TwoViewScratch& from, Index lanes,
                                    vd (&sum)[kTwoViewVectors]) {
  const vd one = Splat(1.0);
#pragma GCC unroll 1
  for (Index s = 0; s < lanes; s += kW) {
    const vd u = Load(from.u + s), v = Load(from.v + s), w = Load(from.w + s);
    const vd g = Load(from.g + s), r0 = Load(from.r0 + s), r1 = Load(from.r1 + s);
    const vd wu = w * u, wv = w * v, e = w * g;
    sum[kMinusQ20] += wu;
    sum[kMinusQ21] += wv;
    const vd square = u * u + v * v, t = one + square;
    sum[kQ22] += w * square;
    const vd a = e * g;
    sum[kF00] += a;
    sum[kMinusF02] += a * u;
    sum[kMinusF12] += a * v;
    sum[kF22] += a * square;
    // r [f; q].
    const vd d = u * r0 + v * r1;
    sum[kRf0] += e * r0;
    sum[kRf1] += e * r1;
    sum[kMinusRf2] += e * d;
    sum[kMinusRq0] += w * (r1 + v * d);
    sum[kRq1] += w * (r0 + u * d);
    sum[kRq2] += wu * r1 - wv * r0;
    const vd eu = e * u, ev = e * v;
    sum[kM12] += eu;
    sum[kMinusM02] += ev;
    sum[kMinusM00] += eu * v;
    sum[kM20] += ev * t;
    sum[kMinusM21] += eu * t;
    const vd uu = one + u * u, vv = one + v * v;
    sum[kM01] += e * uu;
    sum[kMinusM10] += e * vv;
    const vd uv = u * v, wuv = wu * v;
    sum[kMinusQ10] += wuv * (one + t);
    sum[kQ00] += wuv * uv + (w * vv) * vv;
    sum[kQ11] += wuv * uv + (w * uu) * uu;
  }
}

template <bool kMasked, LaneLoss kLoss>
int TwoViewSumsOf(const TwoViewRun& run, const TwoViewWeights& weights, const TwistTotals& to,
                  double* cost) {
  const TwoViewPose pose = HostInTarget(run);
  TwoViewScratch scratch;
  vd sum[kTwoViewVectors];
#pragma GCC unroll 32
  for (int i = 0; i < kTwoViewVectors; ++i)
    sum[i] = Zero();
  vd squares = Zero(), poison = Zero();
  // Both rows have the weight of the first in the sums; what that leaves out of the second's is
  // added by itself.
  const bool by_row = weights.scale[0] != weights.scale[1];
  vd row[kRowVectors];
#pragma GCC unroll 32
  for (int i = 0; i < kRowVectors; ++i)
    row[i] = Zero();
  for (Index begin = 0; begin < run.lanes; begin += TwoViewScratch::kLanes) {
    const Index end = Min<Index>(begin + TwoViewScratch::kLanes, run.lanes);
    AddForces<kMasked, kLoss>(run, weights, pose, to, begin, end, squares, poison, scratch);
    AddTwoViewSums(scratch, end - begin, sum);
    if (by_row) AddRowSums(scratch, end - begin, row);
  }
  double totals[kTwoViewVectors];
#pragma GCC unroll 16
  for (int i = 0; i < kTwoViewVectors; i += kW) {
    const vd total = SumEach(sum + i);
    poison += Zero() * total;
    Store(totals + i, total);
  }
  TurnSums(*to.frame, totals, to.sums);
  if (by_row) {
    double of_row[kRowVectors];
    for (int i = 0; i < kRowVectors; i += kW)
      Store(of_row + i, SumEach(row + i));
    const double ratio = weights.scale[1] / weights.scale[0];
    TurnRowSums(*to.frame, of_row, ratio * ratio - 1.0, to.sums);
  }
  *cost = 0.5 * Sum(squares);
  return Sum(poison + Zero() * squares) == 0.0 ? 1 : 0;
}

struct TwoViewSumsKernel {
  template <bool kMasked, LaneLoss kLoss>
  static int Run(const TwoViewRun& run, const TwoViewWeights& weights, const TwistTotals* to,
                 double* cost) {
    return TwoViewSumsOf<kMasked, kLoss>(run, weights, *to, cost);
  }
};

int TwoViewSums(const TwoViewRun* run, const TwoViewWeights* weights, const TwistTotals* to,
                double* cost) {
  return ForRun<TwoViewSumsKernel>(*run, *weights, to, cost);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWO_VIEW_SUMS_H_
