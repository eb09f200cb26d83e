// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A user's program: an edge type of its own next to built-in types, solved with the installed
// library. It is built plainly and with -march=native; in the latter case everything inline here
// uses wider vectors and other alignments than the library does, which must not matter.
#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <vector>

#include "glissade/problem/problem.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "matrices.h"

namespace {

/// Distance from an antenna on a body to a point [m].
struct EdgeRange {
  using Vertices = glissade::VertexList<glissade::VertexPose, glissade::VertexPointXYZ>;
  static constexpr int kResidualDim = 1;

  double measured = 0.0;
  double lever[3] = {};  ///< antenna in the body frame [m]

  bool Evaluate(const glissade::VertexPose& body, const glissade::VertexPointXYZ& point,
                glissade::Vector<1>& r, glissade::Jacobian<1, 6>* d_r_d_pose,
                glissade::Jacobian<1, 3>* d_r_d_point) const {
    const Eigen::Vector3d l(lever[0], lever[1], lever[2]);
    const Eigen::Vector3d ray = point.p() - body.pose * l;
    const double range = ray.norm();
    if (range == 0.0) return false;
    r[0] = range - measured;
    const Eigen::Vector3d direction = ray / range;
    if (d_r_d_pose != nullptr) {
      const Eigen::Vector3d in_body = body.pose.R().transpose() * direction;
      *d_r_d_pose << -direction.transpose(), in_body.cross(l).transpose();
    }
    if (d_r_d_point != nullptr) *d_r_d_point = direction.transpose();
    return true;
  }
};

int failures = 0;
void Check(bool ok, const char* what) {
  std::printf("%s: %s\n", ok ? "ok" : "FAILED", what);
  if (!ok) ++failures;
}

}  // namespace

int main() {
  using namespace glissade;
  const int num_poses = 6;
  const int num_points = 9;
  std::vector<Eigen::Vector3d> bodies, points;
  for (int i = 0; i < num_poses; ++i)
    bodies.emplace_back(i, std::sin(2.0 * i), std::cos(3.0 * i));
  for (int j = 0; j < num_points; ++j)
    points.emplace_back(0.7 * j - 2, 5 + std::cos(j), std::sin(2.0 * j));

  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexPointXYZ>> landmarks;
  for (int i = 0; i < num_poses; ++i) {
    VertexPose vertex;
    vertex.pose.p() = bodies[i];
    if (i == num_poses - 1) vertex.pose.p() += Eigen::Vector3d(0.02, -0.03, 0.01);
    poses.push_back(problem.AddVertex(vertex));
    if (i < num_poses - 1) Check(problem.SetFixed(poses.back()).ok(), "pose fixed");
  }
  for (int j = 0; j < num_points; ++j) {
    landmarks.push_back(
        problem.AddVertex(VertexPointXYZ(points[j] + Eigen::Vector3d(0.1, 0.05, -0.1))));
    for (int i = 0; i < num_poses; ++i) {
      const Eigen::Vector3d l = Eigen::Vector3d::Unit(j % 3);
      const EdgeRange edge{(points[j] - bodies[i] - l).norm(), {l[0], l[1], l[2]}};
      Check(problem.AddEdge(edge, {poses[i], landmarks[j]}).ok(), "range added");
    }
  }
  Check(!problem.AddEdge(EdgeRange{}, {}).ok(), "an edge without vertices is refused");
  Check(!problem.AcknowledgeRefusal().ok(), "and the refusal is acknowledged");

  const SolveSummary summary = problem.Solve();
  std::printf("%s\n", summary.BriefReport().c_str());
  Check(summary.converged(), "converged");
  Check(summary.final_cost < 1e-16, "no cost left");
  Check((problem.Get(poses.back()).pose.p() - bodies.back()).norm() < 1e-7, "pose found");
  for (int j = 0; j < num_points; ++j) {
    Check((problem.Get(landmarks[j]).p() - points[j]).norm() < 1e-7, "point found");
  }

  Check(MatricesAreSound(), "matrices of the library");
  Problem copy = problem.Clone();
  problem = Problem();
  Check(copy.Solve().ok() && copy.NumEdges<EdgeRange>() == num_poses * num_points, "copy solved");
  return failures == 0 ? 0 : 1;
}
