// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <glissade/covariance/transform.h>
#include <glissade/gauge/move.h>
#include <glissade/glissade.h>
#include <gtest/gtest.h>

#include "support/gauge_scene.h"

// The example of docs/gauge.md, word for word.

using namespace glissade;

// clang-format off
Status Study(Problem& problem, VertexHandle<VertexPose> first, VertexHandle<VertexPose> last) {
  problem.Solve({.gauge = Gauge::Fixed{first}});          // four columns less
  problem.Solve({.gauge = Gauge::Prior{first, 1e5}});     // four rows more
  problem.Solve({.gauge = Gauge::Free});                  // damping does it

  auto report = problem.CheckNullspace();                 // who claims to see the gauge?
  if (!report.ok()) return report.status();
  for (const GaugeBreach& breach : report->edges) problem.RemoveEdge(breach.edge);

  if (Status s = problem.MoveToGauge(Gauge::Fixed{last, Pose()}); !s.ok()) return s;

  Covariance covariance;
  if (Status s = covariance.Compute(&problem, {.gauge = Gauge::Fixed{first}}); !s.ok()) return s;
  auto joint = covariance.Joint({first, last});
  if (!joint.ok()) return joint.status();
  auto seen_from_last = TransformCovariance(*joint, Gauge::Fixed{last});
  return seen_from_last.status();
}
// clang-format on

TEST(DocsExample, Runs) {
  test::GaugeScene scene(1);
  Problem& problem = scene.problem;
  const auto prior =
      problem.AddEdge(EdgeSE3Prior{problem.Get(scene.poses[2]).pose}, {scene.poses[2]});
  const Status status = Study(problem, scene.poses[0], scene.poses[9]);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_FALSE(problem.Contains(AnyEdge(prior.value()))) << "found, and removed";
  EXPECT_LT(problem.Get(scene.poses[9]).pose.p().norm(), 1e-12);
}
