// requires: ceres
// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/covariance.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "glissade/bridge/ceres.h"
#include "glissade/covariance/covariance.h"
#include "support/dense_reference.h"
#include "support/gauge_scene.h"
#include "support/random_graph.h"

// Covariance blocks of full-rank problems against Ceres.

namespace glissade::test {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// (J'J)^-1 in long double from a dense Jacobian put together edge by edge.
Eigen::MatrixXd LongInverse(Graph* graph, const std::vector<AnyVertex>& order) {
  const LongMatrix J = DenseReference(*graph, order).J.cast<long double>();
  const LongMatrix H = J.transpose() * J;
  return H.llt().solve(LongMatrix::Identity(H.rows(), H.cols())).cast<double>();
}

/// Largest |C - C_ceres| / sqrt(|C_aa| |C_bb|) over all pairs of the vertices; negative if Ceres
/// fails.
double ErrorAgainstCeres(Graph* graph, const std::vector<AnyVertex>& vertices,
                         const JointCovariance& joint,
                         ceres::CovarianceAlgorithmType algorithm = ceres::DENSE_SVD) {
  bridge::CeresProblem exported = bridge::Export(*graph);
  ceres::Covariance::Options options;
  options.algorithm_type = algorithm;
  options.min_reciprocal_condition_number = 1e-32;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> pairs;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (std::size_t j = i; j < vertices.size(); ++j) {
      pairs.emplace_back(exported.ParameterBlock(vertices[i]),
                         exported.ParameterBlock(vertices[j]));
    }
  }
  if (!covariance.Compute(pairs, &exported.problem())) return -1.0;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  // Partly fixed vertices: Ceres's tangent is the free one.
  const auto to_full = [&](AnyVertex vertex) -> Eigen::MatrixXd {
    for (const FreeTangent& tangent : graph->free_tangents()) {
      if (tangent.vertex != vertex) continue;
      return Eigen::Map<const RowMajor>(tangent.basis, tangent.tangent_dim, tangent.free_dim);
    }
    const int dim = exported.FreeDim(vertex);
    return Eigen::MatrixXd::Identity(dim, dim);
  };
  double worst = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (std::size_t j = i; j < vertices.size(); ++j) {
      RowMajor block(exported.FreeDim(vertices[i]), exported.FreeDim(vertices[j]));
      EXPECT_TRUE(covariance.GetCovarianceBlockInTangentSpace(exported.ParameterBlock(vertices[i]),
                                                              exported.ParameterBlock(vertices[j]),
                                                              block.data()));
      const Eigen::MatrixXd full = to_full(vertices[i]) * block * to_full(vertices[j]).transpose();
      const double size =
          std::sqrt(joint.Block(vertices[i]).norm() * joint.Block(vertices[j]).norm());
      worst = std::max(worst, (joint.Block(vertices[i], vertices[j]) - full).norm() / size);
    }
  }
  return worst;
}

TEST(CovarianceAgainstCeres, RandomGraphs) {
  double worst = 0.0;
  int compared = 0;
  for (const GraphKind kind : kAllGraphKinds) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(ToString(kind) + " seed " + std::to_string(seed));
      RandomGraphOptions options;
      options.fixes = seed % 2 == 1;
      Problem problem(MakeRandomGraph(kind, seed, options));
      ASSERT_TRUE(problem.MakeHessian().ok());
      const std::vector<AnyVertex> free = problem.FreeVertices();
      std::vector<AnyVertex> some;
      for (std::size_t k = 0; k < free.size(); k += 1 + free.size() / 10)
        some.push_back(free[k]);
      const auto joint = ComputeCovariance(&problem, some);
      if (!joint.ok()) continue;  // rank-deficient: covariance_test.cpp
      const double error = ErrorAgainstCeres(&problem, some, joint.value());
      if (error < 0.0) continue;
      ++compared;
      worst = std::max(worst, error);
      EXPECT_LT(error, 1e-8);
    }
  }
  EXPECT_GE(compared, 12);
  std::printf("[          ] %d graphs, largest relative error of a block: %.2g\n", compared, worst);
}

TEST(CovarianceAgainstCeres, VisualInertialWithYawAndBiasesHeld) {
  for (const bool biases : {true, false}) {
    for (const bool inverse_depth : {true, false}) {
      GaugeScene scene(5, {.biases = biases, .inverse_depth = inverse_depth});
      ASSERT_TRUE(scene.problem.SetFixed(scene.poses[0], Fix::kPositionAndYaw).ok());
      if (biases) {  // in so short a window they are hardly seen
        EdgeOptions<EdgeSpeedBiasPrior> weight;
        weight.sqrt_information = 50.0 * SquareMatrix<9>::Identity();
        const VertexSpeedBias start = scene.problem.Get(scene.speeds[0]);
        ASSERT_TRUE(
            scene.problem.AddEdge(EdgeSpeedBiasPrior{start}, {scene.speeds[0]}, weight).ok());
      }
      ASSERT_TRUE(scene.problem.Solve(Converge()).ok());
      const std::vector<AnyVertex> some{scene.poses[0],  scene.poses[1],  scene.poses[9],
                                        scene.speeds[0], scene.speeds[3], scene.points[0],
                                        scene.points[20]};
      const auto joint = ComputeCovariance(&scene.problem, some);
      ASSERT_TRUE(joint.ok()) << joint.status().message();
      ASSERT_TRUE(scene.problem.MakeHessian().ok());
      const std::vector<AnyVertex> free = scene.problem.FreeVertices();
      const std::vector<int> at = scene.problem.FreeOffsets();
      const Eigen::MatrixXd exact = LongInverse(&scene.problem, free);
      double against_exact = 0.0;
      for (const AnyVertex& a : some) {
        const auto ia =
            static_cast<std::size_t>(std::find(free.begin(), free.end(), a) - free.begin());
        const int n = at[ia + 1] - at[ia];
        if (n != joint->Block(a).rows()) continue;
        const Eigen::MatrixXd e = exact.block(at[ia], at[ia], n, n);
        against_exact = std::max(against_exact, (joint->Block(a) - e).norm() / e.norm());
      }
      const double error = ErrorAgainstCeres(&scene.problem, some, joint.value());
      EXPECT_GE(error, 0.0) << "Ceres failed";
      EXPECT_LT(error, 1e-8);
      EXPECT_LT(against_exact, 1e-8);
      const double qr = ErrorAgainstCeres(&scene.problem, some, joint.value(), ceres::SPARSE_QR);
      std::printf(
          "[          ] biases %d, inverse depths %d: %.2g, SPARSE_QR %.2g, long double %.2g\n",
          biases, inverse_depth, error, qr, against_exact);
    }
  }
}

}  // namespace
}  // namespace glissade::test
