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
/// out: inverse depths that only EdgeReprojection of one host and camera touch, with no loss or
/// Huber's. All others take the general path; the two add up to the same system.
struct ReprojectionPlan {
  static constexpr std::int32_t kLaneBlock = 8;

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
  }
  [[nodiscard]] bool empty() const { return groups.empty(); }
};

}  // namespace glissade
