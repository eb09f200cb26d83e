// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A reprojection edge of one's own, in Eigen: two poses and an inverse depth.
#include <glissade/losses/huber.h>
#include <glissade/problem/problem.h>
#include <glissade/vertices/inverse_depth.h>
#include <glissade/vertices/pose.h>

using namespace glissade;

struct EdgeSeen {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;

  Vector2 uv_host = Vector2::Zero(), uv_target = Vector2::Zero();
  Pose T_b_c;

  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector<2>& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_depth) const {
    const Vector3 ray(uv_host[0], uv_host[1], 1.0);
    const Vector3 x_host = T_b_c * Vector3(ray / depth.rho);
    const Vector3 x_world = host.pose * x_host;
    const Pose T_c_b = T_b_c.Inverse();
    const Vector3 x_target = target.pose.Inverse() * x_world;
    const Vector3 x = T_c_b * x_target;
    if (x[2] == 0.0) return false;
    const double inverse_z = 1.0 / x[2];
    r = x.head<2>() * inverse_z - uv_target;
    Jacobian<2, 3> d_r_d_x;
    d_r_d_x << inverse_z, 0.0, -x[0] * inverse_z * inverse_z,  //
        0.0, inverse_z, -x[1] * inverse_z * inverse_z;
    const Jacobian<2, 3> d_r_d_body = d_r_d_x * T_c_b.R();
    const Matrix3 R_t_w = target.pose.R().transpose();
    const Jacobian<2, 3> d_r_d_world = d_r_d_body * R_t_w;
    if (d_r_d_host != nullptr) {
      d_r_d_host->leftCols<3>() = d_r_d_world;
      d_r_d_host->rightCols<3>() = -d_r_d_world * host.pose.R() * so3::Hat(x_host);
    }
    if (d_r_d_target != nullptr) {
      d_r_d_target->leftCols<3>() = -d_r_d_world;
      d_r_d_target->rightCols<3>() = d_r_d_body * so3::Hat(x_target);
    }
    if (d_r_d_depth != nullptr) {
      *d_r_d_depth = -d_r_d_world * (host.pose.R() * (T_b_c.R() * ray)) / (depth.rho * depth.rho);
    }
    return true;
  }
};

int main() {
  Problem problem;
  const auto host = problem.AddVertex(VertexPose{});
  const auto target = problem.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(1, 0, 0))});
  const auto depth = problem.AddVertex(VertexInverseDepth{0.2});
  if (!problem.SetFixed(host).ok()) return 1;
  const EdgeSeen edge{Vector2(0.1, 0.2), Vector2(-0.1, 0.2), Pose()};
  const auto seen =
      problem.AddEdge(edge, {host, target, depth},
                      {.sqrt_information = 400.0 * Matrix2::Identity(), .loss = Huber{1.0}});
  return seen.ok() && problem.Solve().ok() ? 0 : 1;
}
