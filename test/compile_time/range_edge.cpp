// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// An edge of one's own with one row, between a pose and a point.
#include <glissade/losses/huber.h>
#include <glissade/problem/problem.h>
#include <glissade/vertices/point_xyz.h>
#include <glissade/vertices/pose.h>

using namespace glissade;

/// Distance from an antenna on a body to a point [m].
struct EdgeRange {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;

  double measured = 0.0;
  Vector3 antenna = Vector3::Zero();  ///< in the body

  bool Evaluate(const VertexPose& body, const VertexPointXYZ& point, Vector<1>& r,
                Jacobian<1, 6>* d_r_d_body, Jacobian<1, 3>* d_r_d_point) const {
    const Vector3 ray = point.p() - body.pose * antenna;
    const double range = ray.norm();
    if (range == 0.0) return false;
    r[0] = range - measured;
    const Vector3 direction = ray / range;
    if (d_r_d_body != nullptr) {
      const Vector3 in_body = body.pose.R().transpose() * direction;
      *d_r_d_body << -direction.transpose(), in_body.cross(antenna).transpose();
    }
    if (d_r_d_point != nullptr) *d_r_d_point = direction.transpose();
    return true;
  }
};

int main() {
  Problem problem;
  const auto body = problem.AddVertex(VertexPose{});
  const auto point = problem.AddVertex(VertexPointXYZ(Vector3(1, 2, 3)));
  if (!problem.SetFixed(body).ok()) return 1;
  if (!problem.AddEdge(EdgeRange{3.7, Vector3(0, 0, 0.1)}, {body, point}, {.loss = Huber{1.0}})
           .ok())
    return 1;
  return problem.Solve().ok() && problem.Get(point).p().norm() > 0.0 ? 0 : 1;
}
