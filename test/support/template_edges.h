// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <random>
#include <tuple>

#include "glissade/edges/concept.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/view.h"
#include "support/user_types.h"

/// \file
/// Edges of a user's own whose Evaluate is a template over its scalar.
namespace glissade {

/// A landmark whose view is not its state.
template <class T>
struct View<test::VertexBearing, T> {
  Vec<T, 3> d;
  Mat<T, 3, 2> basis;

  static View Of(const double* state) requires std::same_as<T, double> {
    test::VertexBearing v;
    std::copy_n(state, 3, v.data);
    const Matrix<3, 2> B = v.Basis();
    View view;
    std::copy_n(state, 3, view.d.a);
    std::copy_n(B.data(), 6, view.basis.a);
    return view;
  }
};

namespace test {

/// Without any trait; one row.
struct RangeInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  static constexpr auto kLanes = Fields(&RangeInPacks::measured);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const T& range, Vec<T, 1>& r, Mat<T, 1, 6>* d_pose, Mat<T, 1, 3>* d_point) const {
    using std::sqrt;
    const Vec<T, 3> x = point.p - pose.p;
    const T distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (distance == T(0.0)) return false;
    r[0] = distance - range;
    const Mat<T, 1, 3> n = ((T(1.0) / distance) * x).Transpose();
    if (d_pose) *d_pose = {{-n[0], -n[1], -n[2], T(0.0), T(0.0), T(0.0)}};
    if (d_point) *d_point = n;
    return true;
  }
};

/// Three rows, and a member that is equal within a run.
struct OffsetInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  Vector3 measured = Vector3::Zero();
  double scale = 1.0;
  static constexpr auto kLanes = Fields(&OffsetInPacks::measured);
  [[nodiscard]] bool SameSensor(const OffsetInPacks& other) const { return scale == other.scale; }

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Vec<T, 3>& offset, Vec<T, 3>& r, Mat<T, 3, 6>* d_pose,
                Mat<T, 3, 3>* d_point) const {
    const Vec<T, 3> x = TransposeTimes(pose.R, point.p - pose.p);
    r = T(scale) * x - offset;
    const Mat<T, 3, 3> d = T(scale) * pose.R.Transpose();
    if (d_pose) {
      d_pose->Set(0, 0, -d);
      d_pose->Set(
          0, 3,
          T(scale) * Mat<T, 3, 3>{{T(0.0), -x[2], x[1], x[2], T(0.0), -x[0], -x[1], x[0], T(0.0)}});
    }
    if (d_point) *d_point = d;
    return true;
  }
};

/// Branches: quadratic far away.
struct BentInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double height = 0.0;
  static constexpr auto kLanes = Fields(&BentInPacks::height);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point, const T& at,
                Vec<T, 1>& r, Mat<T, 1, 6>* d_pose, Mat<T, 1, 3>* d_point) const {
    const T z = point.p[2] - pose.p[2] - at;
    T slope = T(1.0);
    r[0] = z;
    if (z > T(0.0)) {
      r[0] = z + z * z;
      slope = T(1.0) + T(2.0) * z;
    }
    if (d_pose) *d_pose = {{T(0.0), T(0.0), -slope, T(0.0), T(0.0), T(0.0)}};
    if (d_point) *d_point = {{T(0.0), T(0.0), slope}};
    return true;
  }
};

/// A two-dimensional landmark of one's own.
struct BearingInPacks {
  using Vertices = VertexList<VertexPose, test::VertexBearing>;
  static constexpr int kResidualDim = 2;
  Vector2 xy = Vector2::Zero();
  static constexpr auto kLanes = Fields(&BearingInPacks::xy);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<test::VertexBearing, T>& bearing,
                const Vec<T, 2>& at, Vec<T, 2>& r, Mat<T, 2, 6>* d_pose,
                Mat<T, 2, 2>* d_bearing) const {
    const Vec<T, 3> d = TransposeTimes(pose.R, bearing.d);
    const T inv_z = T(1.0) / d[2];
    r = {{d[0] * inv_z - at[0], d[1] * inv_z - at[1]}};
    const Mat<T, 2, 3> d_r_d_b = {{inv_z, T(0.0), -d[0] * inv_z * inv_z,  //
                                   T(0.0), inv_z, -d[1] * inv_z * inv_z}};
    if (d_pose) {
      for (int row = 0; row < 2; ++row) {
        d_pose->Set(row, 0, Mat<T, 1, 3>{{T(0.0), T(0.0), T(0.0)}});
        d_pose->Set(row, 3, Cross(d_r_d_b.Row(row), d));
      }
    }
    if (d_bearing) *d_bearing = d_r_d_b * pose.R.Transpose() * bearing.basis;
    return true;
  }
};

/// The same edge with a signature of today's: one at a time.
template <class E>
struct OneByOne {
  using Vertices = typename E::Vertices;
  static constexpr int kResidualDim = E::kResidualDim;
  using A = EdgeVertex<E, 0>;
  using B = EdgeVertex<E, 1>;
  E edge;

  bool Evaluate(const A& a, const B& b, Vector<kResidualDim>& r,
                Jacobian<kResidualDim, A::kTangentDim>* d_a,
                Jacobian<kResidualDim, B::kTangentDim>* d_b) const {
    return internal::EvaluateInDouble(edge, std::tie(a, b), r, d_a, d_b);
  }
};

inline double Normal(std::mt19937& engine, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(engine);
}

}  // namespace test
}  // namespace glissade
