// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks with records: a linearization leaves nothing of the one before, and their elimination
// in batches is that of one landmark after the other.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <random>
#include <vector>

#include "common/sanitized.h"
#include "glissade/glissade.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "support/dense_reference.h"
#include "support/dynamic_edges.h"
#include "support/graph_random.h"
#include "support/template_edges.h"
#include "support/user_types.h"

namespace glissade {
namespace {

using test::Normal;
using test::OffsetInPacks;
using test::RangeInPacks;

/// Poses and points; every point is seen from every pose, by a range and sometimes by an offset.
struct Scene {
  Graph graph;
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexPointXYZ>> points;
};

Scene MakeScene(int num_poses, int num_points, unsigned seed) {
  std::mt19937 engine(seed);
  Scene scene;
  for (int k = 0; k < num_poses; ++k) {
    const Vector3 p(0.5 * k, Normal(engine, 0.2), Normal(engine, 0.2));
    scene.poses.push_back(
        scene.graph.AddVertex(VertexPose{Pose(so3::ExpQuaternion(Vector3(0.1 * k, 0, 0)), p)}));
  }
  for (int l = 0; l < num_points; ++l) {
    scene.points.push_back(scene.graph.AddVertex(VertexPointXYZ(
        Vector3(Normal(engine, 2.0), Normal(engine, 2.0), Normal(engine, 1.0) + 6.0))));
    for (int k = 0; k < num_poses; ++k) {
      const auto pose = scene.poses[static_cast<std::size_t>(k)];
      EXPECT_TRUE(scene.graph.AddEdge(RangeInPacks{5.0}, {pose, scene.points.back()}).ok());
      if ((k + l) % 3 == 0) {
        const OffsetInPacks offset{Vector3(Normal(engine, 1.0), 0.5, 5.0)};
        EXPECT_TRUE(scene.graph.AddEdge(offset, {pose, scene.points.back()}).ok());
      }
    }
  }
  return scene;
}

struct System {
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;

