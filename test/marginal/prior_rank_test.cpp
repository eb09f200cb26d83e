// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// How many rows a prior in square-root form has: as many as there are directions with information,
// none of rounding for those that nothing observes, and all of those that are only badly scaled.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/marginal/marginalize.h"
#include "glissade/vertices/vector.h"
#include "support/dense_reference.h"
#include "support/gauge_scene.h"

namespace glissade {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Scene {
  std::string name;
  test::GaugeSceneOptions options;
  int gauge_dim;
};

std::vector<Scene> Scenes() {
  std::vector<Scene> scenes(3);
  for (Scene& scene : scenes) {
    scene.options.num_frames = 7;
    scene.options.imu = false;
    scene.options.views = 7;
  }
  scenes[0].name = "mono, inverse depths";
  scenes[0].gauge_dim = 7;
  scenes[1].name = "mono, points";
  scenes[1].options.inverse_depth = false;
  scenes[1].gauge_dim = 7;
  scenes[2].name = "relative poses";
  scenes[2].options.relative_poses = true;
  scenes[2].gauge_dim = 6;
  return scenes;
}

/// All landmarks and the oldest pose go, then pose after pose: 36 variables stay, of which a mono
/// scene leaves 7 directions open, then 30, and so on.
TEST(PriorRank, AGaugeFreePriorHasNoRowsOfRounding) {
  for (const Scene& kind : Scenes()) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      test::GaugeScene scene(seed, kind.options);
      std::vector<AnyVertex> out = scene.points;
      for (std::size_t k = 0; k + 2 < scene.poses.size(); ++k) {
        out.emplace_back(scene.poses[k]);
        const auto done = scene.problem.Marginalize(out);
        ASSERT_TRUE(done.ok()) << done.status().message();
        // Neighbours by relative poses only: not all of the scene comes under the prior at once.
        const int due = done->tangent_dim - kind.gauge_dim;
        EXPECT_EQ(done->rows, due) << kind.name << ", seed " << seed << ", pose " << k;
        EXPECT_EQ(done->tangent_dim, static_cast<int>(6 * (6 - k)));
        out.clear();
      }
    }
  }
}

/// The rows that are left out said nothing: J'J and J'r are those of a dense QR in long double.
TEST(PriorRank, WithoutRowsOfRoundingTheQuadraticFormIsTheSame) {
  for (Scene kind : Scenes()) {
    kind.options.num_points = 25;  // long double is slow
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const test::GaugeScene scene(seed, kind.options);
      std::vector<AnyVertex> order = scene.points;
      order.emplace_back(scene.poses[0]);
      const auto prior = scene.problem.ComputeMarginalPrior(order);
      ASSERT_TRUE(prior.ok()) << prior.status().message();
      order.insert(order.end(), prior->vertices.begin(), prior->vertices.end());
      Graph graph = scene.problem.Graph::Clone();
      for (const AnyEdge& edge : graph.Edges()) {  // relative poses of those that stay
        bool folded = false;
        for (const AnyVertex& vertex : graph.VerticesOf(edge).value())
          folded |= vertex == AnyVertex(scene.poses[0]) || vertex.type == scene.points[0].type;
        if (folded) continue;
        ASSERT_TRUE(graph.RemoveEdge(edge).ok());
      }
      const test::DenseReference dense(graph, order);
      const Eigen::Index n = prior->tangent_dim, m = dense.J.cols() - n;
      MatrixXl stack(dense.J.rows(), dense.J.cols() + 1);
      stack << dense.J.cast<long double>(), dense.r.cast<long double>();
      const Eigen::HouseholderQR<MatrixXl> qr(stack);
      const MatrixXl R = qr.matrixQR().topRows(m + n).triangularView<Eigen::Upper>();
      const MatrixXl J = R.block(m, m, n, n);
      const MatrixXl exact = J.transpose() * J;
      const MatrixXl gradient = J.transpose() * R.block(m, m + n, n, 1);

      const Eigen::Map<const RowMajor> J_prior(prior->jacobian.data(), prior->rows(), n);
      const Eigen::Map<const Eigen::VectorXd> r0(prior->r0.data(), prior->rows());
      EXPECT_LT(test::HessianError(J_prior.transpose() * J_prior, exact.cast<double>()), 1e-13)
          << kind.name << ", seed " << seed;
      EXPECT_LT(test::RelativeError(J_prior.transpose() * r0, gradient.cast<double>()), 1e-11)
          << kind.name << ", seed " << seed;
    }
  }
}

/// Differences known to 1e-6 and a sum known to 1e4: ten orders of magnitude apart in J, twenty in
/// H. Badly scaled is not unobserved.
TEST(PriorRank, LittleInformationBesideMuchIsKept) {
  using Vertex = VertexVector<4>;
  constexpr double kMuch = 1e6, kLittle = 1e-4;
  Graph graph;
  std::vector<AnyVertex> vertices;
  for (int k = 0; k < 3; ++k)
    vertices.emplace_back(graph.AddVertex(Vertex{}).value());
  const auto add = [&](const std::vector<AnyVertex>& touched, const std::vector<double>& weights) {
    RowMajor J = RowMajor::Zero(4, 4 * static_cast<Eigen::Index>(touched.size()));
    for (int i = 0; i < 4; ++i) {
      for (std::size_t v = 0; v < touched.size(); ++v)
        J(i, 4 * static_cast<Eigen::Index>(v) + i) = weights[v];
    }
    const std::vector<const VertexOps*> types(touched.size(), &kVertexOps<Vertex>);
    auto edge = EdgeMarginalPrior::Create(types, std::vector<double>(4 * touched.size(), 0.0),
                                          std::vector<double>(4, 0.5),
                                          {J.data(), static_cast<std::size_t>(J.size())});
    ASSERT_TRUE(edge.ok());
    ASSERT_TRUE(graph.AddEdge(std::unique_ptr<DynamicEdge>(std::move(edge).value()), touched).ok());
  };
  add({vertices[0]}, {kLittle});
  add({vertices[0], vertices[1]}, {kMuch, -kMuch});
  add({vertices[0], vertices[2]}, {kMuch, -kMuch});
  const auto prior = ComputeMarginalPrior(graph, std::span(vertices).first(1));
  ASSERT_TRUE(prior.ok());
  ASSERT_EQ(prior->rows(), 8);
  const Eigen::Map<const RowMajor> J(prior->jacobian.data(), 8, 8);
  for (int i = 0; i < 4; ++i) {
    Eigen::VectorXd together = Eigen::VectorXd::Zero(8);
    together[i] = together[4 + i] = 1.0;
    EXPECT_NEAR((J * together).norm(), kLittle, 1e-5 * kLittle);
  }
}

}  // namespace
}  // namespace glissade
