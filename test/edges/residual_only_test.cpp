// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Edges that write no Jacobians: the library's, from dual numbers, are those that the same edges
// write, one at a time and in packs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

#include "glissade/base/dual.h"
#include "glissade/lie/so3.h"
#include "glissade/testing/check_jacobians.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "support/user_types.h"

namespace glissade {
namespace {

using TwoDual = Dual<double, 2>;

TEST(Dual, DerivativesOfItsFunctions) {
  const auto along = [](double value, double a, double b) {
    TwoDual x(value);
    x.d[0] = a;
    x.d[1] = b;
    return x;
  };
  const auto near = [](const TwoDual& x, double value, double a, double b) {
    EXPECT_NEAR(x.a, value, 1e-15 * (1.0 + std::abs(value)));
    EXPECT_NEAR(x.d[0], a, 1e-15 * (1.0 + std::abs(a)));
    EXPECT_NEAR(x.d[1], b, 1e-15 * (1.0 + std::abs(b)));
  };
  const TwoDual x = along(0.7, 1.0, 0.0), y = along(-1.3, 0.0, 1.0);
  near(x + y, -0.6, 1.0, 1.0);
  near(x - y, 2.0, 1.0, -1.0);
  near(-x, -0.7, -1.0, 0.0);
  near(x * y, -0.91, -1.3, 0.7);
  near(x / y, 0.7 / -1.3, 1.0 / -1.3, -0.7 / 1.69);
  near(2.0 * x + 1, 2.4, 2.0, 0.0);
  near(sqrt(x), std::sqrt(0.7), 0.5 / std::sqrt(0.7), 0.0);
  near(sin(x), std::sin(0.7), std::cos(0.7), 0.0);
  near(cos(x), std::cos(0.7), -std::sin(0.7), 0.0);
  near(tan(x), std::tan(0.7), 1.0 / (std::cos(0.7) * std::cos(0.7)), 0.0);
  near(atan(x), std::atan(0.7), 1.0 / 1.49, 0.0);
  near(exp(y), std::exp(-1.3), 0.0, std::exp(-1.3));
  near(log(x), std::log(0.7), 1.0 / 0.7, 0.0);
  near(atan2(y, x), std::atan2(-1.3, 0.7), 1.3 / 2.18, 0.7 / 2.18);
  near(abs(y), 1.3, 0.0, -1.0);
  near(Select(x > y, x, y), 0.7, 1.0, 0.0);
  EXPECT_TRUE(x > y && y < x && x >= y && y <= x && x != y && x == x);
}

/// A camera sees a point by its inverse depth in another: all of both poses.
struct Bearing {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  double host[2] = {0.1, -0.2};
  double target[2] = {0.0, 0.1};
  static constexpr auto kLanes = Fields(&Bearing::host, &Bearing::target);

  template <class T>
  static Vec<T, 3> Scaled(const View<VertexPose, T>& i, const View<VertexPose, T>& j, const T& rho,
                          const Vec<T, 2>& uv) {
    const Vec<T, 3> ray = {{uv[0], uv[1], T(1.0)}};
    return TransposeTimes(j.R, i.R * ray + rho * (i.p - j.p));
  }
  template <class T>
  bool Evaluate(const View<VertexPose, T>& i, const View<VertexPose, T>& j,
                const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& uv_host,
                const Vec<T, 2>& uv, Vec<T, 2>& r) const {
    const Vec<T, 3> q = Scaled(i, j, depth.rho, uv_host);
    if (q[2] == T(0.0)) return false;
    r = {{q[0] / q[2] - uv[0], q[1] / q[2] - uv[1]}};
    return true;
  }
};

VertexPose PoseAt(const Vector3& phi, const Vector3& p) {
  return VertexPose{Pose(so3::ExpQuaternion(phi), p)};
}

TEST(ResidualOnly, JacobiansOfPosesAndInverseDepth) {
  const JacobianCheck check = CheckJacobians(
      Bearing{}, PoseAt(Vector3(0.1, -0.2, 0.3), Vector3(0.1, 0.2, 0.3)),
      PoseAt(Vector3(0.2, 0.1, -0.1), Vector3(-0.4, 0.1, 0.2)), VertexInverseDepth{0.3});
  EXPECT_TRUE(check.ok) << check.message;
  EXPECT_LT(check.worst_error, 1e-9);
}

/// Types whose boxplus is no sum or whose view is not their state: by differences.
struct Seen {
  using Vertices = VertexList<VertexCameraBal, test::VertexBearing>;
  static constexpr int kResidualDim = 2;
  double uv[2] = {10.0, -20.0};
  static constexpr auto kLanes = Fields(&Seen::uv);

  template <class T>
  bool Evaluate(const View<VertexCameraBal, T>& camera, const View<test::VertexBearing, T>& bearing,
                const Vec<T, 2>& at, Vec<T, 2>& r) const {
    const Vec<T, 3> d = {{bearing[0], bearing[1], bearing[2]}};
    const Vec<T, 3> x = camera.R * (T(4.0) * d) + camera.t;
    const T u = x[0] / x[2], v = x[1] / x[2], n = u * u + v * v;
    const T scale = camera.f * (T(1.0) + n * (camera.k1 + camera.k2 * n));
    r = {{scale * u - at[0], scale * v - at[1]}};
    return true;
  }
};

TEST(ResidualOnly, JacobiansOfTypesThatAreNoSums) {
  VertexCameraBal camera;
  const double state[9] = {0.1, -0.2, 0.05, 0.3, -0.1, 0.2, 500.0, -0.1, 0.01};
  std::copy_n(state, 9, camera.data);
  test::VertexBearing bearing;
  const Vector3 d = Vector3(0.1, 0.2, 1.0).normalized();
  std::copy_n(d.data(), 3, bearing.data);
  const JacobianCheck check = CheckJacobians(Seen{}, camera, bearing);
  EXPECT_TRUE(check.ok) << check.message;
  EXPECT_LT(check.worst_error, 1e-8);
}

/// To the last digits, other than differences.
TEST(ResidualOnly, TangentOfAPose) {
  const VertexPose pose = PoseAt(Vector3(0.3, -0.1, 0.2), Vector3(0.4, -0.5, 0.6));
  internal::ViewTangent<VertexPose, double> tangent;
  internal::FindViewTangent<VertexPose>(pose.Data(), &tangent);
  const auto view = internal::ViewOfState<VertexPose>(pose.Data());
  for (int k = 0; k < 3; ++k) {
    const Matrix3 dR = pose.pose.R() * so3::Hat(Vector3::Unit(k));
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) {
        EXPECT_NEAR(tangent.d[(3 * row + col) * 6 + 3 + k], dR(row, col), 1e-15);
        EXPECT_EQ(tangent.d[(3 * row + col) * 6 + k], 0.0);
      }
      EXPECT_EQ(tangent.d[(9 + row) * 6 + k], row == k ? 1.0 : 0.0);
      EXPECT_EQ(tangent.d[(9 + row) * 6 + 3 + k], 0.0);
    }
  }
  EXPECT_NEAR(view.R(0, 1), pose.pose.R()(0, 1), 1e-15);
}

}  // namespace
}  // namespace glissade
