// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include "glissade/glissade.h"
#include "support/graph_random.h"

namespace glissade::test {

/// Numbers, poses, weights and options as somebody might pass them: mostly sound, now and then from
/// the far ends of double.
class NastyValues : public GraphRandom {
 public:
  using GraphRandom::GraphRandom;

  double Number() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    constexpr double kNasty[] = {0.0,
                                 -0.0,
                                 1.0,
                                 -1.0,
                                 2.0,
                                 1e-3,
                                 1e-16,
                                 1e-160,
                                 std::numeric_limits<double>::min(),
                                 5e-324,
                                 1e10,
                                 -1e16,
                                 1e154,
                                 -1e160,
                                 1e300,
                                 -std::numeric_limits<double>::max(),
                                 std::numeric_limits<double>::quiet_NaN(),
                                 kInf,
                                 -kInf};
    if (!Chance(nasty)) return Uniform(-1.0, 1.0);
    return kNasty[Int(static_cast<int>(std::size(kNasty)))];
  }
  void Fill(double* x, int n) {
    for (int k = 0; k < n; ++k)
      x[k] = Number();
  }
  Pose AnyPose() {
    Pose pose(Rotation(1.0), Vector3::Zero());
    Fill(pose.data, 3);
    if (Chance(nasty)) Fill(pose.data + 3, 4);
    if (Chance(nasty)) {
      const double scale = Number();
      for (int k = 3; k < 7; ++k)
        pose.data[k] *= scale;
    }
    return pose;
  }
  template <VertexType V>
  V AnyVertexValue() {
    V value;
    if constexpr (requires { value.pose; }) {
      value.pose = AnyPose();
    } else {
      Fill(value.Data(), V::kAmbientDim);
    }
    return value;
  }
  Loss AnyLoss() {
    switch (Int(5)) {
      case 0:
        return Huber{Number()};
      case 1:
        return Cauchy{Number()};
      case 2:
        return Tukey{Number()};
      default:
        return {};
    }
  }
  /// Diagonal, now and then with something beside it.
  template <int N>
  SquareMatrix<N> AnyInformation() {
    SquareMatrix<N> m = SquareMatrix<N>::Identity();
    for (int k = 0; k < N; ++k)
      m(k, k) = Chance(nasty) ? Number() : Uniform(0.1, 10.0);
    if (Chance(nasty)) m(0, N - 1) = Number();
    return m;
  }

  double nasty = 0.08;  ///< how often
};

/// What a graph must take as a state, said apart from the library.
inline bool IsState(const TypeInfo* type, const double* x, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    if (!std::isfinite(x[k])) return false;
  }
  if (type != &kTypeInfo<VertexPose>) return true;
  const double norm = std::hypot(std::hypot(x[3], x[4]), std::hypot(x[5], x[6]));
  return std::abs(norm - 1.0) < 1e-6;
}

inline bool AllDifferent(const std::vector<AnyVertex>& handles) {
  return std::all_of(handles.begin(), handles.end(), [&](const AnyVertex& handle) {
    return std::count(handles.begin(), handles.end(), handle) == 1;
  });
}

inline bool AllFinite(const std::vector<double>& x) {
  for (const double value : x) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace glissade::test
