// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/course_scene.h"

#include <cmath>
#include <string>

#include "glissade/base/validate.h"
#include "glissade/sim/random.h"

namespace glissade {

namespace {

/// cos and sin of 0, 30 and 60 degrees out of square roots, which, unlike cos() and sin(), are
/// rounded alike everywhere.
struct Turn {
  double cosine, sine, sine_of_double, half_cosine, half_sine;
};

Turn TurnOf(int n) {
  const double h = std::sqrt(3.0) / 2.0;
  const double cosines[3] = {1.0, h, 0.5};
  const double sines[3] = {0.0, 0.5, h};
  const double sines_of_double[3] = {0.0, h, h};
  const double c = cosines[n];
  return {c, sines[n], sines_of_double[n], std::sqrt((1.0 + c) / 2.0), std::sqrt((1.0 - c) / 2.0)};
}

/// Sums and differences of products without contraction, so that bits do not depend on FMA.
double Times(double a, double b) {
  volatile double product = a * b;
  return product;
}

}  // namespace

CourseScene MakeCourseScene() {
  constexpr int kPoses = 3;
  constexpr int kPoints = 20;
  constexpr double kRadius = 8.0;
  constexpr double kPixelNoise = 1.0 / 1000.0;

  CourseScene scene;
  Turn turns[kPoses];
  for (int n = 0; n < kPoses; ++n) {
    turns[n] = TurnOf(n);
    const Turn& t = turns[n];
    Pose T_w_c;
    T_w_c.data[0] = Times(kRadius, t.cosine) - kRadius;
    T_w_c.data[1] = Times(kRadius, t.sine);
    T_w_c.data[2] = t.sine_of_double;
    T_w_c.data[5] = t.half_sine;  // a turn about z
    T_w_c.data[6] = t.half_cosine;
    scene.poses.push_back(T_w_c);
  }

  // Draw order of the published run: per point z, y, x, then the noise of x and y pose by pose.
  sim::MinstdRand0 engine;
  sim::NormalReal pixel_noise(0.0, kPixelNoise);
  for (int k = 0; k < kPoints; ++k) {
    CoursePoint point;
    point.xyz[2] = sim::UniformReal(engine, 4.0, 8.0);
    point.xyz[1] = sim::UniformReal(engine, -4.0, 4.0);
    point.xyz[0] = sim::UniformReal(engine, -4.0, 4.0);
    for (int n = 0; n < kPoses; ++n) {
      const double dx = point.xyz[0] - scene.poses[static_cast<std::size_t>(n)].data[0];
      const double dy = point.xyz[1] - scene.poses[static_cast<std::size_t>(n)].data[1];
      const double z = point.xyz[2] - scene.poses[static_cast<std::size_t>(n)].data[2];
      const double x = Times(turns[n].cosine, dx) + Times(turns[n].sine, dy);
      const double y = Times(turns[n].cosine, dy) - Times(turns[n].sine, dx);
      const double u = x / z + pixel_noise(engine);
      const double v = y / z + pixel_noise(engine);
      point.observations.push_back({n, u, v});
    }
    scene.points.push_back(point);
  }

  sim::MinstdRand0 depth_engine;
  sim::NormalReal depth_noise(0.0, 1.0);
  for (CoursePoint& point : scene.points)
    point.rho_init = 1.0 / (point.xyz[2] + depth_noise(depth_engine));
  return scene;
}

Result<CourseHandles> AddToGraph(const CourseScene& scene, Graph& graph,
                                 const CourseGraphOptions& options) {
  // io's Validate() checks files; a scene that was made by hand is checked by the graph itself.
  const auto num_poses = static_cast<int>(scene.poses.size());
  const auto refused = [](const std::string& what) {
    return Status(StatusCode::kInvalidArgument, "course scene: " + what);
  };
  if (options.fix_poses < 0 || options.fix_poses > num_poses) {
    return refused("cannot fix " + std::to_string(options.fix_poses) + " of " +
                   std::to_string(num_poses) + " poses");
  }
  if (Status s = ValidateFinite(&options.prior_weight, 1, "course scene: prior weight"); !s.ok()) {
    return s;
  }
  if (options.prior_weight < 0.0) return refused("the prior weight is negative");
  if (options.num_priors < 0 || (options.prior_weight > 0.0 && options.num_priors > num_poses)) {
    return refused("cannot put priors on " + std::to_string(options.num_priors) + " of " +
                   std::to_string(num_poses) + " poses");
  }

  CourseHandles handles;
  const auto undo = [&](const Status& why) {
    for (const auto& pose : handles.poses)
      graph.RemoveVertex(pose);
    for (const auto& point : handles.points)
      graph.RemoveVertex(point);
    return Status(why.code(), "course scene: " + why.message());
  };
  for (const Pose& pose : scene.poses) {
    auto added = graph.AddVertex(VertexPose{pose});
    if (!added.ok()) return undo(added.status());
    handles.poses.push_back(added.value());
  }
  for (const CoursePoint& point : scene.points) {
    auto depth = graph.AddVertex(VertexInverseDepth{point.rho_init});
    if (!depth.ok()) return undo(depth.status());
    handles.points.push_back(depth.value());
    if (point.observations.empty()) continue;
    const CourseObservation& host = point.observations[0];
    for (const CourseObservation& o : point.observations) {
      if (o.pose < 0 || o.pose >= num_poses) return undo(refused("an observation by no pose"));
      if (&o == &host) continue;
      auto edge = graph.AddEdge(
          EdgeReprojection{.uv_host = {host.u, host.v}, .uv_target = {o.u, o.v}, .T_b_c = Pose()},
          {handles.poses[static_cast<std::size_t>(host.pose)],
           handles.poses[static_cast<std::size_t>(o.pose)], depth.value()});
      if (!edge.ok()) return undo(edge.status());
      handles.edges.push_back(edge.value());
    }
  }
  for (int n = 0; options.prior_weight > 0.0 && n < options.num_priors; ++n) {
    const auto k = static_cast<std::size_t>(n);
    auto prior = graph.AddEdge(
        EdgeSE3Prior{scene.poses[k]}, {handles.poses[k]},
        {.sqrt_information = Matrix6(std::sqrt(options.prior_weight) * Matrix6::Identity())});
    if (!prior.ok()) return undo(prior.status());
    handles.priors.push_back(prior.value());
  }
  for (int n = 0; n < options.fix_poses; ++n)
    graph.SetFixed(handles.poses[static_cast<std::size_t>(n)]);
  return handles;
}

CourseErrors ErrorsOf(const CourseScene& scene, const Graph& graph, const CourseHandles& handles) {
  CourseErrors errors;
  for (std::size_t n = 0; n < scene.poses.size(); ++n)
    errors.pose += (graph.Get(handles.poses[n]).pose.p() - scene.poses[n].p()).norm();
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    errors.point +=
        std::abs(graph.Get(handles.points[k]).rho - scene.TrueInverseDepth(scene.points[k]));
  }
  return errors;
}

}  // namespace glissade
