// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/random_states.h"
#include "glissade/base/matrix.h"

namespace glissade::test {

/// Random plus what random graphs need on top.
class GraphRandom : public Random {
 public:
  using Random::Random;

  /// In [0, n).
  int Int(int n) {
    const int i = static_cast<int>(Uniform(0.0, n));
    return i < n ? i : n - 1;
  }
  bool Chance(double probability) { return Uniform(0.0, 1.0) < probability; }

  /// Standard normal to within 6 sigma, by the sum of twelve (Irwin-Hall): no library function, so
  /// that the values are the same everywhere.
  double Normal() {
    double sum = -6.0;
    for (int k = 0; k < 12; ++k)
      sum += Uniform(0.0, 1.0);
    return sum;
  }
  template <int N>
  Vector<N> NormalVector(double sigma) {
    Vector<N> v;
    for (int i = 0; i < N; ++i)
      v[i] = sigma * Normal();
    return v;
  }
  template <int N>
  SquareMatrix<N> NormalMatrix() {
    SquareMatrix<N> m;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j)
        m(i, j) = Normal();
    }
    return m;
  }
  /// Symmetric positive definite, eigenvalues of some tenths to a few.
  template <int N>
  SquareMatrix<N> Spd() {
    const SquareMatrix<N> a = NormalMatrix<N>();
    SquareMatrix<N> spd = a * a.transpose() / N;
    spd.diagonal().array() += 0.3;
    return spd;
  }
  /// The pose moved by a random step of its tangent.
  Pose Perturb(const Pose& pose, double sigma_p, double sigma_theta) {
    const Quaternion q = pose.q() * so3::ExpQuaternion(NormalVector<3>(sigma_theta));
    Pose moved(q, pose.p() + NormalVector<3>(sigma_p));
    moved.Normalize();
    return moved;
  }
};

}  // namespace glissade::test
