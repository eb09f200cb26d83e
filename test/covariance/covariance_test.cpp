// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/covariance/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "support/dense_reference.h"
#include "support/gauge_scene.h"
#include "support/random_graph.h"

// Blocks through the elimination against the inverse of the dense H, and what a graph without
// enough information is told.

namespace glissade::test {
namespace {

double BlockError(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double scale) {
  return (a - b).norm() / scale;
}

TEST(CovarianceBlocks, AreThoseOfTheDenseInverse) {
  double worst = 0.0;
  for (const GraphKind kind : kAllGraphKinds) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(ToString(kind) + " seed " + std::to_string(seed));
      RandomGraphOptions options;
      options.fixes = seed % 2 == 1;
      options.removals = seed % 3 == 1;
      Problem problem(MakeRandomGraph(kind, seed, options));
      ASSERT_TRUE(problem.MakeHessian().ok());
      const std::vector<AnyVertex> vertices = problem.FreeVertices();
      const Eigen::MatrixXd H = problem.Hessian();
      const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
      const Eigen::MatrixXd inverse = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
      const std::vector<int> offsets = problem.FreeOffsets();
      const auto joint = ComputeCovariance(&problem, vertices);
      if (!joint.ok()) {
        // A landmark or a user's vertex may be seen too little: then H says so too.
        EXPECT_EQ(joint.status().code(), StatusCode::kSingular);
        EXPECT_GT(scaled.inverse().norm(), 1e10) << joint.status().message();
        continue;
      }
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        // Partly fixed ones are compared in their free coordinates: E^+ C E^+'.
        const auto free = [&](std::size_t k) -> Eigen::MatrixXd {
          for (const FreeTangent& tangent : problem.free_tangents()) {
            if (tangent.vertex != vertices[k]) continue;
            const Eigen::Map<
                const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
                E(tangent.basis, tangent.tangent_dim, tangent.free_dim);
            return (E.transpose() * E).inverse() * E.transpose();
          }
          const int dim = joint->offsets[k + 1] - joint->offsets[k];
          return Eigen::MatrixXd::Identity(dim, dim);
        };
        const auto dense = [&](std::size_t a, std::size_t b) {
          return inverse.block(offsets[a], offsets[b], offsets[a + 1] - offsets[a],
                               offsets[b + 1] - offsets[b]);
        };
        for (std::size_t j = 0; j < vertices.size(); ++j) {
          const Eigen::MatrixXd block =
              free(i) * joint->Block(vertices[i], vertices[j]) * free(j).transpose();
          const double size = std::sqrt(dense(i, i).norm() * dense(j, j).norm());
          const double error = BlockError(block, dense(i, j), size);
          worst = std::max(worst, error);
          ASSERT_LT(error, 1e-8) << i << ", " << j;
        }
      }
    }
  }
  std::printf("[          ] largest relative error of a block: %.2g\n", worst);
}

TEST(CovarianceBlocks, DoNotDependOnWhatElseIsAskedForNorOnThreads) {
  GaugeScene scene(1);
  Covariance one, two;
  const Gauge gauge = Gauge::Fixed{scene.poses[0]};
  ASSERT_TRUE(one.Compute(&scene.problem, {.gauge = gauge}).ok());
  ASSERT_TRUE(two.Compute(&scene.problem, {.gauge = gauge, .num_threads = 2}).ok());
  const auto all = one.Joint(scene.problem.Vertices());
  const auto few = two.Joint({scene.points[5], scene.poses[3]});
  ASSERT_TRUE(all.ok() && few.ok());
  const auto same = [&](AnyVertex a, AnyVertex b) {
    return BlockError(few->Block(a, b), all->Block(a, b), all->Block(a, b).norm());
  };
  EXPECT_LT(same(scene.points[5], scene.poses[3]), 1e-12);
  EXPECT_LT(same(scene.poses[3], scene.poses[3]), 1e-12);
  const Eigen::MatrixXd anchor = all->Block(scene.poses[0]);
  EXPECT_EQ(anchor.topRows(3).norm(), 0.0) << "the anchor's position is certain";
  EXPECT_GT(anchor.bottomRightCorner(3, 3).norm(), 0.0);
  const Vector3 yaw = scene.problem.Get(scene.poses[0]).pose.R().row(2).transpose();
  EXPECT_LT((anchor.bottomRightCorner(3, 3) * yaw).norm(), 1e-14 * anchor.norm());
}

