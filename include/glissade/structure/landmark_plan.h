// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace glissade {

/// A pose that a group of landmarks hangs on, as host or target, and its place in the system.
struct LandmarkFrame {
  std::int32_t pose = -1;   ///< dense index among the VertexPose
  std::int32_t block = -1;  ///< pose block, -1: fixed
};

/// What one target sees of a group's landmarks, by whatever edges.
struct LandmarkPair {
  LandmarkFrame target;
  std::int32_t lanes = 0;     ///< rounded up; the landmarks after them are not seen
  std::int32_t begin = 0;     ///< lanes of all pairs before it
  std::int32_t h_block = -1;  ///< offset of block (host, target) in H_pp; -1: none
  bool h_transposed = false;  ///< stored as (target, host)
};

/// Edges of one type and sensor by which one target sees landmarks of a group: at most one each.
struct LandmarkRun {
  std::int32_t pool = 0;
  std::int32_t pair = -1;  ///< -1: edges on the landmark alone
  std::int32_t first = 0;  ///< lane of the group, a multiple of kLaneBlock
  std::int32_t used = 0;   ///< after the last lane that has an edge
  std::int32_t lanes = 0;  ///< from the first one on, rounded up
  std::int32_t begin = 0;  ///< offset in edge_of_slot and what belongs to it
};

/// The landmarks of one host pose, sorted by falling number of edges so that targets, sorted
/// likewise, see prefixes of them. A lane is a landmark.
struct LandmarkGroup {
  LandmarkFrame host;
  std::int32_t lane_begin = 0;
  std::int32_t lanes = 0;
  std::int32_t pair_begin = 0, pair_end = 0;
  std::int32_t run_begin = 0, run_end = 0;
  std::int32_t map_begin = 0;  ///< in block_map: lower triangle over [host, targets...]
};

/// A block of the reduced system that landmarks in groups fill.
struct LandmarkPlanBlock {
  std::int32_t row = 0;  ///< pose blocks, row >= col
  std::int32_t col = 0;
};

/// Which landmarks are eliminated in groups, their poses as twists, and how they are laid out. In a
/// group is an inverse depth if
/// - each of its edges knows its poses by the relative pose of host and target alone
///   (FirstEstimateRule::kRelativePose, with no other vertex but the landmark), or none at all;
/// - all have the same host;
/// - its poses are not too far from the center, seen from the landmark: see kMaxReach.
/// All others are eliminated one by one; both add up to the same system.
struct LandmarkPlan {
  static constexpr std::int32_t kLaneBlock = 8;
  /// Poses are linearized as twists about one point o, the position of the pose `center`. That
  /// leaves the rotation's part of a Jacobian as the difference of two moments that grow with
  /// |p - o|, where the part itself goes with the distance of the landmark: H is right to the
  /// square of their ratio, in roundings. Landmarks for which |p - o| is above kMaxReach / |rho| at
  /// one of the poses are eliminated one by one, without twists. At 1000, H keeps nine digits.
  /// The ratio is that of the states at the time of the analysis. Analyze() looks at it again, and
  /// analyzes anew where it has become twice as large as is allowed, by poses or by depths.
  static constexpr double kMaxReach = 1e3;

  std::vector<LandmarkGroup> groups;
  std::vector<LandmarkPair> pairs;
  std::vector<LandmarkRun> runs;
  std::vector<std::int32_t> landmark_of_lane;  ///< dense index in the pool, -1: padding
  std::vector<std::int32_t> edge_of_slot;      ///< of runs; a lane without repeats one that has
  std::vector<std::int32_t> landmark_of_slot;  ///< of the same edge: dense index
  std::vector<double> mask_of_slot;            ///< 0 where the edge is a repetition, else 1
  std::vector<LandmarkPlanBlock> blocks;
  /// Index in blocks of each pair of a group's frames; ~index where (row, col) are swapped;
  /// kNoBlock where one is fixed.
  std::vector<std::int32_t> block_map;
  std::vector<std::int32_t> chunk_begin;  ///< groups of chunk c: [chunk_begin[c], chunk_begin[c+1])
  std::int32_t pair_lanes = 0;            ///< of all pairs
  std::int32_t first_step = 0;            ///< offset of lane 0 in the landmark step
  /// Dense index of a hosting pose: the one nearest to the median of the hosts' positions (by
  /// coordinate, each host counted with its landmarks). Neither the world's origin nor a cluster or
  /// a pose far away from most landmarks moves it.
  std::int32_t center = -1;
  double reach = 0.0;  ///< largest |p - o| |rho| of a lane at the time of the analysis
  int num_landmarks = 0;
  static constexpr std::int32_t kNoBlock = INT32_MIN;

  void Clear() {
    groups.clear();
    pairs.clear();
    runs.clear();
    landmark_of_lane.clear();
    edge_of_slot.clear();
    landmark_of_slot.clear();
    mask_of_slot.clear();
    blocks.clear();
    block_map.clear();
    chunk_begin.clear();
    pair_lanes = first_step = num_landmarks = 0;
    center = -1;
    reach = 0.0;
  }
  [[nodiscard]] bool empty() const { return groups.empty(); }
};

}  // namespace glissade
