// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What scripts/bench_python.py holds the Python package against: the same work in C++.
//
//   bench_python window FILE   builds and solves each window of a VIOWIN file from arrays
//   bench_python bal FILE      reads and solves a BAL file
//   bench_python edges N       one linearization and solve of N residuals of the built-in edge
//
// Prints the seconds of each repetition, a line each.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "glissade/glissade.h"
#include "glissade/io/bal.h"
#include "glissade/io/viowin.h"

namespace {

using namespace glissade;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The vision-only window as a front end has it: arrays of numbers and indices.
struct Arrays {
  std::vector<VertexPose> poses;
  std::vector<VertexInverseDepth> depths;
  std::vector<std::size_t> landmark, host, target;
  std::vector<Vector2> uv_host, uv_target;
  Pose T_b_c;
  double weight = 1.0;
};

Arrays ArraysOf(const ViowinWindow& window) {
  Arrays a;
  for (const ViowinKeyframe& k : window.keyframes)
    a.poses.push_back(VertexPose{k.T_w_b});
  const ViowinCamera& c = window.camera;
  for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
    const ViowinLandmark& from = window.landmarks[l];
    a.depths.push_back(VertexInverseDepth{from.rho});
    for (const ViowinObservation& o : from.observations) {
      a.landmark.push_back(l);
      a.host.push_back(static_cast<std::size_t>(from.host));
      a.target.push_back(static_cast<std::size_t>(o.frame));
      a.uv_host.emplace_back((from.u_host - c.cx) / c.fx, (from.v_host - c.cy) / c.fy);
      a.uv_target.emplace_back((o.u - c.cx) / c.fx, (o.v - c.cy) / c.fy);
    }
  }
  a.T_b_c = window.T_b_c;
  a.weight = c.fx / c.sigma_px;
  return a;
}

double BuildAndSolve(const Arrays& a) {
  const double start = Now();
  Problem problem;
  const auto poses = problem.AddVertices<VertexPose>(a.poses).value();
  const auto depths = problem.AddVertices<VertexInverseDepth>(a.depths).value();
  std::vector<EdgeReprojection> edges(a.landmark.size());
  std::vector<EdgeVertexHandles<EdgeReprojection>> vertices;
  vertices.reserve(edges.size());
  for (std::size_t k = 0; k < edges.size(); ++k) {
    edges[k].uv_host = a.uv_host[k];
    edges[k].uv_target = a.uv_target[k];
    edges[k].T_b_c = a.T_b_c;
    vertices.emplace_back(poses[a.host[k]], poses[a.target[k]], depths[a.landmark[k]]);
  }
  EdgeOptions<EdgeReprojection> options;
  options.sqrt_information = Matrix2(a.weight * Matrix2::Identity());
  if (!problem.AddEdges<EdgeReprojection>(edges, vertices, options).ok()) std::exit(1);
  (void)problem.SetFixed(poses.front());
  (void)problem.SetFixed(poses.back());
  if (!problem.Solve({.max_iterations = 10}).ok()) std::exit(1);
  return Now() - start;
}

double ReadAndSolve(const std::string& path) {
  const double start = Now();
  auto bal = ReadBal(path);
  if (!bal.ok()) {
    std::fprintf(stderr, "bench_python: %s\n", bal.status().message().c_str());
    std::exit(2);
  }
  Problem problem;
  if (!AddToGraph(bal.value(), problem).ok()) std::exit(1);
  if (!problem.Solve({.max_iterations = 20}).ok()) std::exit(1);
  return Now() - start;
}

/// Poses in a row look at points before them: as in scripts/bench_python.py.
double SolvePoints(int num_residuals) {
  const int num_poses = 20, num_points = num_residuals / 2 / num_poses;
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  for (int i = 0; i < num_poses; ++i) {
    VertexPose pose;
    pose.pose.p() = Vector3(0.1 * i, 0.0, 0.0);
    poses.push_back(problem.AddVertex(pose));
  }
  std::vector<VertexHandle<VertexPointXYZ>> points;
  for (int j = 0; j < num_points; ++j) {
    const double x = j % 50 * 0.1 - 2.5, y = j / 50 * 0.05 - 1.25, z = 6.0 + 0.5 * (j % 7);
    VertexPointXYZ point;
    for (int k = 0; k < 3; ++k)
      point.Data()[k] = (k == 0 ? x : k == 1 ? y : z) + 0.02 * ((j + k) % 5 - 2);
    points.push_back(problem.AddVertex(point));
    for (int i = 0; i < num_poses; ++i) {
      EdgeReprojectionXYZ edge;
      edge.uv = Vector2((x - 0.1 * i) / z, y / z);
      if (!problem.AddEdge(edge, {poses[static_cast<std::size_t>(i)], points.back()}).ok()) {
        std::exit(1);
      }
    }
  }
  (void)problem.SetFixed(poses[0]);
  (void)problem.SetFixed(poses[1]);
  const double start = Now();
  SolveOptions options;
  options.max_iterations = 3;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  if (!problem.Solve(options).ok()) std::exit(1);
  return Now() - start;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc == 3 ? argv[1] : "";
  constexpr int kRepetitions = 9;
  if (what == "window") {
    const auto windows = ReadViowin(argv[2]);
    if (!windows.ok()) {
      std::fprintf(stderr, "bench_python: %s\n", windows.status().message().c_str());
      return 2;
    }
    const Arrays arrays = ArraysOf(windows.value().front());
    for (int k = 0; k < 10 * kRepetitions; ++k)
      std::printf("%.9f\n", BuildAndSolve(arrays));
  } else if (what == "bal") {
    for (int k = 0; k < kRepetitions; ++k)
      std::printf("%.9f\n", ReadAndSolve(argv[2]));
  } else if (what == "edges") {
    for (int k = 0; k < kRepetitions; ++k)
      std::printf("%.9f\n", SolvePoints(std::atoi(argv[2])));
  } else {
    std::fprintf(stderr, "bench_python window FILE | bal FILE | edges N\n");
    return 2;
  }
  return 0;
}
