// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace glissade {

/// A camera of the fused reprojection path as host or target: a pose and its place in the system.
struct ReprojectionFrame {
  std::int32_t pose = -1;   ///< dense index among the VertexPose
  std::int32_t block = -1;  ///< pose block, -1: fixed
};

/// All observations of one group's landmarks by one target.
struct ReprojectionPair {
  ReprojectionFrame target;
  std::int32_t lanes = 0;     ///< rounded up; the landmarks after them are not observed
  std::int32_t slots = 0;     ///< offset in ReprojectionPlan::edge_of_slot
  std::int32_t h_block = -1;  ///< offset of block (host, target) in H_pp; -1: none
  bool h_transposed = false;  ///< stored as (target, host)
};

/// The landmarks of one host camera (pose and extrinsic), sorted by falling number of observations
/// so that targets, sorted likewise, see prefixes of them.
struct ReprojectionGroup {
  ReprojectionFrame host;
  std::int32_t edge = 0;  ///< one of its edges: for the extrinsic
  std::int32_t lane_begin = 0;
  std::int32_t lanes = 0;
  std::int32_t pair_begin = 0, pair_end = 0;
  std::int32_t map_begin = 0;  ///< in block_map: lower triangle over [host, targets...]
};

/// A block of the reduced system that fused landmarks fill.
struct ReprojectionBlock {
  std::int32_t row = 0;  ///< pose blocks, row >= col
  std::int32_t col = 0;
};

/// Which landmarks go through the fused kernels (kernels/reprojection.h), and how they are laid
/// out. All others take the general path; the two add up to the same system. A landmark is fused if
/// - it is an inverse depth that only EdgeReprojection touches, each from another target;
/// - its edges have one host, one camera (T_b_c) and one uv_host, equal to the bit;
/// - they have no loss or Huber's (any width; any information);
/// - none of its poses has a first estimate, where those are used in full;
/// - its poses are not too far from the center, seen from the landmark: see kMaxReach.
struct ReprojectionPlan {
  static constexpr std::int32_t kLaneBlock = 8;
  /// Poses are linearized as twists about one point o, the position of the pose `center`. That
  /// leaves the rotation's part of a Jacobian as the difference of two moments that grow with
  /// |p - o|, where the part itself goes with |X - p|, the distance to the landmark: H is right to
  /// (|p - o| / |X - p|)^2 roundings. A landmark for which that ratio is above kMaxReach at one of
  /// its poses takes the general path, which knows no center. At 1000, H keeps nine digits.
  /// The ratio is that of the states at the time of the analysis. Analyze() looks again where poses
  /// have gone away from the center, twice as far as the farthest then was.
  static constexpr double kMaxReach = 1e3;

  std::vector<ReprojectionGroup> groups;
  std::vector<ReprojectionPair> pairs;
  std::vector<std::int32_t> landmark_of_lane;  ///< dense index in the pool, -1: padding
  std::vector<std::int32_t> edge_of_slot;      ///< EdgeReprojection, -1: not observed
  std::vector<ReprojectionBlock> blocks;
  /// Index in blocks of each pair of a group's frames; ~index where (row, col) are swapped;
  /// kNoBlock where one is fixed.
  std::vector<std::int32_t> block_map;
  std::vector<std::int32_t> chunk_begin;  ///< groups of chunk c: [chunk_begin[c], chunk_begin[c+1])
  std::int32_t first_step = 0;            ///< offset of lane 0 in the landmark step
  /// Dense index of a hosting pose: the one nearest to the median of the hosts' positions (by
  /// coordinate, each host counted with its landmarks). Neither the world's origin nor a cluster or
  /// a pose far away from most landmarks moves it.
  std::int32_t center = -1;
  double reach = 0.0;  ///< distance of the farthest pose from it at the time of the analysis (m)
  int num_landmarks = 0;
  int num_edges = 0;
  static constexpr std::int32_t kNoBlock = INT32_MIN;

  void Clear() {
    groups.clear();
    pairs.clear();
    landmark_of_lane.clear();
    edge_of_slot.clear();
    blocks.clear();
    block_map.clear();
    chunk_begin.clear();
    first_step = num_landmarks = num_edges = 0;
    center = -1;
    reach = 0.0;
  }
  [[nodiscard]] bool empty() const { return groups.empty(); }
};

}  // namespace glissade
