// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks eliminated in groups against the same one by one: the same reduced system and the same
// step, whatever the graph is like.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>

#include "glissade/glissade.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/vertices/speed_bias.h"
#include "linear/both_paths.h"

namespace glissade {
namespace {

struct Scene {
  int num_poses = 6;
  int num_landmarks = 40;
  int max_track = 5;
  bool gaps = false;  // targets anywhere, not the next frames
  bool two_cameras = false;
  bool information = false;  // a different 2 x 2 per edge
  bool huber = false;        // some edges
  bool tukey = false;        // some landmarks: a loss without a kernel
  bool fixed = false;        // a pose, a landmark and part of a pose
  bool far_origin = false;   // 1 km away
  bool at_infinity = false;
};

class Builder {
 public:
  explicit Builder(unsigned seed) : engine_(seed) {}
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  int Below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

  Graph Build(const Scene& scene) {
    Graph graph;
    std::vector<VertexHandle<VertexPose>> poses;
    const double shift = scene.far_origin ? 1000.0 : 0.0;
    for (int k = 0; k < scene.num_poses; ++k) {
      const Vector3 phi(Uniform(-0.2, 0.2), Uniform(-0.2, 0.2), Uniform(-0.2, 0.2));
      const Vector3 p(shift + 0.3 * k + Uniform(-0.1, 0.1), Uniform(-0.2, 0.2) - shift,
                      Uniform(-0.2, 0.2));
      poses.push_back(graph.AddVertex(VertexPose{Pose(so3::ExpQuaternion(phi), p)}));
    }
    const Pose cameras[2] = {
        Pose(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 0.05, -0.02)),
        Pose(so3::ExpQuaternion(Vector3(-0.3, 0.1, 0.2)), Vector3(-0.2, 0.0, 0.03))};
    for (int l = 0; l < scene.num_landmarks; ++l) {
      const int host = Below(scene.num_poses);
      const double rho = scene.at_infinity && l % 7 == 0 ? 0.0 : Uniform(0.05, 0.5);
      const VertexHandle<VertexInverseDepth> depth = graph.AddVertex(VertexInverseDepth{rho});
      const int camera = scene.two_cameras ? Below(2) : 0;
      const Vector2 uv_host(Uniform(-0.5, 0.5), Uniform(-0.5, 0.5));
      const int length = 1 + Below(scene.max_track);
      std::set<int> targets;
      for (int k = 1; k <= length; ++k) {
        const int target =
            scene.gaps ? (host + k * 2) % scene.num_poses : (host + k) % scene.num_poses;
        if (target == host) continue;
        EdgeReprojection edge;
        edge.uv_host = uv_host;
        edge.uv_target = uv_host + Vector2(Uniform(-0.1, 0.1), Uniform(-0.1, 0.1));
        edge.T_b_c = cameras[camera];
        // No grazing points: a moment about a distant point cancels by the square of the ratio of
        // that distance to the depth, which is rounding and not what is compared here.
        const double z = edge.Depth(graph.Get(poses[I(host)]), graph.Get(poses[I(target)]),
                                    VertexInverseDepth{rho});
        if (!(z > 0.5)) continue;
        EdgeOptions<EdgeReprojection> options;
        Matrix2 L;
        L << 300.0, 0.0, 0.0, 310.0;
        if (scene.information) {
          L << Uniform(50, 300), Uniform(-40, 40), Uniform(-40, 40), Uniform(50, 300);
        }
        options.sqrt_information = L;
        if (scene.huber && Below(3) != 0) options.loss = Huber{Uniform(1.0, 20.0)};
        if (scene.tukey && l % 3 == 0) options.loss = Tukey{200.0};
        if (!targets.insert(target).second) continue;
        EXPECT_TRUE(graph.AddEdge(edge, {poses[I(host)], poses[I(target)], depth}, options).ok());
      }
    }
    EdgeOptions<EdgeSE3Prior> prior;
    prior.sqrt_information = SquareMatrix<6>(100.0 * SquareMatrix<6>::Identity());
    EXPECT_TRUE(graph.AddEdge(EdgeSE3Prior{graph.Get(poses[0]).pose}, {poses[0]}, prior).ok());
    if (scene.fixed) {
      EXPECT_TRUE(graph.SetFixed(poses[1]).ok());
      EXPECT_TRUE(graph.SetFixed(poses[2], Fix::kPositionAndYaw).ok());
      EXPECT_TRUE(graph.SetFixed(poses[3], Fix::kPosition).ok());
      int k = 0;
      graph.ForEachVertex<VertexInverseDepth>([&](auto handle, const auto&) {
        if (++k % 5 == 0) {
          EXPECT_TRUE(graph.SetFixed(handle).ok());
        }
      });
    }
    return graph;
  }

