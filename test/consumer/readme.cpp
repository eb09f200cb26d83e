// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The program of README.md: two poses, one landmark.
#include <glissade/glissade.h>

using namespace glissade;

int main() {
  const Pose T_w_b0, T_b_c;
  Pose T_w_b1;
  T_w_b1.data[0] = 0.4;
  const Vector2 uv_host(0.1, 0.2), uv_target(0.0, 0.2);
  const double focal = 400.0, sigma_px = 1.0;

  Problem problem;
  auto host = problem.AddVertex(VertexPose{T_w_b0});
  auto target = problem.AddVertex(VertexPose{T_w_b1});
  auto depth = problem.AddVertex(VertexInverseDepth{0.2});
  auto seen = problem.AddEdge(
      EdgeReprojection{uv_host, uv_target, T_b_c}, {host, target, depth},
      {.sqrt_information = focal / sigma_px * Matrix2::Identity(), .loss = Huber{1.0}});
  const Status fixed = problem.SetFixed(host);
  const SolveSummary& summary = problem.Solve({.max_iterations = 10});
  const Pose T_w_b1_after = problem.Get(target).pose;
  return seen.ok() && fixed.ok() && summary.ok() && summary.final_cost < 1e-12 &&
                 T_w_b1_after.data[0] > 0.0
             ? 0
             : 1;
}
