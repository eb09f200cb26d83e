// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Monocular bundle adjustment, one step at a time: what Problem::Solve does in its loop, and what
// the matrix looks like that it solves with.
//
//     mono_ba_steps [PICTURE.pgm]
//
// With a name, writes a picture of H: 3 poses first, then 20 inverse depths.
#include <glissade/glissade.h>
#include <glissade/sim/course_scene.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

using namespace glissade;

namespace {

/// Ends the program where something was refused: the message says what, and why.
void Check(const Status& status) {
  if (status.ok()) return;
  std::printf("%s\n", status.message().c_str());
  std::exit(1);
}

/// |H| on a logarithmic scale as a grey picture, 6 x 6 pixels an entry; white is zero.
bool WritePicture(const Eigen::MatrixXd& H, const char* path) {
  constexpr int kScale = 6;
  const double top = std::log10(H.cwiseAbs().maxCoeff());
  std::ofstream out(path, std::ios::binary);
  out << "P5\n" << kScale * H.cols() << ' ' << kScale * H.rows() << "\n255\n";
  for (Eigen::Index y = 0; y < kScale * H.rows(); ++y) {
    for (Eigen::Index x = 0; x < kScale * H.cols(); ++x) {
      const double h = std::abs(H(y / kScale, x / kScale));
      const double depth = h > 0.0 ? 1.0 - (top - std::log10(h)) / 5.0 : -1.0;  // five decades
      const double grey = depth < 0.0 ? (h > 0.0 ? 225.0 : 255.0) : 225.0 * (1.0 - depth);
      out.put(static_cast<char>(static_cast<unsigned char>(grey)));
    }
  }
  return out.good();
}

}  // namespace

int main(int argc, char** argv) {
  // Three poses 30 degrees apart that look at twenty points; a noise of 0.001 on normalized image
  // points; inverse depths start at depths that are off by a metre.
  const CourseScene scene = MakeCourseScene();

  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  for (const Pose& T_w_b : scene.poses)
    poses.push_back(problem.AddVertex(VertexPose{T_w_b}));
  for (const CoursePoint& point : scene.points) {
    const auto depth = problem.AddVertex(VertexInverseDepth{point.rho_init});
    // The first observation is the landmark's ray; each other one makes an edge of two rows.
    const CourseObservation& host = point.observations[0];
    for (std::size_t k = 1; k < point.observations.size(); ++k) {
      const CourseObservation& seen = point.observations[k];
      EdgeReprojection edge;
      edge.uv_host = Vector2(host.u, host.v);
      edge.uv_target = Vector2(seen.u, seen.v);
      Check(problem
                .AddEdge(edge, {poses[static_cast<std::size_t>(host.pose)],
                                poses[static_cast<std::size_t>(seen.pose)], depth})
                .status());
    }
  }
  // One camera sees neither where it is nor how large the world is. Two held poses say so.
  Check(problem.SetFixed(poses[0]));
  Check(problem.SetFixed(poses[1]));

  double lambda = 1e-4;
  double cost = problem.Cost().value();
  std::printf("step    cost          lambda\n   0    %.6e\n", cost);
  for (int step = 1; step <= 12; ++step) {
    Check(problem.MakeHessian());              // H = J'J, b = -J'r
    Check(problem.SolveLinearSystem(lambda));  // (H + lambda D) dx = b
    Check(problem.UpdateStates());             // x <- x boxplus dx
    const double dx = problem.Step().norm();
    const double tried = problem.Cost().value();
    if (tried < cost) {
      cost = tried;
      lambda *= 0.1;
    } else {
      Check(problem.RollbackStates());
      lambda *= 10.0;
    }
    std::printf("  %2d    %.6e  %.1e%s\n", step, cost, lambda, tried > cost ? "  rejected" : "");
    if (dx < 1e-9) break;
  }

  // All poses free again, to see the whole matrix.
  Check(problem.SetFixed(poses[0], Fix::kFree));
  Check(problem.SetFixed(poses[1], Fix::kFree));
  Check(problem.MakeHessian());
  const Eigen::MatrixXd H = problem.Hessian();
  std::printf("H is %d x %d: 3 poses of 6, 20 inverse depths of 1\n", static_cast<int>(H.rows()),
              static_cast<int>(H.cols()));
  if (argc > 1 && !WritePicture(H, argv[1])) {
    std::printf("%s cannot be written\n", argv[1]);
    return 1;
  }
  // Half of (80 rows less 26 unknowns) times the square of the noise, give or take.
  return cost < 1e-4 ? 0 : 1;
}
