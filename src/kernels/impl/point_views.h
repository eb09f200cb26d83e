// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points in the world seen by ideal cameras, from measurements to their sums in one pass; see
// kernels/points.h.

#ifndef GLISSADE_KERNELS_IMPL_POINT_VIEWS_H_
#define GLISSADE_KERNELS_IMPL_POINT_VIEWS_H_

#include "kernels/impl/points.h"
#include "kernels/impl/two_view.h"

namespace glissade::kernels {
namespace {

/// kW observations: where they are seen, and their residuals. Of lanes that do not count finite,
/// with a weight of 0.
struct PointView {
  vd u, v, inverse_z;
  TwoViewResidual residual;
};

template <bool kMasked, LaneLoss kLoss>
GLISSADE_INLINE PointView ViewLanes(const PointViewRun& run, const TwoViewWeights& weights, Index s,
                                    vd* cost) {
  const double *R = run.camera->R_wc, *c = run.camera->c;
  vd d[3], q[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
    d[i] = Load(run.X + i * run.x_stride + s) - Splat(c[i]);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
    q[i] = Splat(R[i]) * d[0] + (Splat(R[3 + i]) * d[1] + Splat(R[6 + i]) * d[2]);
  if (kMasked) {
    const vi counts = Load(run.mask + s) != Zero();
    q[0] = counts ? q[0] : Zero();
    q[1] = counts ? q[1] : Zero();
    q[2] = counts ? q[2] : Splat(1.0);
  }
  PointView view;
  view.inverse_z = Splat(1.0) / q[2];
  view.u = Rounded(q[0] * view.inverse_z);
  view.v = Rounded(q[1] * view.inverse_z);
  view.residual =
      WeighLanes<kMasked, kLoss>(run.uv, run.lanes, run.mask, weights, view.u, view.v, s, cost);
  return view;
}

template <bool kMasked, LaneLoss kLoss>
int PointViewSumsOf(const PointViewRun& run, const TwoViewWeights& weights, const PointTotals& to,
                    double* cost) {
  const double* R = to.turn;
  vd squares = Zero(), poison = Zero();
#pragma GCC unroll 1
  for (Index s = 0; s < run.lanes; s += kW) {
    const PointView view = ViewLanes<kMasked, kLoss>(run, weights, s, &squares);
    const TwoViewResidual& residual = view.residual;
    // Rows of f but for 1 / z, turned.
    vd row[2][3], scaled[2][3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      row[0][i] = Splat(R[3 * i]) - view.u * Splat(R[3 * i + 2]);
      row[1][i] = Splat(R[3 * i + 1]) - view.v * Splat(R[3 * i + 2]);
    }
    const vd w0 = residual.weight0 * view.inverse_z, w1 = residual.weight1 * view.inverse_z;
    const vd a0 = w0 * view.inverse_z, a1 = w1 * view.inverse_z;
    const vd r[2] = {w0 * residual.r0, w1 * residual.r1};
    vd F[6], g[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      scaled[0][i] = a0 * row[0][i];
      scaled[1][i] = a1 * row[1][i];
      g[i] = -(r[0] * row[0][i] + r[1] * row[1][i]);
#pragma GCC unroll 3
      for (int j = 0; j <= i; ++j)
        F[Lower(i, j)] = scaled[0][i] * row[0][j] + scaled[1][i] * row[1][j];
    }
    poison += Zero() * ((F[0] + F[2] + F[5]) + (g[0] + g[1] + g[2]));
    StoreArrays(F, to.sets, to.stride, to.F + s);
    StoreArrays(g, to.sets, to.stride, to.g + s);
  }
  *cost = 0.5 * Sum(squares);
  return Sum(poison + Zero() * squares) == 0.0 ? 1 : 0;
}

struct PointViewSumsKernel {
  template <bool kMasked, LaneLoss kLoss>
  static int Run(const PointViewRun& run, const TwoViewWeights& weights, const PointTotals* to,
                 double* cost) {
    return PointViewSumsOf<kMasked, kLoss>(run, weights, *to, cost);
  }
};

/// The same bits as the cost that comes with the sums.
struct PointViewCostKernel {
  template <bool kMasked, LaneLoss kLoss>
  static double Run(const PointViewRun& run, const TwoViewWeights& weights) {
    vd cost = Zero();
    for (Index s = 0; s < run.lanes; s += kW)
      ViewLanes<kMasked, kLoss>(run, weights, s, &cost);
    return 0.5 * Sum(cost);
  }
};

int PointViewSums(const PointViewRun* run, const TwoViewWeights* weights, const PointTotals* to,
                  double* cost) {
  return ForRun<PointViewSumsKernel>(*run, *weights, to, cost);
}

double PointViewCost(const PointViewRun* run, const TwoViewWeights* weights) {
  return ForRun<PointViewCostKernel>(*run, *weights);
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_POINT_VIEWS_H_
