// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/course_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace glissade {
namespace {

std::string SixDigits(double x) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", x);
  return text;
}

TEST(CourseScene, PublishedTruthAndNoise) {
  const CourseScene scene = MakeCourseScene();
  const struct {
    std::size_t point;
    const char* truth;
    const char* start;
  } published[] = {{0, "0.220938", "0.227057"},
                   {1, "0.234336", "0.314411"},
                   {2, "0.142336", "0.129703"},
                   {19, "0.14646", "0.240649"}};
  for (const auto& [k, truth, start] : published) {
    EXPECT_EQ(SixDigits(scene.TrueInverseDepth(scene.points[k])), truth);
    EXPECT_EQ(SixDigits(scene.points[k].rho_init), start);
  }
}

TEST(CourseScene, PosesAreOnTheirCircleAndObservationsNearTheTruth) {
  const CourseScene scene = MakeCourseScene();
  for (int n = 0; n < 3; ++n) {
    const double theta = n * M_PI / 6.0;
    const Pose& pose = scene.poses[static_cast<std::size_t>(n)];
    EXPECT_NEAR(pose.p()[0], 8.0 * std::cos(theta) - 8.0, 1e-15);
    EXPECT_NEAR(pose.p()[1], 8.0 * std::sin(theta), 1e-15);
    EXPECT_NEAR(pose.p()[2], std::sin(2.0 * theta), 1e-15);
    EXPECT_LT((so3::Log(pose.R()) - Vector3(0, 0, theta)).norm(), 1e-15);
    double sum = 0.0;
    for (const CoursePoint& point : scene.points) {
      const auto& o = point.observations[static_cast<std::size_t>(n)];
      EXPECT_EQ(o.pose, n);
      const Vector3 x_c = pose.Inverse() * Vector3(point.xyz[0], point.xyz[1], point.xyz[2]);
      sum += std::pow(x_c[0] / x_c[2] - o.u, 2) + std::pow(x_c[1] / x_c[2] - o.v, 2);
    }
    EXPECT_NEAR(std::sqrt(sum / 40.0), 1e-3, 3e-4);
  }
}

TEST(CourseScene, ProblemOfTheScene) {
  const CourseScene scene = MakeCourseScene();
  Graph graph;
  const auto handles = AddToGraph(scene, graph);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(graph.NumVertices<VertexPose>(), 3);
  EXPECT_EQ(graph.NumVertices<VertexInverseDepth>(), 20);
  EXPECT_EQ(graph.NumEdges<EdgeReprojection>(), 40);
  EXPECT_EQ(graph.NumEdges(), 40);
  EXPECT_EQ(handles->edges.size(), 40u);
  EXPECT_TRUE(handles->priors.empty());
  EXPECT_EQ(SixDigits(graph.Chi2().value()), "5.35099");
  for (std::size_t n = 0; n < 3; ++n)
    EXPECT_EQ(graph.GetFixed(handles->poses[n]), Fix::kFree);
  const CourseErrors errors = ErrorsOf(scene, graph, *handles);
  EXPECT_EQ(errors.pose, 0.0);
  double noise = 0.0;
  for (const CoursePoint& point : scene.points)
    noise += std::abs(point.rho_init - scene.TrueInverseDepth(point));
  EXPECT_DOUBLE_EQ(errors.point, noise);
}

TEST(CourseScene, FixedPosesAndPriors) {
  const CourseScene scene = MakeCourseScene();
  Graph graph;
  const auto handles = AddToGraph(scene, graph, {.fix_poses = 2, .prior_weight = 1e4});
  ASSERT_TRUE(handles.ok());
  EXPECT_EQ(graph.GetFixed(handles->poses[0]), Fix::kWhole);
  EXPECT_EQ(graph.GetFixed(handles->poses[1]), Fix::kWhole);
  EXPECT_EQ(graph.GetFixed(handles->poses[2]), Fix::kFree);
  ASSERT_EQ(handles->priors.size(), 2u);
  EXPECT_EQ(graph.NumEdges(), 42);
  EXPECT_NEAR(graph.Chi2(handles->priors[1]).value(), 0.0, 1e-20);
  VertexPose moved{scene.poses[1]};
  const double delta[6] = {0.01, 0.0, 0.0, 0.0, 0.0, 0.02};
  moved.Plus(delta);
  graph.Set(handles->poses[1], moved);
  EXPECT_NEAR(graph.Chi2(handles->priors[1]).value(), 1e4 * (1e-4 + 4e-4), 1e-10);
}

TEST(CourseScene, RefusesWhatMakesNoSense) {
  const auto refused = [](const CourseGraphOptions& options, auto&& spoil) {
    CourseScene scene = MakeCourseScene();
    spoil(scene);
    Graph graph;
    const auto handles = AddToGraph(scene, graph, options);
    EXPECT_FALSE(handles.ok());
    EXPECT_FALSE(handles.status().message().empty());
    EXPECT_EQ(graph.NumVertices() + graph.NumEdges(), 0);
  };
  const auto as_is = [](CourseScene&) {};
  refused({.fix_poses = -1}, as_is);
  refused({.fix_poses = 4}, as_is);
  refused({.prior_weight = -1.0}, as_is);
  refused({.prior_weight = std::nan("")}, as_is);
  refused({.prior_weight = 1.0, .num_priors = 4}, as_is);
  refused({.prior_weight = 1.0, .num_priors = -1}, as_is);
  refused({}, [](CourseScene& s) { s.points[5].observations[1].pose = 7; });
  refused({}, [](CourseScene& s) { s.points[5].observations[2].pose = 0; });
  refused({}, [](CourseScene& s) { s.points[5].observations[0].u = std::nan(""); });
  refused({}, [](CourseScene& s) { s.points[7].rho_init = std::nan(""); });
  refused({}, [](CourseScene& s) { s.poses[2].data[6] = 2.0; });
}

}  // namespace
}  // namespace glissade
