// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/reprojection_intrinsics.h"
#include "glissade/graph/graph.h"
#include "glissade/io/colmap.h"
#include "glissade/losses/loss.h"

/// \file
/// Bundle adjustment of a COLMAP model: into a graph, and back once it is solved.
///
///     auto model = ReadColmap("sparse/0");
///     Problem problem;
///     auto handles = AddToGraph(model.value(), problem);
///     problem.Solve();
///     UpdateFromGraph(problem, handles.value(), &model.value());
///     WriteColmap(model.value(), "refined");
namespace glissade {

struct ColmapGraphOptions {
  /// What of the intrinsics is estimated. Distortion: all but focal lengths and principal point.
  bool free_focal_length = true;
  bool free_principal_point = false;
  bool free_distortion = true;
  /// Holds the first image that takes part. Otherwise nothing fixes the gauge but the damping of
  /// the solver, which leaves the model about where it is.
  bool fix_first_image = false;
  Loss loss = {};  ///< of residuals in px
};

/// Where a ColmapModel went in a graph, in its order; null where it has no part.
struct ColmapHandles {
  /// T_W_C, the camera in the world.
  std::vector<VertexHandle<VertexPose>> images;
  /// VertexVector<5> or <8>, by the type of their edges.
  std::vector<AnyVertex> cameras;
  std::vector<VertexHandle<VertexPointXYZ>> points;

  std::int64_t num_observations = 0;
  /// Points that fewer than two images see; images that see none of the others.
  std::int64_t num_points_left_out = 0;
  std::int64_t num_images_left_out = 0;
  /// Further features of a point in an image that sees it already.
  std::int64_t num_features_left_out = 0;
};

/// Adds images, cameras and points, or nothing: a model that CheckColmap refuses, an impossible
/// loss, no point that two images see, a focal length that is not positive, or a camera model other
/// than SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE (kInvalidArgument
/// with its name).
///
/// Vertices: a VertexPose for each image, a VertexVector for each camera, whose leading numbers are
/// COLMAP's parameters in their order, a VertexPointXYZ for each point. Edges:
///     EdgeReprojectionRadial    SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL
///     EdgeReprojectionRadtan    PINHOLE, OPENCV
///     EdgeReprojectionFisheye   OPENCV_FISHEYE
/// with what a model does not have held at 0 (Graph::SetFixedNumbers). Of a point that is twice in
/// one image the first feature counts.
[[nodiscard]] Result<ColmapHandles> AddToGraph(const ColmapModel& model, Graph& graph,
                                               const ColmapGraphOptions& options = {});

/// Takes over poses, intrinsics and points from the graph, and computes the error of the points
/// that take part. Refused, with the model unchanged: handles that the graph does not know, or that
/// are of another model, and a model that CheckColmap refuses.
Status UpdateFromGraph(const Graph& graph, const ColmapHandles& handles, ColmapModel* model);

}  // namespace glissade
