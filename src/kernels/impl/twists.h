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

/// [f; q] of one row in kW lanes; J: its six arrays.
GLISSADE_INLINE void TwistRow(const TwistFrame& frame, const double* J, Index lanes, vd factor,
                              vd (&row)[6]) {
  vd a[3], b[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    a[i] = factor * Load(J + i * lanes);
    b[i] = factor * Load(J + (3 + i) * lanes);
  }
  if (frame.turned) {
    const double* turn = frame.turn;
    vd t[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      t[i] = Splat(turn[3 * i]) * a[0] +
             (Splat(turn[3 * i + 1]) * a[1] + Splat(turn[3 * i + 2]) * a[2]);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      a[i] = t[i];
  }
  const double* R = frame.R;
  const vd px = Splat(frame.p[0]), py = Splat(frame.p[1]), pz = Splat(frame.p[2]);
  const vd moment[3] = {pz * a[1] - py * a[2], px * a[2] - pz * a[0], py * a[0] - px * a[1]};
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    row[i] = -a[i];
    row[3 + i] = moment[i] - (Splat(R[3 * i]) * b[0] +
                              (Splat(R[3 * i + 1]) * b[1] + Splat(R[3 * i + 2]) * b[2]));
  }
}

/// kRows 0: the count is that of the run.
template <int kRows>
int TwistSumsFor(const TwistRun& run) {
  const int rows = kRows > 0 ? kRows : run.rows;
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
#pragma GCC unroll 4
    for (int k = 0; k < rows; ++k) {
      const vd r = weight * Load(run.r + k * lanes + s);
      const vd j = factor * Load(run.J_l + k * lanes + s);
      h += j * j;
      b -= j * r;
      vd row[6];
      TwistRow(*run.frame, run.J + 6 * k * lanes + s, lanes, factor, row);
      int term = 0;
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        force[i] += j * row[i];
#pragma GCC unroll 6
        for (int m = 0; m <= i; ++m, ++term)
          sum[term] += row[i] * row[m];
      }
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i)
        sum[21 + i] += r * row[i];
    }
    poison += Zero() * h;
    Store(run.h + s, Load(run.h + s) + h);
    Store(run.b + s, Load(run.b + s) + b);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double* to = run.force + i * run.force_lanes + s;
      Store(to, run.sets_force ? force[i] : Load(to) + force[i]);
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < kUsedTwistSums; i += kW) {
    const vd total = SumEach(sum + i);
    poison += Zero() * total;
    Store(run.sums + i, Load(run.sums + i) + total);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

/// The landmarks' part alone.
int LandmarkSums(const TwistRun& run) {
  const Index lanes = run.lanes;
  vd poison = Zero();
  for (Index s = 0; s < lanes; s += kW) {
    const vd weight = run.weight != nullptr ? Load(run.weight + s) : Splat(1.0);
    const vd factor = weight * Splat(run.scale);
    vd h = Load(run.h + s), b = Load(run.b + s);
    for (int k = 0; k < run.rows; ++k) {
      const vd r = weight * Load(run.r + k * lanes + s);
      const vd j = factor * Load(run.J_l + k * lanes + s);
      h += j * j;
      b -= j * r;
    }
    poison += Zero() * (h + b);
    Store(run.h + s, h);
    Store(run.b + s, b);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

int TwistSums(const TwistRun* run) {
  if (run->J == nullptr) return LandmarkSums(*run);
  return run->rows == 2 ? TwistSumsFor<2>(*run) : TwistSumsFor<0>(*run);
}

/// One column of W per lane: [beta; host; target 0; target 1; ...], scaled. W is d b_pose /
/// d landmark in twists: the host has the sum of the forces, each target minus its own. Rows of
/// targets that do not see the lane are left alone.
void TwistPanel(const TwistGroup* group, const double* scale, const double* beta, double* W,
                int ldw) {
  const Index ld = ldw;
  for (int lane = 0; lane < group->lanes; lane += kW) {
    double* column = W + lane * ld;
    const vd s = Load(scale + lane);
    vd total[6] = {Zero(), Zero(), Zero(), Zero(), Zero(), Zero()};
    double* row = column + 7;
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
      StoreSixRows(w, row, ld);
    }
    const vd b = Load(beta + lane);
    StoreSixRows(total, column + 1, ld);
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i)
      column[i * ld] = b[i];
  }
}

/// z = xi_host - xi_target: what a target's force is multiplied with.
GLISSADE_INLINE void TwistDifference(const double* twists, int target, double (&z)[6]) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    z[i] = twists[i] - twists[6 * (target + 1) + i];
}

/// product = W' xi, with the twists of the host and of each target one after the other.
void TwistTransposeProduct(const TwistGroup* group, const double* twists, double* product) {
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
void TwistProduct(const TwistGroup* group, const double* u, double* sums) {
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
