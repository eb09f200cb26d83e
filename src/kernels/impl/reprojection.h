// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Linearization of two-frame inverse-depth reprojections; see kernels/reprojection.h.

#ifndef GLISSADE_KERNELS_IMPL_REPROJECTION_H_
#define GLISSADE_KERNELS_IMPL_REPROJECTION_H_

#include "kernels/impl/simd.h"
#include "kernels/reprojection.h"

namespace glissade::kernels {
namespace {

/// a where mask is not 0, else b.
GLISSADE_INLINE vd Select(vd mask, vd a, vd b) {
  const vi lanes = mask != Zero();
  return reinterpret_cast<vd>((reinterpret_cast<vi>(a) & lanes) |
                              (reinterpret_cast<vi>(b) & ~lanes));
}

/// A point at infinity has no world point; a billionth of a billionth short of it has, and all that
/// is made of it agrees to rounding with the limit.
GLISSADE_INLINE vd AwayFromZero(vd rho) {
  const vd tiny = Splat(1e-30);
  const vi near = (rho < tiny) & (rho > -tiny);
  return reinterpret_cast<vd>((reinterpret_cast<vi>(rho) & ~near) |
                              (reinterpret_cast<vi>(tiny) & near));
}

/// The residual of kW observations, whitened, masked, not yet robustified.
struct Residual {
  vd u, v;       // predicted
  vd inverse_z;  // 1 / Y.z; 0 in lanes without an observation
  vd r0, r1;
  vd l00, l01, l10, l11;
};

GLISSADE_INLINE Residual EvaluateLanes(const ReprojectionHost& host, const ReprojectionTarget& t,
                                       int lane) {
  const vd x = Load(host.x + lane), y = Load(host.y + lane), rho = Load(host.rho + lane);
  const vd mask = Load(t.mask + lane);
  const vd Yx = Splat(t.A[0]) * x + (Splat(t.A[1]) * y + (Splat(t.d[0]) * rho + Splat(t.A[2])));
  const vd Yy = Splat(t.A[3]) * x + (Splat(t.A[4]) * y + (Splat(t.d[1]) * rho + Splat(t.A[5])));
  const vd Yz = Splat(t.A[6]) * x + (Splat(t.A[7]) * y + (Splat(t.d[2]) * rho + Splat(t.A[8])));
  Residual out;
  const vd inverse_z = Splat(1.0) / Select(mask, Yz, Splat(1.0));
  out.inverse_z = inverse_z * mask;
  out.u = Yx * inverse_z;
  out.v = Yy * inverse_z;
  const vd e0 = (out.u - Load(t.u + lane)) * mask;
  const vd e1 = (out.v - Load(t.v + lane)) * mask;
  if (t.sqrt_information != nullptr) {
    const double* l = t.sqrt_information + lane;
    out.l00 = Load(l);
    out.l01 = Load(l + t.lanes);
    out.l10 = Load(l + 2 * t.lanes);
    out.l11 = Load(l + 3 * t.lanes);
  } else {
    out.l00 = Splat(host.L[0]);
    out.l01 = Splat(host.L[1]);
    out.l10 = Splat(host.L[2]);
    out.l11 = Splat(host.L[3]);
  }
  out.r0 = out.l00 * e0 + out.l01 * e1;
  out.r1 = out.l10 * e0 + out.l11 * e1;
  return out;
}

/// Twice the cost of kW residuals under Huber's loss, and the weight rho'(s) of each.
GLISSADE_INLINE vd Huber(vd s, vd width, vd* weight) {
  const vi outside = s > width * width;
  // Inside, the square root is taken of 1 rather than of what may be 0 or denormal.
  const vd root = Sqrt(reinterpret_cast<vd>((reinterpret_cast<vi>(s) & outside) |
                                            (reinterpret_cast<vi>(Splat(1.0)) & ~outside)));
  const vd ratio = width / root;
  *weight = reinterpret_cast<vd>((reinterpret_cast<vi>(ratio) & outside) |
                                 (reinterpret_cast<vi>(Splat(1.0)) & ~outside));
  const vd linear = Splat(2.0) * width * root - width * width;
  return reinterpret_cast<vd>((reinterpret_cast<vi>(linear) & outside) |
                              (reinterpret_cast<vi>(s) & ~outside));
}

double ReprojectionCost(const ReprojectionHost* host) {
  vd cost = Zero();
  for (int k = 0; k < host->num_targets; ++k) {
    const ReprojectionTarget& t = host->targets[k];
    for (int lane = 0; lane < t.lanes; lane += kW) {
      const Residual e = EvaluateLanes(*host, t, lane);
      const vd s = e.r0 * e.r0 + e.r1 * e.r1;
      if (t.huber == nullptr) {
        cost += s;
      } else {
        vd weight;
        cost += Huber(s, Load(t.huber + lane), &weight);
      }
    }
  }
  return 0.5 * Sum(cost);
}

/// World points of all lanes, relative to o.
inline void ComputePoints(const ReprojectionHost& host) {
  const double* R = host.R_wc;
  for (int lane = 0; lane < host.lanes; lane += kW) {
    const vd x = Load(host.x + lane), y = Load(host.y + lane);
    const vd depth = Splat(1.0) / AwayFromZero(Load(host.rho + lane));
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const vd p = Splat(R[3 * i]) * x + (Splat(R[3 * i + 1]) * y + Splat(R[3 * i + 2]));
      Store(host.point + i * host.lanes + lane, p * depth + Splat(host.c[i]));
    }
  }
}

constexpr int kPairTerms = 27;  // 21 of H, 6 of g
constexpr int kPairVectors = (kPairTerms + kW - 1) / kW * kW;

template <bool kRobust>
GLISSADE_INLINE void LinearizeTarget(const ReprojectionHost& host, ReprojectionTarget& t,
                                     vd& cost) {
  vd sum[kPairVectors];
#pragma GCC unroll 32
  for (int i = 0; i < kPairVectors; ++i)
    sum[i] = Zero();
  const double* R = t.R_cw;
#pragma GCC unroll 1
  for (int lane = 0; lane < t.lanes; lane += kW) {
    const Residual e = EvaluateLanes(host, t, lane);
    vd r0 = e.r0, r1 = e.r1;
    const vd s = r0 * r0 + r1 * r1;
    vd scale = Splat(1.0);
    if (kRobust) {
      vd weight;
      cost += Huber(s, Load(t.huber + lane), &weight);
      scale = Sqrt(weight);
      r0 *= scale;
      r1 *= scale;
    } else {
      cost += s;
    }
    // Rows of d(residual)/dY, without the factor 1 / Y.z: L_k = (l_k0, l_k1, -(l_k0 u + l_k1 v)).
    const vd factor = kRobust ? e.inverse_z * scale : e.inverse_z;
    const vd a0 = e.l00 * factor, a1 = e.l01 * factor;
    const vd b0 = e.l10 * factor, b1 = e.l11 * factor;
    const vd a2 = -(a0 * e.u + a1 * e.v);
    const vd b2 = -(b0 * e.u + b1 * e.v);
    const vd j0 = a0 * Splat(t.d[0]) + (a1 * Splat(t.d[1]) + a2 * Splat(t.d[2]));
    const vd j1 = b0 * Splat(t.d[0]) + (b1 * Splat(t.d[1]) + b2 * Splat(t.d[2]));
    Store(host.h + lane, Load(host.h + lane) + (j0 * j0 + j1 * j1));
    Store(host.b + lane, Load(host.b + lane) - (j0 * r0 + j1 * r1));

    // dY/dP = rho R_t': f = rho L R_t' / Y.z.
    const vd rho = AwayFromZero(Load(host.rho + lane));
    vd f0[6], f1[6];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      f0[i] = rho * (a0 * Splat(R[i]) + (a1 * Splat(R[3 + i]) + a2 * Splat(R[6 + i])));
      f1[i] = rho * (b0 * Splat(R[i]) + (b1 * Splat(R[3 + i]) + b2 * Splat(R[6 + i])));
      Store(t.force + i * t.lanes + lane, j0 * f0[i] + j1 * f1[i]);
    }
    const vd px = Load(host.point + lane);
    const vd py = Load(host.point + host.lanes + lane);
    const vd pz = Load(host.point + 2 * host.lanes + lane);
    f0[3] = py * f0[2] - pz * f0[1];
    f0[4] = pz * f0[0] - px * f0[2];
    f0[5] = px * f0[1] - py * f0[0];
    f1[3] = py * f1[2] - pz * f1[1];
    f1[4] = pz * f1[0] - px * f1[2];
    f1[5] = px * f1[1] - py * f1[0];
    int k = 0;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j, ++k)
        sum[k] += f0[i] * f0[j] + f1[i] * f1[j];
    }
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
      sum[21 + i] += r0 * f0[i] + r1 * f1[i];
  }
  double totals[kPairVectors];
