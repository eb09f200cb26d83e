// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/bal.h"
#include "glissade/graph/graph.h"
#include "glissade/losses/loss.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/point_xyz.h"

/// \file
/// "Bundle Adjustment in the Large" problems (S. Agarwal, N. Snavely, S. Seitz, R. Szeliski, ECCV
/// 2010; grail.cs.washington.edu/projects/bal). Text, white space between numbers:
///
///     <cameras> <points> <observations>
///     <camera> <point> <u> <v>              one line per observation, px from the image centre
///     <9 numbers per camera>                rotation vector, translation, f, k1, k2
///     <3 numbers per point>                 world
namespace glissade {

struct BalObservation {
  std::int32_t camera = 0;
  std::int32_t point = 0;
  double u = 0.0;  ///< px, from the image centre, to the right
  double v = 0.0;  ///< px, upwards: the camera looks along its -z axis

  friend bool operator==(const BalObservation&, const BalObservation&) = default;
};

/// The content of a BAL file, in its order.
struct BalProblem {
  std::vector<VertexCameraBal> cameras;
  std::vector<VertexPointXYZ> points;
  std::vector<BalObservation> observations;
};

/// Reads a file: plain text, .gz, .bz2 or binary (told by content). All or nothing: on failure a
/// status whose message is "file:line: what was expected, what was found" (kIoError where the file
/// cannot be opened or decompressed, else kParseError; without a line where the file is binary).
/// Every number is finite, every index in range. A text of 200 MB takes half a second to a second,
/// as binary a quarter of that.
[[nodiscard]] Result<BalProblem> ReadBal(const std::string& path);

/// Writes a file, compressed if its name ends in .gz or .bz2, binary if in .bbal, else text.
/// Reading it gives the same bits: numbers have as many digits as that takes. Refuses what ReadBal
/// would not take back; then nothing is written.
/// `progress` is told now and then which part of the text has been written, 0 to 1.
Status WriteBal(const BalProblem& problem, const std::string& path,
                const std::function<void(double)>& progress = {});

/// Where a BalProblem went in a graph, in its order.
struct BalHandles {
  std::vector<VertexHandle<VertexCameraBal>> cameras;
  std::vector<VertexHandle<VertexPointXYZ>> points;
  std::vector<EdgeHandle<EdgeBal>> edges;
};

/// Adds all cameras, points and observations, or nothing (a number that is not finite, an index out
/// of range, an impossible loss).
[[nodiscard]] Result<BalHandles> AddToGraph(const BalProblem& problem, Graph& graph,
                                            const Loss& loss = {});

/// The same for a problem that is not needed any more: its lists are freed on the way and no
/// handles kept, together 40 bytes an observation. On failure it is gone and the graph as before.
Status MoveToGraph(BalProblem problem, Graph& graph, const Loss& loss = {});

/// The BAL problem that a graph holds, in order of insertion. Weights, losses and what is fixed
/// have no place in the format and are left out. Refuses a graph with any other type of vertex or
/// edge.
[[nodiscard]] Result<BalProblem> BalFromGraph(const Graph& graph);

}  // namespace glissade
