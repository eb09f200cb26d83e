// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection.h"
#include "glissade/problem/problem.h"
#include "support/graph_random.h"

/// \file
/// A window whose tilt is observed, as with an accelerometer, while position and yaw are not: to
/// hold these at an anchor that starts with a tilt error of some degrees.
namespace glissade::test {

/// The up direction in the body frame.
struct EdgeTilt {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 3;

  Vector3 up_b = Vector3::UnitZ();

  bool Evaluate(const VertexPose& pose, Vector3& r, Jacobian<3, 6>* d_r_d_pose) const {
    const Vector3 up = pose.pose.R().row(2).transpose();
    r = up - up_b;
    if (d_r_d_pose != nullptr) {
      d_r_d_pose->setZero();
      d_r_d_pose->rightCols<3>() = so3::Hat(up);
    }
    return true;
  }
};

/// Rotation about world z that R went through since R0: e_z . Log(R R0').
inline double YawSince(const Pose& start, const Pose& now) {
  return so3::Log(Quaternion(now.q() * start.q().conjugate()))[2];
}

/// The anchor as an ordinary pose. A test-only vertex type with the same members replaces it where
/// another way of holding the yaw is tried.
struct ChartAnchor {
  using Vertex = VertexPose;
  template <class E>
  using Edge = E;
  static Status Hold(Problem& problem, VertexHandle<VertexPose> anchor) {
    return problem.SetFixed(anchor, Fix::kPositionAndYaw);
  }
};

template <class Anchor>
struct TiltScene {
  using Vertex = typename Anchor::Vertex;

  Problem problem;
  VertexHandle<Vertex> anchor;
  std::vector<VertexHandle<VertexPose>> poses;  ///< the others
  Pose start;                                   ///< of the anchor

  /// Five poses, body z up to 10 degrees from the vertical; the whole start is turned about the
  /// anchor by tilt_error [rad] around a horizontal axis. Measurements have noise, so that the
  /// optimum is not zero.
  explicit TiltScene(std::uint64_t seed, double tilt_error) {
    GraphRandom random(seed);
    const Pose T_b_c(so3::ExpQuaternion(Vector3(-1.2, 0.05, 0.02)), Vector3(0.1, 0.02, 0.0));
    std::vector<Pose> truth;
    const double heading = random.Uniform(-3.0, 3.0);
    for (int k = 0; k < 5; ++k) {
      const Vector3 lean(random.Uniform(-0.12, 0.12), random.Uniform(-0.12, 0.12), 0.0);
      const Quaternion q =
          so3::ExpQuaternion(Vector3(0.0, 0.0, heading + 0.1 * k)) * so3::ExpQuaternion(lean);
      truth.emplace_back(q, Vector3(0.4 * k, 0.1 * k, 0.0) + random.Vec3(0.1));
    }
    const double azimuth = random.Uniform(-3.0, 3.0);
    const Quaternion tilt =
        so3::ExpQuaternion(tilt_error * Vector3(std::cos(azimuth), std::sin(azimuth), 0.0));
    const auto tilted = [&](const Pose& pose) {
      const Vector3 arm = pose.p() - truth[0].p();
      return Pose(Quaternion(tilt * pose.q()),
                  truth[0].p() + RotationMatrix(tilt.coeffs().data()) * arm);
    };

    start = tilted(truth[0]);
    Vertex value;
    value.pose = start;
    anchor = problem.AddVertex(value);
    for (int k = 1; k < 5; ++k)
      poses.push_back(problem.AddVertex(VertexPose{tilted(truth[static_cast<std::size_t>(k)])}));

    using Tilt = typename Anchor::template Edge<EdgeTilt>;
    using Relative = typename Anchor::template Edge<EdgeRelativePose>;
    using Reprojection = typename Anchor::template Edge<EdgeReprojection>;
    const auto up = [&](const Pose& pose) {
      return EdgeTilt{pose.R().row(2).transpose() + random.NormalVector<3>(0.002)};
    };
    Add(Tilt{up(truth[0])}, {anchor}, 500.0);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      Add(up(truth[k + 1]), {poses[k]}, 500.0);
      const Pose exact = truth[0].Inverse() * truth[k + 1];
      Add(Relative{EdgeRelativePose{random.Perturb(exact, 0.02, 0.01)}}, {anchor, poses[k]}, 50.0);
    }
    for (int l = 0; l < 30; ++l) {
      const double z = random.Uniform(3.0, 8.0);
      const Vector2 uv(random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5));
      const Vector3 x_w = truth[0] * (T_b_c * Vector3(z * uv[0], z * uv[1], z));
      const VertexHandle<VertexInverseDepth> depth = problem.AddVertex(VertexInverseDepth{1.1 / z});
      for (std::size_t k = 0; k < poses.size(); ++k) {
        const Vector3 x_c = T_b_c.Inverse() * (truth[k + 1].Inverse() * x_w);
        EdgeReprojection edge{.uv_host = uv, .T_b_c = T_b_c};
        edge.uv_target = x_c.head<2>() / x_c[2] + random.NormalVector<2>(0.002);
        Add(Reprojection{edge}, {anchor, poses[k], depth}, 500.0);
      }
    }
    status = Anchor::Hold(problem, anchor);
  }

  /// The anchor now.
  [[nodiscard]] Pose Now() const { return problem.Get(anchor).pose; }

  Status status;  ///< of building

 private:
  template <class E>
  void Add(const E& edge, const EdgeVertexHandles<E>& vertices, double inverse_sigma) {
    EdgeOptions<E> options;
    options.sqrt_information = inverse_sigma * SquareMatrix<E::kResidualDim>::Identity();
    const auto added = problem.AddEdge(edge, vertices, options);
    if (!added.ok()) status = added.status();
  }
};

}  // namespace glissade::test