#pragma GCC unroll 16
  for (int i = 0; i < kPairVectors; i += kW)
    Store(totals + i, SumEach(sum + i));
  int k = 0;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
    for (int j = 0; j <= i; ++j, ++k)
      t.H[6 * i + j] = t.H[6 * j + i] = totals[k];
  }
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    t.g[i] = totals[21 + i];
}

void ReprojectionLinearize(ReprojectionHost* host) {
  ComputePoints(*host);
  for (int lane = 0; lane < host->lanes; lane += kW) {
    Store(host->h + lane, Zero());
    Store(host->b + lane, Zero());
  }
  vd cost = Zero();
  for (int k = 0; k < host->num_targets; ++k) {
    ReprojectionTarget& t = host->targets[k];
    if (t.huber == nullptr) {
      LinearizeTarget<false>(*host, t, cost);
    } else {
      LinearizeTarget<true>(*host, t, cost);
    }
  }
  host->cost = 0.5 * Sum(cost);
}

/// One column of W per lane: [beta; host; target 0; target 1; ...], scaled. W is d b_pose / d rho
/// in twists: the host has +[F; P x F] summed over targets, each target minus its own. Rows of
/// targets that do not see the lane are left alone.
void ReprojectionPanel(const ReprojectionHost* host, const double* scale, const double* beta,
                       double* W, int ldw) {
  const Index ld = ldw;
  for (int lane = 0; lane < host->lanes; lane += kW) {
    double* column = W + lane * ld;
    const vd s = Load(scale + lane);
    const vd px = Load(host->point + lane);
    const vd py = Load(host->point + host->lanes + lane);
    const vd pz = Load(host->point + 2 * host->lanes + lane);
    vd total[3] = {Zero(), Zero(), Zero()};
    double* row = column + 7;
    for (int k = 0; k < host->num_targets; ++k, row += 6) {
      const ReprojectionTarget& t = host->targets[k];
      if (lane >= t.lanes) break;
      const vd fx = s * Load(t.force + lane);
      const vd fy = s * Load(t.force + t.lanes + lane);
      const vd fz = s * Load(t.force + 2 * t.lanes + lane);
      total[0] += fx;
      total[1] += fy;
      total[2] += fz;
      const vd w[6] = {-fx, -fy, -fz, pz * fy - py * fz, px * fz - pz * fx, py * fx - px * fy};
      StoreSixRows(w, row, ld);
    }
    const vd b = Load(beta + lane);
    const vd w[6] = {total[0],
                     total[1],
                     total[2],
                     py * total[2] - pz * total[1],
                     pz * total[0] - px * total[2],
                     px * total[1] - py * total[0]};
    StoreSixRows(w, column + 1, ld);
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i)
      column[i * ld] = b[i];
  }
}

