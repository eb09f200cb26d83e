// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstring>

#include "glissade/base/small_matrix.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/concept.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"

namespace glissade {

/// A vertex as an edge sees it whose Evaluate is a template over the scalar T: by default the
/// numbers of its state. A vertex type may specialize it, with numbers of type T only and, where
/// these are not the state, a function that makes them of one:
///
///     static View Of(const double* state) requires std::same_as<T, double>;
///
/// They are then made once for all edges of a run.
template <class V, class T>
struct View {
  T state[V::kAmbientDim];
  const T& operator[](int i) const { return state[i]; }
};

template <class T>
struct View<VertexPose, T> {
  Mat<T, 3, 3> R;
  Vec<T, 3> p;

  static View Of(const double* state) requires std::same_as<T, double> {
    const double x = state[3], y = state[4], z = state[5], w = state[6];
    return {{{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
              2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
              2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}},
            {{state[0], state[1], state[2]}}};
  }
};

template <class T>
struct View<VertexPointXYZ, T> {
  Vec<T, 3> p;
};

template <class T>
struct View<VertexInverseDepth, T> {
  T rho;
};

namespace internal {
/// I + a [phi]x + b [phi]x^2, as so3::internal::Polynomial.
__attribute__((always_inline)) inline Mat<double, 3, 3> RotationPolynomial(const double* phi,
                                                                           double a, double b) {
  const double x = phi[0], y = phi[1], z = phi[2];
  const double bxy = b * x * y, bxz = b * x * z, byz = b * y * z;
  const double ax = a * x, ay = a * y, az = a * z;
  return {{1.0 - b * (y * y + z * z), bxy - az, bxz + ay,  //
           bxy + az, 1.0 - b * (x * x + z * z), byz - ax,  //
           bxz - ay, byz + ax, 1.0 - b * (x * x + y * y)}};
}
}  // namespace internal

/// World to camera: R = Exp(w), Jl its left Jacobian at w.
template <class T>
struct View<VertexCameraBal, T> {
  Mat<T, 3, 3> R, Jl;
  Vec<T, 3> t;
  T f, k1, k2;

  static View Of(const double* state) requires std::same_as<T, double> {
    const double x = state[0] * state[0] + state[1] * state[1] + state[2] * state[2];
    const so3::internal::Coefficients k = so3::internal::CoefficientsAt(x);
    View view;
    view.R = internal::RotationPolynomial(state, k.a, k.b);
    view.Jl = internal::RotationPolynomial(state, k.b, k.c);
    std::memcpy(&view.t, state + 3, 6 * sizeof(double));
    return view;
  }
};

namespace internal {
template <class V>
inline constexpr bool kViewIsState = !requires(const double* x) {
  View<V, double>::Of(x);
};

template <class V>
inline View<V, double> ViewOfState(const double* state) {
  if constexpr (kViewIsState<V>) {
    static_assert(sizeof(View<V, double>) == sizeof(double) * V::kAmbientDim);
    View<V, double> view;
    std::memcpy(&view, state, sizeof(view));
    return view;
  } else {
    return View<V, double>::Of(state);
  }
}

/// The same numbers in all lanes.
template <class T, class V>
inline View<V, T> Broadcast(const View<V, double>& view) {
  constexpr int kCount = static_cast<int>(sizeof(view) / sizeof(double));
  static_assert(sizeof(View<V, T>) == kCount * sizeof(T), "a View consists of numbers T only");
  double from[kCount];
  std::memcpy(from, &view, sizeof(view));
  View<V, T> out;
  for (int i = 0; i < kCount; ++i) {
    const T number = from[i];
    std::memcpy(reinterpret_cast<char*>(&out) + i * sizeof(T), &number, sizeof(T));
  }
  return out;
}
}  // namespace internal

}  // namespace glissade
