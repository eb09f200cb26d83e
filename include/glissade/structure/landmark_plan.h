// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace glissade {

/// A pose that a group of landmarks hangs on, as host or target or because it sees points of it,
/// and its place in the system.
struct LandmarkFrame {
  std::int32_t pose = -1;   ///< dense index among the VertexPose
  std::int32_t block = -1;  ///< pose block, -1: fixed
};

/// What one target sees of a group's landmarks, by whatever edges. Of points, all poses that see
/// them are targets.
struct LandmarkPair {
  LandmarkFrame target;
  std::int32_t used = 0;      ///< after the last lane that it sees
  std::int32_t lanes = 0;     ///< that rounded up
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

/// Inverse depths of one host pose, sorted by falling number of edges so that targets, sorted
/// likewise, see prefixes of them. Or points that one pose is the first to see, sorted by falling
/// last pose for the same reason. A lane is a landmark.
struct LandmarkGroup {
  LandmarkFrame host;      ///< of points the first pose that sees them, which is a target as well
  std::int32_t pool = 0;   ///< of the landmarks: vertex pool
  std::int32_t dim = 1;    ///< of a landmark: 1 or 3
  std::int32_t used = 0;   ///< landmarks
  std::int32_t lanes = 0;  ///< that rounded up
  std::int32_t lane_begin = 0;
  /// Of its part of the landmark step, counted from LandmarkPlan::first_step: `dim` numbers for
  /// each lane. Where a vector of H is kept in lanes, that many arrays of them begin there.
  std::int32_t step_begin = 0;
  std::int32_t pair_begin = 0, pair_end = 0;
  std::int32_t run_begin = 0, run_end = 0;
  std::int32_t map_begin = 0;  ///< in block_map: lower triangle over the frames of W

  /// Frames of W: the host of inverse depths, then the targets.
  [[nodiscard]] int num_hosts() const { return dim == 1 ? 1 : 0; }
  [[nodiscard]] int num_frames() const { return num_hosts() + pair_end - pair_begin; }
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
/// - its poses are not too far from the center, seen from the landmark: see kMaxReach;
/// and a point if
/// - each of its edges knows it by its position relative to one pose alone (kRelativePoint, no
///   other vertex), or knows no pose at all;
/// - its poses are not too far from the center either;
/// - the poses that see points of its group see most of them: see kMaxFill.
/// All others are eliminated one by one; both add up to the same system.
struct LandmarkPlan {
  static constexpr std::int32_t kLaneBlock = 8;
  /// Poses are linearized as twists about one point o, the position of the pose `center`. That
  /// leaves the rotation's part of a Jacobian as the difference of two moments that grow with
  /// |p - o|, where the part itself goes with the distance of the landmark: H is right to the
  /// square of their ratio, in roundings. Landmarks for which |p - o| is above kMaxReach / |rho| at
  /// one of the poses are eliminated one by one, without twists; of points, 1 / |rho| is the
  /// distance from that pose. At 1000, H keeps nine digits.
  /// The ratio is that of the states at the time of the analysis. Analyze() looks at it again, and
  /// analyzes anew where it has become twice as large as is allowed, by poses or by depths.
  static constexpr double kMaxReach = 1e3;
  /// A group of points costs what it would if each of its poses saw all lanes up to the last that
  /// it sees. Where that is so many times what they cost one by one, they are.
  static constexpr std::int64_t kMaxFill = 3;

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
  std::int32_t first_step = 0;            ///< offset of the first group in the landmark step
  std::int32_t step_size = 0;             ///< of all groups
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
    pair_lanes = first_step = step_size = num_landmarks = 0;
    center = -1;
    reach = 0.0;
  }
  [[nodiscard]] bool empty() const { return groups.empty(); }
  /// Pose block of a frame of W, -1: fixed.
  [[nodiscard]] std::int32_t FrameBlock(const LandmarkGroup& group, int frame) const {
    const int target = frame - group.num_hosts();
    return target < 0 ? group.host.block
                      : pairs[static_cast<std::size_t>(group.pair_begin + target)].target.block;
  }
  /// Vertex pool of the landmark in a lane.
  [[nodiscard]] std::int32_t PoolOfLane(std::int32_t lane) const {
    std::size_t g = 0;
    while (lane >= groups[g].lane_begin + groups[g].lanes)
      ++g;
    return groups[g].pool;
  }
};

}  // namespace glissade