/// step = (b - W' xi) / h, with the twists of the host and of each target one after the other.
void ReprojectionBackSubstitute(const ReprojectionHost* host, const double* twists,
                                const double* inverse_h, double* step) {
  for (int lane = 0; lane < host->lanes; lane += kW) {
    const vd px = Load(host->point + lane);
    const vd py = Load(host->point + host->lanes + lane);
    const vd pz = Load(host->point + 2 * host->lanes + lane);
    vd rhs = Load(host->b + lane);
    for (int k = 0; k < host->num_targets; ++k) {
      const ReprojectionTarget& t = host->targets[k];
      if (lane >= t.lanes) continue;
      const double* xi = twists + 6 * (k + 1);
      double z[6];
      for (int i = 0; i < 6; ++i)
        z[i] = twists[i] - xi[i];
      const vd wx = Splat(z[3]), wy = Splat(z[4]), wz = Splat(z[5]);
      rhs -= Load(t.force + lane) * (Splat(z[0]) + (wy * pz - wz * py));
      rhs -= Load(t.force + t.lanes + lane) * (Splat(z[1]) + (wz * px - wx * pz));
      rhs -= Load(t.force + 2 * t.lanes + lane) * (Splat(z[2]) + (wx * py - wy * px));
    }
    Store(step + lane, rhs * Load(inverse_h + lane));
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_REPROJECTION_H_
