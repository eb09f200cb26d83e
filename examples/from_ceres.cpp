// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What was written for Ceres, in a glissade graph: a functor with templates, derivatives by
// automatic differentiation, and a ceres::CostFunction as it is.
#include <ceres/autodiff_cost_function.h>
#include <glissade/bridge/autodiff.h>
#include <glissade/bridge/cost_function_edge.h>
#include <glissade/glissade.h>
#include <glissade/testing.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

using namespace glissade;

/// Distance from a body to a point. Pointers to ambient states: a VertexPose is px py pz qx qy qz
/// qw.
struct Range {
  double measured = 0.0;  // m

  template <class T>
  bool operator()(const T* pose, const T* point, T* r) const {
    using std::sqrt;
    const T x = point[0] - pose[0], y = point[1] - pose[1], z = point[2] - pose[2];
    r[0] = sqrt(x * x + y * y + z * z) - T(measured);
    return true;
  }
};

// 1. The functor as an edge type: as fast to add and to store as a type written by hand, checked
//    by the same concepts. Derivatives are taken along the tangent, no manifold is needed.
using EdgeRange = bridge::EdgeAutodiff<Range, 1, VertexPose, VertexPointXYZ>;

// 2. The functor in a ceres::CostFunction, which becomes an edge whose size is known at run time.
//    For code that has cost functions already and no functors to give.
std::unique_ptr<DynamicEdge> CostFunctionOf(const Range& range) {
  return std::make_unique<bridge::CostFunctionEdge>(
      std::make_shared<ceres::AutoDiffCostFunction<Range, 1, 7, 3>>(new Range(range)));
}

/// Ends the program where something was refused: the message says what, and why.
void Check(const Status& status) {
  if (status.ok()) return;
  std::printf("%s\n", status.message().c_str());
  std::exit(1);
}

int main() {
  const JacobianCheck check = CheckJacobians(
      EdgeRange{{2.0}}, VertexPose{Pose(so3::Exp(Vector3(0.1, 0.2, 0.3)), Vector3(1, 2, 3))},
      VertexPointXYZ(Vector3(-2, 0.5, 4)));
  std::printf("Jacobians: %s\n", check.ok ? "ok" : check.message.c_str());
  if (!check.ok) return 1;

  const std::vector<Vector3> beacons = {{0, 0, 0}, {5, 0, 1}, {0, 5, 2},
                                        {5, 5, 4}, {2, 2, 7}, {3, 1, -5}};
  const Vector3 truth(2.0, 3.0, 0.5);
  double found[2][3];
  for (const bool with_cost_functions : {false, true}) {
    Problem problem;
    VertexPose start;
    start.pose.p() = Vector3(1, 1, 1);
    const auto pose = problem.AddVertex(start);
    // Distances say nothing of the rotation: a prior holds it, and hardly the position.
    Vector<6> weights;
    weights << 1e-6, 1e-6, 1e-6, 1.0, 1.0, 1.0;
    Check(problem
              .AddEdge(EdgeSE3Prior{}, {pose},
                       {.sqrt_information = SquareMatrix<6>(weights.asDiagonal())})
              .status());
    for (const Vector3& beacon : beacons) {
      const auto point = problem.AddVertex(VertexPointXYZ(beacon));
      Check(problem.SetFixed(point));
      const Range range{(beacon - truth).norm()};
      if (with_cost_functions) {
        const std::vector<AnyVertex> vertices = {pose.value(), point.value()};
        Check(problem.AddEdge(CostFunctionOf(range), vertices).status());
      } else {
        Check(problem.AddEdge(EdgeRange{range}, {pose, point}).status());
      }
    }
    const SolveSummary& summary = problem.Solve();
    std::printf("%-18s %s\n", with_cost_functions ? "ceres::CostFunction" : "EdgeAutodiff",
                summary.BriefReport().c_str());
    if (!summary.converged()) return 1;
    const Vector3 p = problem.Get(pose).pose.p();
    for (int i = 0; i < 3; ++i)
      found[with_cost_functions][i] = p[i];
    if ((p - truth).norm() > 1e-6) return 1;
  }
  const double apart = std::abs(found[0][0] - found[1][0]) + std::abs(found[0][1] - found[1][1]) +
                       std::abs(found[0][2] - found[1][2]);
  std::printf("the two agree to %.1e m\n", apart);
  return apart < 1e-9 ? 0 : 1;
}