 private:
  static std::size_t I(int k) { return static_cast<std::size_t>(k); }
  std::mt19937_64 engine_;
};

void ExpectSame(const Scene& scene, unsigned seed, double tolerance) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Graph graph = Builder(seed).Build(scene);
  for (const bool identity : {false, true}) {
    // Enough to make the step comparable where the gauge is free.
    const DampingTerm damping{.lambda = identity ? 1e4 : 0.1, .identity = identity};
    test::PathOutcome groups(&graph, true, damping), single(&graph, false, damping);
    // It would prove nothing if landmarks were eliminated one by one in both.
    EXPECT_TRUE(groups.structure.landmarks().empty());
    EXPECT_GT(groups.structure.groups().num_landmarks, 0);
    test::ExpectSame(&groups, single, tolerance);
  }
}

void ExpectSame(const Scene& scene, double tolerance = 1e-11) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    ExpectSame(scene, seed, tolerance);
}

TEST(TwistTerms, PlainWindow) {
  ExpectSame({});
}
TEST(TwistTerms, ManySizes) {
  for (const int poses : {2, 3, 7, 10, 20, 35}) {
    for (const int landmarks : {1, 7, 8, 9, 64, 300}) {
      if (landmarks < 4) continue;  // too few to make a system without damping worth comparing
      ExpectSame({.num_poses = poses, .num_landmarks = landmarks, .max_track = 7}, 1, 1e-11);
    }
  }
}
TEST(TwistTerms, TracksWithGaps) {
  ExpectSame({.num_poses = 9, .gaps = true});
}
TEST(TwistTerms, TwoCameras) {
  ExpectSame({.two_cameras = true});
}
TEST(TwistTerms, InformationPerEdge) {
  ExpectSame({.information = true});
}
TEST(TwistTerms, HuberOnSomeEdges) {
  ExpectSame({.huber = true});
}
TEST(TwistTerms, OtherLosses) {
  ExpectSame({.huber = true, .tukey = true});
}
TEST(TwistTerms, FixedPosesAndLandmarks) {
  ExpectSame({.fixed = true});
}
TEST(TwistTerms, PointsAtInfinity) {
  ExpectSame({.at_infinity = true});
}
TEST(TwistTerms, FarFromTheOrigin) {
  ExpectSame({.far_origin = true}, 1e-10);
}
TEST(TwistTerms, Everything) {
  ExpectSame({.num_poses = 12,
              .num_landmarks = 200,
              .max_track = 6,
              .gaps = true,
              .two_cameras = true,
              .information = true,
              .huber = true,
              .tukey = true,
              .fixed = true});
}

TEST(TwistTerms, EdgeWithoutAValueIsNamed) {
  Graph graph = Builder(3).Build({});
  // A target that sits on the point it observes: zero depth.
  const VertexHandle<VertexPose> host = graph.AddVertex(VertexPose{});
  const VertexHandle<VertexPose> target =
      graph.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(0, 0, 4))});
  const VertexHandle<VertexInverseDepth> depth = graph.AddVertex(VertexInverseDepth{0.25});
  const EdgeHandle<EdgeReprojection> edge =
      graph.AddEdge(EdgeReprojection{{0.0, 0.0}, {0.0, 0.0}, Pose()}, {host, target, depth});
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;
  double cost = 0.0;
  ASSERT_TRUE(structure.Analyze(&graph).ok());
  const Status status = equations.Linearize(structure, &graph, &threads, &cost);
  EXPECT_EQ(status.code(), StatusCode::kEvaluationFailed);
  EXPECT_EQ(status.edge(), AnyEdge(edge));
}

}  // namespace
}  // namespace glissade
