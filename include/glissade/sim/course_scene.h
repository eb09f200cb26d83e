// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/graph/graph.h"
#include "glissade/io/course_scene.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"

namespace glissade {

/// The scene of the course's monocular BA: 3 poses 30 degrees apart on a circle, 20 points at a
/// depth of 4 to 8 m, normalized image points with a noise of 0.001, inverse depths from depths
/// with a noise of 1 m. The same bits on every machine; data/course_scene.txt is its frozen copy.
[[nodiscard]] CourseScene MakeCourseScene();

struct CourseGraphOptions {
  /// The first poses are held at their truth.
  int fix_poses = 0;
  /// > 0: the first `num_priors` poses get an EdgeSE3Prior at their truth with information
  /// prior_weight * I (1/m^2, 1/rad^2).
  double prior_weight = 0.0;
  int num_priors = 2;
};

/// Where a scene went in a graph.
struct CourseHandles {
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexInverseDepth>> points;
  /// Host to each other pose that sees the point, point by point; information is the identity.
  std::vector<EdgeHandle<EdgeReprojection>> edges;
  std::vector<EdgeHandle<EdgeSE3Prior>> priors;
};

/// Adds the scene's monocular BA problem: poses at the truth, inverse depths at rho_init. All or
/// nothing: refuses an invalid scene, and options that ask for more poses than there are.
[[nodiscard]] Result<CourseHandles> AddToGraph(const CourseScene& scene, Graph& graph,
                                               const CourseGraphOptions& options = {});

/// How far a solution is from the truth, in the scene's own frame (no alignment).
struct CourseErrors {
  double pose = 0.0;   ///< sum over poses of |p - p_true| (m)
  double point = 0.0;  ///< sum over points of |rho - rho_true| (1/m)
};
[[nodiscard]] CourseErrors ErrorsOf(const CourseScene& scene, const Graph& graph,
                                    const CourseHandles& handles);

}  // namespace glissade
