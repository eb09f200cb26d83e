// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks of one host; see kernels/twists.h.

#ifndef GLISSADE_KERNELS_IMPL_TWISTS_H_
#define GLISSADE_KERNELS_IMPL_TWISTS_H_

#include "kernels/impl/simd.h"
#include "kernels/twists.h"

namespace glissade::kernels {
namespace {

constexpr int kUsedTwistSums = (27 + kW - 1) / kW * kW;

/// Where rows of the targets begin in a panel, after those of the right-hand side and the host.
GLISSADE_INLINE int FirstTargetRow(const TwistGroup& group) {
  return group.dim == 1 ? 7 : 1;
}
/// Rows of a panel.
GLISSADE_INLINE int TwistRows(const TwistGroup& group) {
  return FirstTargetRow(group) + 6 * group.num_targets;
}

/// out = M x, 3 x 3 row-major.
GLISSADE_INLINE void Rotate(const double* M, const vd (&x)[3], vd (&out)[3]) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
    out[i] = Splat(M[3 * i]) * x[0] + (Splat(M[3 * i + 1]) * x[1] + Splat(M[3 * i + 2]) * x[2]);
}

/// [f; p x f - R b].
GLISSADE_INLINE void TwistRow(const TwistFrame& frame, const vd (&f)[3], const vd (&b)[3],
                              vd (&row)[6]) {
  const vd px = Splat(frame.p[0]), py = Splat(frame.p[1]), pz = Splat(frame.p[2]);
  vd Rb[3];
  Rotate(frame.R, b, Rb);
  row[0] = f[0];
  row[1] = f[1];
  row[2] = f[2];
  row[3] = (py * f[2] - pz * f[1]) - Rb[0];
  row[4] = (pz * f[0] - px * f[2]) - Rb[1];
  row[5] = (px * f[1] - py * f[0]) - Rb[2];
}

/// [f; q] of a row in kW lanes, times factor.
GLISSADE_INLINE void TwistOfRow(const TwistRun& run, const TwistFrame& frame, int k, Index s,
                                vd factor, vd (&row)[6]) {
  const double* J = run.J + 6 * Index{k} * run.lanes + s;
  vd a[3], b[3], f[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    a[i] = -(factor * Load(J + i * run.lanes));
    b[i] = factor * Load(J + (3 + i) * run.lanes);
    f[i] = a[i];
  }
  if (frame.turned) Rotate(frame.turn, a, f);
  TwistRow(frame, f, b, row);
}

/// kCount rows in kW lanes, from row `first` on: their part of the sums. Each sum is taken up once
/// for all of them, as there are not registers enough to keep them.
template <int kCount>
GLISSADE_INLINE void AddRows(const TwistRun& run, const TwistFrame& frame, int first, Index s,
                             vd weight, vd factor, vd (&sum)[kUsedTwistSums], vd& h, vd& b,
                             vd (&force)[6]) {
  vd r[kCount], j[kCount], row[kCount][6];
#pragma GCC unroll 2
  for (int k = 0; k < kCount; ++k) {
    const Index at = (first + k) * Index{run.lanes} + s;
    r[k] = weight * Load(run.r + at);
    j[k] = factor * Load(run.J_l + at);
    h += j[k] * j[k];
    b -= j[k] * r[k];
    TwistOfRow(run, frame, first + k, s, factor, row[k]);
  }
  int term = 0;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 2
    for (int k = 0; k < kCount; ++k)
      force[i] += j[k] * row[k][i];
#pragma GCC unroll 6
    for (int m = 0; m <= i; ++m, ++term) {
#pragma GCC unroll 2
      for (int k = 0; k < kCount; ++k)
        sum[term] += row[k][i] * row[k][m];
    }
  }
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 2
    for (int k = 0; k < kCount; ++k)
      sum[21 + i] += r[k] * row[k][i];
  }
}

