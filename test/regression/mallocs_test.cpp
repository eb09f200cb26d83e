// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Vertices, residuals and Jacobians were returned by value, each a matrix on the heap: 10 poses and
// 1000 landmarks took 1.99 million mallocs in 5 iterations.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

#include "glissade/edges/reprojection.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/random.h"
#include "regression/malloc_count.h"

namespace glissade {
namespace {

/// An observation written the course's way: everything by value, on the heap.
struct EdgeByValue : EdgeReprojection {
  static std::vector<Eigen::VectorXd> Parameters(const VertexPose& host, const VertexPose& target,
                                                 const VertexInverseDepth& depth) {
    return {Eigen::Map<const Eigen::VectorXd>(host.Data(), 7),
            Eigen::Map<const Eigen::VectorXd>(target.Data(), 7),
            Eigen::Map<const Eigen::VectorXd>(depth.Data(), 1)};
  }
  [[nodiscard]] Eigen::VectorXd Residual(const std::vector<Eigen::VectorXd>& x,
                                         std::vector<Eigen::MatrixXd>* jacobians) const {
    VertexPose poses[2];
    for (std::size_t k = 0; k < 2; ++k)
      std::copy(x[k].data(), x[k].data() + 7, poses[k].Data());
    Vector2 r;
    Jacobian<2, 6> J_host, J_target;
    Jacobian<2, 1> J_rho;
    EdgeReprojection::Evaluate(poses[0], poses[1], VertexInverseDepth{x[2][0]}, r, &J_host,
                               &J_target, &J_rho);
    *jacobians = {J_host, J_target, J_rho};
    return r;
  }
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_rho) const {
    std::vector<Eigen::MatrixXd> jacobians;
    r = Residual(Parameters(host, target, depth), &jacobians);
    if (d_r_d_host) *d_r_d_host = jacobians[0];
    if (d_r_d_target) *d_r_d_target = jacobians[1];
    if (d_r_d_rho) *d_r_d_rho = jacobians[2];
    return r.allFinite();
  }
};

/// 10 poses along a line, 1000 landmarks of pose 0 seen by all others.
template <class Edge>
void Build(Problem& problem) {
  sim::MinstdRand0 engine;
  sim::NormalReal noise(0.0, 1e-3);
  std::vector<VertexHandle<VertexPose>> poses;
  for (int k = 0; k < 10; ++k) {
    Pose T_w_c;
    T_w_c.data[0] = 0.3 * k;
    poses.push_back(problem.AddVertex(VertexPose{T_w_c}));
  }
  EXPECT_TRUE(problem.SetFixed(poses[0]).ok());
  EXPECT_TRUE(problem.SetFixed(poses[9]).ok());
  for (int l = 0; l < 1000; ++l) {
    const double u = sim::UniformReal(engine, -0.5, 0.5);
    const double v = sim::UniformReal(engine, -0.5, 0.5);
    const double rho = 1.0 / sim::UniformReal(engine, 4.0, 8.0);
    const auto depth = problem.AddVertex(VertexInverseDepth{1.2 * rho}).value();
    for (int k = 1; k < 10; ++k) {
      Edge edge;
      edge.uv_host = {u, v};
      edge.uv_target = {u - 0.3 * k * rho + noise(engine), v + noise(engine)};
      EXPECT_TRUE(
          problem.AddEdge(edge, {poses[0], poses[static_cast<std::size_t>(k)], depth}).ok());
    }
  }
}

struct Count {
  std::int64_t mallocs = 0;
  int iterations = 0;
  double cost = 0.0;
};

template <class Edge>
Count CountMallocs() {
  Problem problem;
  Build<Edge>(problem);
  SolveOptions options;
  options.max_iterations = 5;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  const std::int64_t before = test::MallocCount();
  const SolveSummary& summary = problem.Solve(options);
  return {test::MallocCount() - before, summary.accepted_steps + summary.rejected_steps,
          summary.final_cost};
}

/// The check: the first solve, with its analysis, allocates tables, not things: fewer calls than
/// one per ten edges in all five iterations.
bool AllocatesTablesOnly(const Count& count) {
  return count.mallocs < 9000 / 10;
}

TEST(Mallocs, AFirstSolveOfTenPosesAndAThousandLandmarks) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "malloc cannot be counted in this build";
  const Count ours = CountMallocs<EdgeReprojection>();
  const Count by_value = CountMallocs<EdgeByValue>();
  EXPECT_EQ(ours.iterations, 5);
  EXPECT_EQ(by_value.iterations, 5);
  EXPECT_NEAR(ours.cost, by_value.cost, 1e-9 * ours.cost);
  EXPECT_TRUE(AllocatesTablesOnly(ours)) << ours.mallocs;
  EXPECT_FALSE(AllocatesTablesOnly(by_value)) << by_value.mallocs;
  RecordProperty("mallocs", std::to_string(ours.mallocs));
  RecordProperty("mallocs_by_value", std::to_string(by_value.mallocs));
}

}  // namespace
}  // namespace glissade
