// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "glissade/graph/graph.h"

/// \file
/// Seeded random graphs with known structure, small noise and a start near the optimum. The same
/// seed gives the same graph everywhere.
namespace glissade::test {

enum class GraphKind {
  kMonoWindow,   ///< poses, inverse-depth landmarks hosted in different frames
  kPointBundle,  ///< poses and XYZ points, now and then in stereo
  kPoseGraph,    ///< a chain of relative poses with loops and both kinds of priors; no landmarks
  kBal,          ///< BAL cameras and points
  kMixed,        ///< everything at once: all edge types of the library, types of a user's own,
                 ///< dynamic edges of both kinds
};
inline constexpr GraphKind kAllGraphKinds[] = {GraphKind::kMonoWindow, GraphKind::kPointBundle,
                                               GraphKind::kPoseGraph, GraphKind::kBal,
                                               GraphKind::kMixed};
std::string ToString(GraphKind kind);

struct RandomGraphOptions {
  int num_poses = 6;
  int num_landmarks = 20;
  /// Observations a landmark has at least, where there are that many poses before it.
  int min_views = 3;
  /// Random information matrices (full rank, and here and there rank-deficient) and general square
  /// roots; else the identity times the square of the focal length over sigma.
  bool information = true;
  /// Huber, Cauchy, Tukey and two losses of a user's own on some of the edges, with outliers.
  bool losses = true;
  /// Random vertices fixed, poses also in part, landmarks too; landmarks kept from elimination, and
  /// small vertices that are usually kept eliminated.
  bool fixes = true;
  /// Takes some edges and vertices away again at the end.
  bool removals = false;
  /// Priors that make every direction observable, also where nothing is fixed.
  bool anchored = true;
  /// Standard deviation of the start's rotations [rad]; positions have three times as much [m].
  double start_noise = 0.01;
};

Graph MakeRandomGraph(GraphKind kind, std::uint64_t seed, const RandomGraphOptions& options = {});

}  // namespace glissade::test
