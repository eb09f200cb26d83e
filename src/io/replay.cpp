// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/replay.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace glissade {

std::vector<WindowCamera> WindowCameras(const Viotracks& recording, std::size_t count) {
  std::vector<WindowCamera> cameras;
  for (const ViotracksCamera& c : recording.cameras) {
    if (cameras.size() == count) break;
    cameras.push_back({c.fx, c.fy, c.cx, c.cy, c.sigma_px, c.T_b_c});
  }
  return cameras;
}

ViotracksReplay::ViotracksReplay(const Viotracks& recording, const ReplayOptions& options)
    : recording_(&recording), options_(options), by_frame_(recording.tracks.size()) {
  std::iota(by_frame_.begin(), by_frame_.end(), std::size_t{0});
  std::stable_sort(by_frame_.begin(), by_frame_.end(), [&](std::size_t a, std::size_t b) {
    return recording.tracks[a].frame < recording.tracks[b].frame;
  });
}

bool ViotracksReplay::Next() {
  const Viotracks& r = *recording_;
  if (next_frame_ >= r.frames.size()) return false;
  frame_ = next_frame_++;
  stamp_ns_ = r.frames[frame_].stamp_ns +
              static_cast<std::int64_t>(std::llround(1e9 * options_.time_offset_s));

  const std::size_t first = next_imu_;
  while (next_imu_ < r.imu.size() &&
         (next_imu_ == 0 || r.imu[next_imu_ - 1].stamp_ns < stamp_ns_)) {
    ++next_imu_;
  }
  imu_ = std::span<const ImuSample>(r.imu).subspan(first, next_imu_ - first);

  observations_.clear();
  for (; next_observation_ < by_frame_.size(); ++next_observation_) {
    const ViotracksObservation& o = r.tracks[by_frame_[next_observation_]];
    if (static_cast<std::size_t>(o.frame) != frame_) break;
    if (static_cast<std::size_t>(o.camera) >= options_.num_cameras) continue;
    observations_.push_back({o.track, o.camera, o.u, o.v});
  }
  return true;
}

}  // namespace glissade