  void Linearize(Graph* graph) {
    StructureOptions options;
    options.allow_duplicate_observations = true;
    ASSERT_TRUE(structure.Analyze(graph, options).ok());
    double cost = 0.0;
    ASSERT_TRUE(equations.Linearize(structure, graph, &threads, &cost).ok());
  }
};

/// Records against a dense Jacobian, edge by edge.
void ExpectDense(System* system, const Graph& graph) {
  const Hessian H = system->equations.GetHessian(system->structure);
  std::vector<AnyVertex> order;
  for (const PoseBlock& pose : system->structure.poses())
    order.push_back(
        graph.vertex_pools()[static_cast<std::size_t>(pose.pool)]->HandleAt(pose.index));
  for (const LandmarkBlock& l : system->structure.landmarks())
    order.push_back(graph.vertex_pools()[static_cast<std::size_t>(l.pool)]->HandleAt(l.index));
  const test::DenseReference dense(graph, order);
  const Eigen::MatrixXd expected = dense.H();
  const Eigen::VectorXd b = dense.b();
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const double largest = expected.cwiseAbs().maxCoeff();
  Eigen::Index at = system->structure.num_pose_scalars();
  for (std::size_t l = 0; l < H.num_landmarks(); ++l, at += 3) {
    const Hessian::LandmarkPart part = H.Landmark(l);
    const auto close = [&](const DenseBlock& block, const Eigen::MatrixXd& of) {
      return (Eigen::Map<const RowMajor>(block.data, block.rows, block.cols) - of)
                 .cwiseAbs()
                 .maxCoeff() < 1e-12 * largest;
    };
    ASSERT_TRUE(close(part.H(), expected.block(at, at, 3, 3))) << l;
    ASSERT_LT((Eigen::Map<const Eigen::Vector3d>(part.b()) - b.segment(at, 3)).norm(),
              1e-12 * b.norm());
    for (int s = 0; s < part.num_slots(); ++s)
      ASSERT_TRUE(close(part.W(s), expected.block(part.row(s), at, 6, 3))) << l << " slot " << s;
  }
}

// Runs set what they are the first to reach, and add to the rest. An edge twice, two types on the
// same vertices, and edges that are in no run are what could find, or leave, old numbers there.
TEST(LandmarkRecords, HaveNothingOfTheLinearizationBefore) {
  for (const bool twice : {false, true}) {
    for (const bool dynamic : {false, true}) {
      SCOPED_TRACE(testing::Message() << twice << dynamic);
      Scene scene = MakeScene(4, 90, 3);
      if (twice) {
        for (std::size_t l = 0; l < scene.points.size(); l += 7) {
          const VertexHandle<VertexPose> pose = scene.poses[l % 4];
          EXPECT_TRUE(scene.graph.AddEdge(RangeInPacks{4.0}, {pose, scene.points[l]}).ok());
        }
      }
      if (dynamic) {
        test::GraphRandom random(5);
        const std::vector<AnyVertex> vertices{scene.poses[1], scene.points[2]};
        const VertexPose pose = scene.graph.Get(scene.poses[1]);
        const VertexPointXYZ point = scene.graph.Get(scene.points[2]);
        const VertexRef refs[] = {{&kVertexOps<VertexPose>, pose.Data()},
                                  {&kVertexOps<VertexPointXYZ>, point.Data()}};
        EXPECT_TRUE(
            scene.graph.AddEdge(std::make_unique<test::SineEdge>(refs, 2, &random), vertices).ok());
      }
      System system;
      ASSERT_NO_FATAL_FAILURE(system.Linearize(&scene.graph));
      ASSERT_NO_FATAL_FAILURE(ExpectDense(&system, scene.graph));
      for (const auto& point : scene.points) {
        VertexPointXYZ moved = scene.graph.Get(point);
        for (double& x : moved.data)
          x += 0.7;
        ASSERT_TRUE(scene.graph.Set(point, moved).ok());
      }
      ASSERT_NO_FATAL_FAILURE(system.Linearize(&scene.graph));
      ASSERT_NO_FATAL_FAILURE(ExpectDense(&system, scene.graph));
    }
  }
}

TEST(LandmarkRecords, EliminatedInBatchesAreOneAfterTheOther) {
  // More slots than one batch takes, on few vertices and on many.
  for (const auto& [num_poses, num_points] :
       {std::pair{5, test::kSanitized ? 300 : 900}, std::pair{40, test::kSanitized ? 30 : 120}}) {
    SCOPED_TRACE(num_poses);
    Scene scene = MakeScene(num_poses, num_points, 8);
    System system;
    ASSERT_NO_FATAL_FAILURE(system.Linearize(&scene.graph));
    const DampingTerm damping{.lambda = 1.0, .identity = true};
    const Hessian H = system.equations.GetHessian(system.structure);
    const Eigen::Index n = system.structure.num_pose_scalars();
    Eigen::MatrixXd expected = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd rhs = Eigen::Map<const Eigen::VectorXd>(system.equations.b().data(), n);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto map = [](const DenseBlock& b) {
      return Eigen::Map<const RowMajor>(b.data, b.rows, b.cols);
    };
    for (std::size_t k = 0; k < H.num_pairs(); ++k) {
      const Hessian::PosePair pair = H.Pair(k);
      expected.block(H.offset(pair.row), H.offset(pair.col), pair.H.rows, pair.H.cols) +=
          map(pair.H);
    }
    for (std::size_t l = 0; l < H.num_landmarks(); ++l) {
      const Hessian::LandmarkPart part = H.Landmark(l);
      const Eigen::Matrix3d inverse =
          (Eigen::Matrix3d(map(part.H())) + Eigen::Matrix3d::Identity()).inverse();
      const Eigen::Map<const Eigen::Vector3d> b(part.b());
      for (int i = 0; i < part.num_slots(); ++i) {
        const Eigen::MatrixXd Y = map(part.W(i)) * inverse;
        rhs.segment(part.row(i), Y.rows()) -= Y * b;
        for (int j = 0; j <= i; ++j) {
          expected.block(part.row(i), part.row(j), Y.rows(), part.W(j).rows) -=
              Y * map(part.W(j)).transpose();
        }
      }
    }
    expected.triangularView<Eigen::StrictlyUpper>() = expected.transpose();
    for (const int num_threads : {1, 2, 4}) {
      system.threads.Resize(num_threads);
      for (const SchurForm form : {SchurForm::kDense, SchurForm::kBlocks}) {
        ASSERT_TRUE(system.equations
                        .Eliminate(system.structure, scene.graph, damping, form, &system.threads)
                        .ok());
        Eigen::MatrixXd S(n, n);
        for (Eigen::Index k = 0; k < n; ++k) {
          const Eigen::VectorXd e = Eigen::VectorXd::Unit(n, k);
          system.equations.reduced().Multiply(e.data(), S.col(k).data());
        }
        EXPECT_LT((S - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
        const Eigen::Map<const Eigen::VectorXd> found(system.equations.reduced_rhs().data(), n);
        EXPECT_LT((found - rhs).cwiseAbs().maxCoeff(), 1e-12 * rhs.cwiseAbs().maxCoeff());
      }
    }
  }
}

}  // namespace
}  // namespace glissade
