// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Landmarks that the same poses see come one after the other, so that they end up in one chunk: an
// edge's values are computed together with those on the same vertices but for the landmark, of its
// chunk only (LandmarkRuns).

#include <algorithm>
#include <tuple>

#include "glissade/base/index.h"
#include "glissade/structure/structure.h"
#include "structure/inactive.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

void Structure::SortLandmarks() {
  std::int64_t num_edges = 0;
  for (const FlatEdges& edges : flat_) {
    num_edges += edges.arity > 0 ? static_cast<int>(edges.index.size()) / edges.arity
                                 : static_cast<int>(edges.begin.size()) - 1;
  }
  if (num_edges < 2 * kEdgesPerChunk) return;  // all in one chunk

  edges_of_pose_.assign(poses_.size(), 0);
  for (const FlatEdges& edges : flat_) {
    for (const std::int32_t v : edges.variable) {
      if (v >= 0) ++edges_of_pose_[Index(v)];
    }
  }
  order_.clear();
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const auto none = static_cast<std::int32_t>(poses_.size());
    order_.push_back({landmarks_[l].pool, none, -1, static_cast<std::int32_t>(l)});
  }
  for (const FlatEdges& edges : flat_) {
    const int count = edges.arity > 0 ? static_cast<int>(edges.index.size()) / edges.arity
                                      : static_cast<int>(edges.begin.size()) - 1;
    for (int edge = 0; edge < count; ++edge) {
      const std::int32_t* v = edges.variable.data() + edges.Begin(edge);
      const std::int32_t* end = v + edges.Arity(edge);
      const std::int32_t* found =
          std::find_if(v, end, [](std::int32_t x) { return x < 0 && x != kInactive; });
      if (found == end) continue;
      SeenLandmark& landmark = order_[Index(~*found)];
      for (; v != end; ++v) {
        // What nearly all edges have, an extrinsic say, tells nothing.
        if (*v < 0 || 2 * std::int64_t{edges_of_pose_[Index(*v)]} > num_edges) continue;
        landmark.first = std::min(landmark.first, *v);
        landmark.last = std::max(landmark.last, *v);
      }
    }
  }
  std::sort(order_.begin(), order_.end(), [](const SeenLandmark& a, const SeenLandmark& b) {
    return std::tie(a.pool, a.first, a.last, a.landmark) <
           std::tie(b.pool, b.first, b.last, b.landmark);
  });

  unsorted_ = landmarks_;
  new_number_.resize(landmarks_.size());
  num_landmark_scalars_ = 0;
  for (std::size_t l = 0; l < order_.size(); ++l) {
    const std::int32_t from = order_[l].landmark;
    new_number_[Index(from)] = static_cast<std::int32_t>(l);
    LandmarkBlock& landmark = landmarks_[l];
    landmark = unsorted_[Index(from)];
    landmark.step = num_landmark_scalars_;
    num_landmark_scalars_ += landmark.dim;
    variable_[Index(landmark.pool)][Index(landmark.index)] = ~static_cast<std::int32_t>(l);
  }
  for (FlatEdges& edges : flat_) {
    for (std::int32_t& v : edges.variable) {
      if (v < 0 && v != kInactive) v = ~new_number_[Index(~v)];
    }
  }
}

}  // namespace glissade