TEST(CovarianceBlocks, AFreeGaugeIsNamed) {
  GaugeScene scene(2);
  Covariance covariance;
  const Status status = covariance.Compute(&scene.problem);
  EXPECT_EQ(status.code(), StatusCode::kSingular);
  EXPECT_NE(status.message().find("4 directions"), std::string::npos) << status.message();
  ASSERT_FALSE(covariance.Uninformed().empty());
  EXPECT_EQ(covariance.Uninformed()[0].type, &kTypeInfo<VertexPose>) << status.message();
  EXPECT_TRUE(status.vertex());
  EXPECT_EQ(covariance.Joint({scene.poses[0]}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(covariance.Compute(&scene.problem, {.gauge = Gauge::Fixed{scene.poses[0]}}).ok());
}

TEST(CovarianceBlocks, VerticesWithoutInformationAreNamed) {
  GaugeScene scene(3, {.inverse_depth = false});
  Problem& problem = scene.problem;
  const Gauge gauge = Gauge::Fixed{scene.poses[0]};
  // Two points seen once, each: no depth.
  std::vector<AnyVertex> expected;
  for (int k = 0; k < 2; ++k) {
    const auto point = problem.AddVertex(VertexPointXYZ(5.0 + k, 1.0, 1.0));
    expected.emplace_back(point.value());
    ASSERT_TRUE(problem
                    .AddEdge(EdgeReprojectionXYZ{.uv = Vector2(0.1, 0.1), .T_b_c = scene.T_b_c},
                             {scene.poses[2], point})
                    .ok());
  }
  Covariance covariance;
  Status status = covariance.Compute(&problem, {.gauge = gauge});
  EXPECT_EQ(status.code(), StatusCode::kSingular);
  EXPECT_EQ(covariance.Uninformed(), expected);
  EXPECT_EQ(status.vertex(), expected[0]);
  for (const AnyVertex& vertex : expected) {
    EXPECT_NE(status.message().find(ToString(vertex)), std::string::npos) << status.message();
    ASSERT_TRUE(problem.RemoveVertex(vertex).ok());
  }
  // A pose whose rotation alone is measured.
  const auto pose = problem.AddVertex(VertexPose());
  EdgeOptions<EdgeRelativePose> rotation;
  rotation.sqrt_information = Matrix6::Identity();
  rotation.sqrt_information->topRows<3>().setZero();
  ASSERT_TRUE(problem.AddEdge(EdgeRelativePose{Pose()}, {scene.poses[1], pose}, rotation).ok());
  status = covariance.Compute(&problem, {.gauge = gauge});
  EXPECT_EQ(status.code(), StatusCode::kSingular);
  EXPECT_EQ(covariance.Uninformed(), std::vector<AnyVertex>{pose.value()});
  EXPECT_NE(status.message().find("3 directions"), std::string::npos) << status.message();
}

TEST(CovarianceBlocks, Refusals) {
  GaugeScene scene(4);
  Covariance covariance;
  EXPECT_EQ(covariance.Joint({scene.poses[0]}).status().code(), StatusCode::kInvalidArgument);
  const auto lonely = scene.problem.AddVertex(VertexPose());
  ASSERT_TRUE(scene.problem.SetFixed(scene.poses[0]).ok());
  ASSERT_TRUE(covariance.Compute(&scene.problem).ok());
  EXPECT_EQ(covariance.Joint({lonely.value()}).status().code(), StatusCode::kSingular);
  EXPECT_EQ(covariance.Joint({VertexHandle<VertexPose>{}}).status().code(),
            StatusCode::kUnknownHandle);
  EXPECT_EQ(covariance.Joint({scene.poses[1], scene.poses[1]}).status().code(),
            StatusCode::kRepeatedVertex);
  EXPECT_EQ(covariance.Joint({scene.poses[0]})->Matrix().norm(), 0.0) << "fixed: certain";
  EXPECT_FALSE(covariance.Compute(&scene.problem, {.num_threads = 0}).ok());
  EXPECT_FALSE(covariance.Compute(&scene.problem, {.min_pivot = -1.0}).ok());
  EXPECT_EQ(covariance.Compute(&scene.problem, {.gauge = Gauge::Fixed{}}).code(),
            StatusCode::kUnknownHandle);
}

}  // namespace
}  // namespace glissade::test
