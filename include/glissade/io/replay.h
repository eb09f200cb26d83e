// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "glissade/imu/sample.h"
#include "glissade/io/viotracks.h"
#include "glissade/window/observation.h"

namespace glissade {

/// A recording's cameras as a window takes them; at most the first `count`.
[[nodiscard]] std::vector<WindowCamera> WindowCameras(const Viotracks& recording,
                                                      std::size_t count = 1000);

struct ReplayOptions {
  /// Observations of this many cameras; 1 makes a stereo recording monocular.
  std::size_t num_cameras = 1000;
  /// Added to the stamps of frames to have them on the clock of the IMU, s.
  double time_offset_s = 0.0;
};

/// Hands a recording over in the order of time, as it would have come from the sensors:
///
///     ViotracksReplay replay(recording);
///     while (replay.Next()) {
///       window.AddImu(replay.imu());
///       window.AddFrame(replay.stamp_ns(), replay.observations());
///       window.Optimize();
///     }
class ViotracksReplay {
 public:
  /// The recording must outlive it.
  explicit ViotracksReplay(const Viotracks& recording, const ReplayOptions& options = {});

  /// The next frame; false where there is none.
  bool Next();
  /// Index of the frame in the recording.
  [[nodiscard]] std::size_t frame() const { return frame_; }
  /// On the clock of the IMU.
  [[nodiscard]] std::int64_t stamp_ns() const { return stamp_ns_; }
  /// Since the frame before, up to the first sample at or after the frame.
  [[nodiscard]] std::span<const ImuSample> imu() const { return imu_; }
  [[nodiscard]] std::span<const FrameObservation> observations() const { return observations_; }

 private:
  const Viotracks* recording_;
  ReplayOptions options_;
  std::vector<std::size_t> by_frame_;  // indices of observations, in the order of frames
  std::size_t frame_ = 0, next_frame_ = 0, next_imu_ = 0, next_observation_ = 0;
  std::int64_t stamp_ns_ = 0;
  std::span<const ImuSample> imu_;
  std::vector<FrameObservation> observations_;
};

}  // namespace glissade