/// kRows 0: the count is that of the run.
template <int kRows>
int TwistSumsFor(const TwistRun& run, const TwistTotals& to) {
  const Index lanes = run.lanes;
  vd sum[kUsedTwistSums];
#pragma GCC unroll 32
  for (int i = 0; i < kUsedTwistSums; ++i)
    sum[i] = Zero();
  vd poison = Zero();
#pragma GCC unroll 1
  for (Index s = 0; s < lanes; s += kW) {
    const vd weight = run.weight != nullptr ? Load(run.weight + s) : Splat(1.0);
    const vd factor = weight * Splat(run.scale);
    vd h = Zero(), b = Zero();
    vd force[6];
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
      force[i] = Zero();
    if (kRows == 2) {
      AddRows<2>(run, *to.frame, 0, s, weight, factor, sum, h, b, force);
    } else {
#pragma GCC unroll 1
      for (int k = 0; k < run.rows; ++k)
        AddRows<1>(run, *to.frame, k, s, weight, factor, sum, h, b, force);
    }
    poison += Zero() * h;
    Store(to.h + s, Load(to.h + s) + h);
    Store(to.b + s, Load(to.b + s) + b);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double* at = to.force + i * to.force_lanes + s;
      Store(at, to.sets_force ? force[i] : Load(at) + force[i]);
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < kUsedTwistSums; i += kW) {
    const vd total = SumEach(sum + i);
    poison += Zero() * total;
    Store(to.sums + i, Load(to.sums + i) + total);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

/// The landmarks' part alone.
int LandmarkSums(const TwistRun& run, const TwistTotals& to) {
  const Index lanes = run.lanes;
  vd poison = Zero();
  for (Index s = 0; s < lanes; s += kW) {
    const vd weight = run.weight != nullptr ? Load(run.weight + s) : Splat(1.0);
    const vd factor = weight * Splat(run.scale);
    vd h = Load(to.h + s), b = Load(to.b + s);
    for (int k = 0; k < run.rows; ++k) {
      const vd r = weight * Load(run.r + k * lanes + s);
      const vd j = factor * Load(run.J_l + k * lanes + s);
      h += j * j;
      b -= j * r;
    }
    poison += Zero() * (h + b);
    Store(to.h + s, h);
    Store(to.b + s, b);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

int TwistSums(const TwistRun* run, const TwistTotals* to) {
  if (run->J == nullptr) return LandmarkSums(*run, *to);
  return run->rows == 2 ? TwistSumsFor<2>(*run, *to) : TwistSumsFor<0>(*run, *to);
}

/// One column of W per lane: [beta; host; target 0; target 1; ...], scaled. W is d b_pose /
/// d landmark in twists: the host has the sum of the forces, each target minus its own.
void ScalarPanel(const TwistGroup* group, const double* scale, const double* beta, double* W) {
  const int n = TwistRows(*group);
  const Index ld = (n + kPanelRows - 1) / kPanelRows * kPanelRows;
  for (int lane = 0; lane < group->used; lane += kW) {
    double* column = W + lane * ld;
    const vd s = Load(scale + lane);
    vd total[6] = {Zero(), Zero(), Zero(), Zero(), Zero(), Zero()};
    int row = 7;
    for (int k = 0; k < group->num_targets; ++k, row += 6) {
      const TwistTarget& t = group->targets[k];
      if (lane >= t.lanes) break;
      vd w[6];
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        const vd force = s * Load(t.force + static_cast<Index>(i) * t.lanes + lane);
        total[i] += force;
        w[i] = -force;
      }
      StoreSixRows(w, column + row, ld);
    }
    const vd b = Load(beta + lane);
    StoreSixRows(total, column + 1, ld);
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i) {
      column[i * ld] = b[i];
      for (int zero = row; zero % kPanelRows != 0; ++zero)
        column[i * ld + zero] = 0.0;
    }
  }
}

/// z = xi_host - xi_target: what a target's force is multiplied with.
GLISSADE_INLINE void TwistDifference(const double* twists, int target, double (&z)[6]) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    z[i] = twists[i] - twists[6 * (target + 1) + i];
}

/// product = W' xi, with the twists of the host and of each target one after the other.
void ScalarTransposeProduct(const TwistGroup* group, const double* twists, double* product) {
  for (int lane = 0; lane < group->lanes; lane += kW)
    Store(product + lane, Zero());
  for (int k = 0; k < group->num_targets; ++k) {
    const TwistTarget& t = group->targets[k];
    double z[6];
    TwistDifference(twists, k, z);
    for (Index lane = 0; lane < t.lanes; lane += kW) {
      vd sum = Load(product + lane);
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i)
        sum += Load(t.force + i * t.lanes + lane) * Splat(z[i]);
      Store(product + lane, sum);
    }
  }
}

/// sums = W u by frame: 6 numbers for the host, then for each target.
void ScalarProduct(const TwistGroup* group, const double* u, double* sums) {
  for (int i = 0; i < 6; ++i)
    sums[i] = 0.0;
  for (int k = 0; k < group->num_targets; ++k) {
    const TwistTarget& t = group->targets[k];
    double* out = sums + 6 * (k + 1);
    for (int i = 0; i < 6; ++i) {
      vd sum = Zero();
      for (Index lane = 0; lane < t.lanes; lane += kW)
        sum += Load(t.force + i * t.lanes + lane) * Load(u + lane);
      const double total = Sum(sum);
      sums[i] += total;
      out[i] = -total;
    }
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWISTS_H_
