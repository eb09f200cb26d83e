// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/graph/graph.h"

/// \file
/// Pictures of points and cameras in space: PLY files (G. Turk, The PLY polygon file format, 1994)
/// for MeshLab, CloudCompare, Blender and their like.
namespace glissade {

/// 0 to 255 each.
using PlyColor = std::array<std::uint8_t, 3>;

struct PlyVertex {
  std::array<float, 3> position;
  PlyColor color;
};

/// A line between two vertices.
struct PlyEdge {
  std::int32_t from, to;
  PlyColor color;
};

/// What a file shows: coloured points, and lines between some of them.
struct PlyScene {
  std::vector<PlyVertex> vertices;
  std::vector<PlyEdge> edges;

  /// x: 3 numbers.
  void AddPoint(const double* x, PlyColor color);
  /// The frustum of a camera: five vertices, its centre and the corners of its image, and eight
  /// edges. R: world to camera, row by row, whose third row is the direction in which it looks or,
  /// with `looks_back`, the opposite (BAL). The image is `size` before the centre, as wide as that
  /// and three quarters as high.
  void AddCamera(const double* R, const double* centre, double size, bool looks_back,
                 PlyColor color);
};

/// The cameras and points of a graph: of a BAL problem, or of a COLMAP model, whose cameras are the
/// poses. A point is blue where its reprojection errors are small,
/// green at 1 px, red from 4 px on (rms over its observations; grey where it has none). Cameras are
/// orange, half as large as the median distance from one to the next. Refuses a graph with neither.
[[nodiscard]] Result<PlyScene> PlyOfGraph(const Graph& graph);

/// Writes a file: binary, little endian, single precision. Refuses numbers that are not finite (or
/// too large for a float) and edges between vertices that are not there; then nothing is written.
Status WritePly(const PlyScene& scene, const std::string& path);

}  // namespace glissade
