// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Edges of other forms and types against EdgeReprojection on the same windows, in turn, in one
// process:
//   bench_edges [--rounds N] [--only TEXT] FILE...
// For each file: time of a solve of 8 steps over that of the same window with EdgeReprojection; per
// residual where the number of residuals is another one. GLISSADE_ISA chooses the library's
// kernels; users' edges are compiled with this unit's flags.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "glissade/base/pack.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/graph/pools.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/losses/cauchy.h"
#include "glissade/problem/problem.h"
#include "support/two_view_edges.h"
#include "timing.h"

namespace {

using namespace glissade;
using bench::Median;
using bench::ThreadSeconds;

struct Observation {
  EdgeReprojection edge;
  VertexHandle<VertexPose> host, target;
  VertexHandle<VertexInverseDepth> depth;
  Matrix2 L;
};

std::vector<Observation> ObservationsOf(const Problem& problem) {
  std::vector<Observation> all;
  const auto& pool = *problem.Pool<EdgeReprojection>();
  problem.ForEachEdge<EdgeReprojection>([&](auto handle, const EdgeReprojection& edge) {
    const std::vector<AnyVertex> v = problem.VerticesOf(handle).value();
    const double* L = pool.sqrt_information(static_cast<int>(all.size()));
    all.push_back({edge, *v[0].As<VertexPose>(), *v[1].As<VertexPose>(),
                   *v[2].As<VertexInverseDepth>(), Matrix2::Zero()});
    all.back().L << L[0], L[1], L[2], L[3];
  });
  return all;
}

/// The window with each EdgeReprojection exchanged for what `make` makes of it.
template <class Make>
Problem Exchanged(const Problem& window, const Make& make, const Loss& loss = {}) {
  Problem problem = window.Clone();
  const std::vector<Observation> all = ObservationsOf(problem);
  std::vector<AnyEdge> old;
  problem.ForEachEdge<EdgeReprojection>([&](auto handle, const auto&) { old.push_back(handle); });
  for (const AnyEdge edge : old)
    (void)problem.RemoveEdge(edge);
  for (const Observation& o : all) {
    auto [edge, scale] = make(o.edge);
    EdgeOptions<decltype(edge)> options;
    options.sqrt_information = Matrix2(o.L / scale);
    options.loss = loss;
    if (!problem.AddEdge(edge, {o.host, o.target, o.depth}, options).ok()) std::abort();
  }
  return problem;
}

/// Where a camera sees a point.
Vector2 Seen(const Pose& T_w_b, const Pose& T_b_c, const VertexPointXYZ& point) {
  EdgeReprojectionXYZ edge;
  edge.T_b_c = T_b_c;
  Vector2 r = Vector2::Zero();
  if (!edge.Evaluate(VertexPose{T_w_b}, point, r, nullptr, nullptr)) std::abort();
  return r;
}

/// The same landmarks as points in the world, seen by their hosts too; by two cameras, 10 cm apart,
/// with the same residuals.
Problem AsPoints(const Problem& window, bool two_cameras = false, const Loss& loss = {}) {
  Problem problem = window.Clone();
  const std::vector<Observation> all = ObservationsOf(problem);
  std::map<std::uint32_t, VertexHandle<VertexPointXYZ>> points;
  const auto observe = [&](const Observation& o, VertexHandle<VertexPose> pose, const Vector2& uv) {
    EdgeReprojectionXYZ edge;
    edge.uv = uv;
    edge.T_b_c = o.edge.T_b_c;
    EdgeOptions<EdgeReprojectionXYZ> options;
    options.sqrt_information = o.L;
    options.loss = loss;
    const VertexHandle<VertexPointXYZ> point = points.at(o.depth.slot);
    if (!problem.AddEdge(edge, {pose, point}, options).ok()) std::abort();
    if (!two_cameras) return;
    const Pose T_w_b = problem.Get(pose).pose;
    const Vector2 left = Seen(T_w_b, edge.T_b_c, problem.Get(point));
    edge.T_b_c.p() += edge.T_b_c.R() * Vector3(0.1, 0.0, 0.0);
    edge.uv += Seen(T_w_b, edge.T_b_c, problem.Get(point)) - left;
    if (!problem.AddEdge(edge, {pose, point}, options).ok()) std::abort();
  };
  for (const Observation& o : all) {
    if (!points.contains(o.depth.slot)) {
      const Vector3 x_c =
          Vector3(o.edge.uv_host[0], o.edge.uv_host[1], 1.0) / problem.Get(o.depth).rho;
      const Pose T_w_c = problem.Get(o.host).pose * o.edge.T_b_c;
      points[o.depth.slot] = problem.AddVertex(VertexPointXYZ(T_w_c.R() * x_c + T_w_c.p()));
      observe(o, o.host, o.edge.uv_host);
    }
    observe(o, o.target, o.edge.uv_target);
  }
  std::vector<AnyVertex> depths;
  problem.ForEachVertex<VertexInverseDepth>(
      [&](auto handle, const auto&) { depths.push_back(handle); });
  for (const AnyVertex depth : depths)
    (void)problem.RemoveVertex(depth);
  return problem;
}

/// Half of the poses were linearized 2 cm and half a degree away.
void MoveFirstEstimates(Problem* problem) {
  int k = 0;
  std::vector<VertexHandle<VertexPose>> poses;
  problem->ForEachVertex<VertexPose>([&](auto handle, const auto&) { poses.push_back(handle); });
  for (const auto handle : poses) {
    if (++k % 2 == 0) continue;
    Pose x = problem->Get(handle).pose;
    x.p() += Vector3(0.01 * std::sin(k), 0.01 * std::cos(k), 0.01);
    x.q() = Quaternion(x.q() * so3::ExpQuaternion(Vector3(0.005 * std::cos(k), 0.005, 0.0)));
    x.Normalize();
    (void)problem->SetFirstEstimate(handle, {x.data, 7});
  }
}

SolveOptions EightSteps() {
  SolveOptions options;
  options.max_iterations = 8;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  options.initial_lambda = 1e-4;
  return options;
}

/// Milliseconds a step, accepted or not.
double TimeOf(Problem* problem, const Snapshot& begin) {
  (void)problem->RestoreSnapshot(begin);
  const double start = ThreadSeconds();
  const SolveSummary& summary = problem->Solve(EightSteps());
  const double ms = 1e3 * (ThreadSeconds() - start);
  if (!summary.ok()) std::fprintf(stderr, "%s\n", summary.status.message().c_str());
  return ms / std::max(1, summary.accepted_steps + summary.rejected_steps);
}

struct Row {
  const char* name;
  std::function<std::pair<Problem, Problem>(const Problem&)> make;  ///< reference, other
  bool per_residual = false;
};

template <class Make>
Row Against(const char* name, Make make, Loss loss = {}) {
  return {name, [=](const Problem& window) {
            return std::pair(window.Clone(), Exchanged(window, make, loss));
          }};
}

std::vector<Row> Rows() {
  std::vector<Row> rows;
  rows.push_back(Against("own edge, in packs", [](const EdgeReprojection& e) {
    return std::pair(test::CopyOf<test::ReprojectionInPacks>(e), 1.0);
  }));
  rows.push_back(Against("own edge, one at a time", [](const EdgeReprojection& e) {
    return std::pair(test::CopyOf<test::ReprojectionOneByOne>(e), 1.0);
  }));
  rows.push_back(Against("own edge, no Jacobians", [](const EdgeReprojection& e) {
    return std::pair(test::CopyOf<test::ReprojectionResidual>(e), 1.0);
  }));
  const auto stereo = [](const EdgeReprojection& e) {
    EdgeReprojectionStereo edge;
    edge.uv_host = e.uv_host;
    edge.uv_target = e.uv_target;
    edge.T_b_host = edge.T_b_target = e.T_b_c;
    return std::pair(edge, 1.0);
  };
  rows.push_back(Against("EdgeReprojectionStereo", stereo));
  rows.push_back(Against("EdgeReprojectionOf<CameraPinhole>", [](const EdgeReprojection& e) {
    auto edge = test::CopyOf<EdgeReprojectionOf<CameraPinhole>>(e);
    edge.camera = CameraPinhole{400.0, 410.0, 320.0, 240.0};
    edge.uv_target = Vector2(400.0 * e.uv_target[0] + 320.0, 410.0 * e.uv_target[1] + 240.0);
    return std::pair(edge, 400.0);
  }));
  rows.push_back(Against(
      "Cauchy's loss", [](const EdgeReprojection& e) { return std::pair(e, 1.0); }, Cauchy{2.0}));
  rows.push_back({"EdgeReprojectionXYZ, per residual",
                  [](const Problem& window) { return std::pair(window.Clone(), AsPoints(window)); },
                  true});
  rows.push_back({"EdgeReprojectionXYZ, two cameras",
                  [](const Problem& window) {
                    Problem points = AsPoints(window, true, Cauchy{2.0});
                    MoveFirstEstimates(&points);
                    return std::pair(window.Clone(), std::move(points));
                  },
                  true});
  const auto full = [](const Problem& window) {
    Problem moved = window.Clone();
    MoveFirstEstimates(&moved);
    Problem prior_only = moved.Clone();
    (void)prior_only.SetFirstEstimates(FirstEstimates::kPriorOnly);
    return std::pair(std::move(prior_only), std::move(moved));
  };
  rows.push_back({"first estimates in full, mono", full});
  rows.push_back({"first estimates in full, stereo",
                  [=](const Problem& window) { return full(Exchanged(window, stereo)); }});
  return rows;
}

void Compare(const std::string& file, const std::vector<ViowinWindow>& windows, int rounds,
             const std::string& only) {
  std::printf("%s, %zu windows, library with %s, this unit's packs of %d\n", file.c_str(),
              windows.size(), InstructionSetName(), kPackWidth);
  for (const Row& row : Rows()) {
    if (std::string(row.name).find(only) == std::string::npos) continue;
    std::vector<double> ratios, reference, other;
    for (const ViowinWindow& window : windows) {
      Problem problem;
      if (!AddToGraph(window, WindowKind::kVision, {}, &problem).ok()) std::abort();
      auto [a, b] = row.make(problem);
      const Snapshot start_a = a.GetSnapshot(), start_b = b.GetSnapshot();
      const double residuals_a =
          a.Pool<EdgeReprojection>() != nullptr ? static_cast<double>(a.NumEdges()) : 1.0;
      const double per = row.per_residual ? static_cast<double>(b.NumEdges()) / residuals_a : 1.0;
      std::vector<double> ms_a, ms_b;
      TimeOf(&a, start_a);
      TimeOf(&b, start_b);
      for (int round = 0; round < rounds; ++round) {
        for (int repeat = 0; repeat < 2; ++repeat)
          ms_a.push_back(TimeOf(&a, start_a));
        for (int repeat = 0; repeat < 2; ++repeat)
          ms_b.push_back(TimeOf(&b, start_b));
      }
      reference.push_back(Median(ms_a));
      other.push_back(Median(ms_b));
      ratios.push_back(other.back() / per / reference.back());
    }
    std::printf("  %-34s %7.4f ms a step, reference %7.4f, ratio %.2f\n", row.name, Median(other),
                Median(reference), Median(ratios));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::string only;
  int rounds = 3;
  for (int k = 1; k < argc; ++k) {
    const std::string arg = argv[k];
    if (arg == "--rounds" && k + 1 < argc) {
      rounds = std::max(1, std::atoi(argv[++k]));
    } else if (arg == "--only" && k + 1 < argc) {
      only = argv[++k];  // rows whose name has it
    } else if (arg.rfind("--", 0) == 0) {
      std::fprintf(
          stderr,
          "bench_edges: unknown option %s\nbench_edges [--rounds N] [--only TEXT] FILE...\n",
          arg.c_str());
      return 2;
    } else {
      files.push_back(arg);
    }
  }
  for (const std::string& file : files) {
    const auto windows = ReadViowin(file);
    if (!windows.ok()) {
      std::fprintf(stderr, "bench_edges: %s\n", windows.status().message().c_str());
      return 2;
    }
    Compare(file, *windows, rounds, only);
  }
  return files.empty() ? 2 : 0;
}
