// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections that a kernel evaluates from measurements to sums, with cameras that have focal
// lengths and weights that differ by axis, against the same edges one by one, whose values are
// their own.

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "common/random_states.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "linear/both_paths.h"
#include "linear/pose_row.h"

namespace glissade {
namespace {

using test::kLeftCamera, test::kRightCamera;

struct TwoViewsCase {
  CameraPinhole camera;
  Vector2 root = Vector2(1.0, 1.0);  ///< diagonal of L
  bool loss = false;
};

/// Landmarks that all poses after their first one see.
class Scene {
 public:
  explicit Scene(const TwoViewsCase& c) : case_(c) {
    poses_ = test::AddPoseRow(6, Vector3::Zero(), &random_, &graph_);
  }
  Graph TakeGraph() { return std::move(graph_); }

  void AddDepths(bool stereo) {
    for (int l = 0; l < 60; ++l) {
      const std::size_t host = static_cast<std::size_t>(l) % 4;
      const Vector2 ray = random_.Vec3(0.3).head<2>();
      const double rho = 0.2 + 0.1 * random_.Uniform(0.0, 1.0);
      const auto depth = graph_.AddVertex(VertexInverseDepth{rho});
      const Pose T_w_h = graph_.Get(poses_[host]).pose * kLeftCamera;
      const Vector3 X = T_w_h * Vector3(ray[0] / rho, ray[1] / rho, 1.0 / rho);
      for (std::size_t target = host + 1; target < poses_.size(); ++target) {
        EdgeReprojectionOf<CameraPinhole> edge{ray, Seen(X, target, kLeftCamera), kLeftCamera,
                                               case_.camera};
        Add(edge, {poses_[host], poses_[target], depth});
        if (!stereo) continue;
        EdgeReprojectionStereoOf<CameraPinhole> other;
        other.uv_host = ray;
        other.uv_target = Seen(X, target, kRightCamera);
        other.T_b_host = kLeftCamera;
        other.T_b_target = kRightCamera;
        other.camera = case_.camera;
        Add(other, {poses_[host], poses_[target], depth});
      }
    }
  }
  void AddPoints() {
    for (int l = 0; l < 60; ++l) {
      const Vector3 X = random_.Vec3(1.0) + Vector3(0.8, 0.0, 5.0);
      const auto point = graph_.AddVertex(VertexPointXYZ{X + random_.Vec3(0.05)});
      for (std::size_t k = static_cast<std::size_t>(l) % 3; k < poses_.size(); ++k) {
        EdgeReprojectionXYZOf<CameraPinhole> edge;
        edge.uv = Seen(X, k, kRightCamera);
        edge.T_b_c = kRightCamera;
        edge.camera = case_.camera;
        Add(edge, {poses_[k], point});
      }
    }
  }

 private:
  [[nodiscard]] Vector2 Seen(const Vector3& X, std::size_t pose, const Pose& T_b_c) {
    const Vector3 x = (graph_.Get(poses_[pose]).pose * T_b_c).Inverse() * X;
    Vector2 uv;
    EXPECT_TRUE(case_.camera.Project(x, uv, nullptr));
    return uv + random_.Vec3(1.0).head<2>();
  }
  template <class E>
  void Add(const E& edge, const EdgeVertexHandles<E>& vertices) {
    EdgeOptions<E> options;
    options.sqrt_information = Matrix2(case_.root.asDiagonal());
    if (case_.loss) options.loss = Cauchy{1.5};
    EXPECT_TRUE(graph_.AddEdge(edge, vertices, options).ok());
  }

  TwoViewsCase case_;
  test::Random random_{11};
  Graph graph_;
  std::vector<VertexHandle<VertexPose>> poses_;
};

void ExpectSameBothWays(Graph graph) {
  const DampingTerm damping{.lambda = 1e-3};
  test::PathOutcome groups(&graph, true, damping), single(&graph, false, damping);
  EXPECT_EQ(groups.structure.groups().num_landmarks, 60);
  EXPECT_NEAR(groups.cost, single.cost, 1e-12 * single.cost);
  test::ExpectSame(&groups, single, 1e-9);
  // The cost of a trial has the bits of the cost that comes with the sums.
  double cost = 0.0;
  ASSERT_TRUE(groups.equations.Cost(groups.structure, graph, &groups.threads, &cost).ok());
  EXPECT_EQ(cost, groups.cost);
}

TEST(TwoViews, OfPinholeCamerasAreThoseOfTheirEdges) {
  const CameraPinhole square{400.0, 400.0, 320.0, 240.0}, other{400.0, 430.0, 310.0, 250.0};
  for (const bool loss : {false, true}) {
    for (const TwoViewsCase& c :
         {TwoViewsCase{square, {1.0, 1.0}, loss}, TwoViewsCase{square, {0.5, 0.5}, loss},
          TwoViewsCase{square, {0.5, 0.8}, loss}, TwoViewsCase{other, {1.0, 1.0}, loss},
          // Rows of different focal lengths that weights make equal again.
          TwoViewsCase{other, {430.0 / 400.0, 1.0}, loss}}) {
      SCOPED_TRACE(testing::Message() << c.camera.fy << " " << c.root.transpose() << " " << loss);
      Scene points(c), depths(c), stereo(c);
      points.AddPoints();
      ExpectSameBothWays(points.TakeGraph());
      depths.AddDepths(false);
      ExpectSameBothWays(depths.TakeGraph());
      stereo.AddDepths(true);
      ExpectSameBothWays(stereo.TakeGraph());
    }
  }
}

}  // namespace
}  // namespace glissade
