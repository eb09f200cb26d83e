// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "glissade/io/g2o.h"

/// \file
/// The tags of g2o's files, and what is asked of what they say.
namespace glissade::internal {

enum class G2oKind : std::uint8_t {
  kOffset,
  kPose,
  kPoint,
  kCamera,
  kRelativePose,
  kPrior,
  kPointMeasurement,
  kProjection,
};
inline constexpr int kNumG2oKinds = 8;

struct G2oTag {
  const char* tag;
  G2oKind kind;
  const char* fields;  ///< after the tag, for messages
  int num_fields;      ///< with the tag
};
/// The first of a kind is the one that is written (but for VERTEX_XYZ).
inline constexpr G2oTag kG2oTags[] = {
    {"PARAMS_SE3OFFSET", G2oKind::kOffset, "id x y z qx qy qz qw", 9},
    {"VERTEX_SE3:QUAT", G2oKind::kPose, "id x y z qx qy qz qw", 9},
    {"VERTEX_TRACKXYZ", G2oKind::kPoint, "id x y z", 5},
    {"VERTEX_XYZ", G2oKind::kPoint, "id x y z", 5},
    {"VERTEX_CAM", G2oKind::kCamera, "id x y z qx qy qz qw fx fy cx cy baseline", 14},
    {"EDGE_SE3:QUAT", G2oKind::kRelativePose, "i j x y z qx qy qz qw information{21}", 31},
    {"EDGE_SE3_PRIOR", G2oKind::kPrior, "i offset x y z qx qy qz qw information{21}", 31},
    {"EDGE_SE3_TRACKXYZ", G2oKind::kPointMeasurement, "i point offset x y z information{6}", 13},
    {"EDGE_PROJECT_P2MC", G2oKind::kProjection, "point camera u v information{3}", 8},
};

/// The line of each element, by kind and in the order of its list.
struct G2oLines {
  std::vector<std::int64_t> of[kNumG2oKinds];

  std::vector<std::int64_t>& operator[](G2oKind kind) { return of[static_cast<int>(kind)]; }
  const std::vector<std::int64_t>& operator[](G2oKind kind) const {
    return of[static_cast<int>(kind)];
  }
};

/// Where an id leads.
struct G2oPlace {
  G2oKind kind;
  std::size_t index;
};
using G2oIndex = std::unordered_map<std::int64_t, G2oPlace>;

/// Vertices by id, and offsets by theirs.
struct G2oIds {
  G2oIndex vertices, offsets;
};

/// Checks a problem. Its elements are called "path:line: " where lines are given, else "g2o
/// problem: EDGE_SE3:QUAT 17: " (from 0). ids: filled in where it is not null.
Status CheckG2o(const G2oProblem& problem, const std::string& path, const G2oLines* lines,
                G2oIds* ids);

}  // namespace glissade::internal
