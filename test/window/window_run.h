// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "glissade/io/viotracks.h"
#include "glissade/window/sliding_window.h"

namespace glissade::test {

/// Twelve simulated seconds a lap, stereo and IMU.
Viotracks MakeFlight(std::uint64_t seed, int laps = 1);

/// Cameras, noise and gravity of a recording.
SlidingWindowOptions OptionsFor(const Viotracks& recording, std::size_t num_cameras = 2);

/// The true state at a frame of the recording.
WindowState TruthAt(const Viotracks& recording, std::size_t frame);

struct WindowRun {
  std::vector<WindowState> estimates;  ///< after each frame
  std::vector<std::size_t> frames;     ///< of the recording, one for each estimate
  int refused_frames = 0;
  double rms_position_m = 0.0;  ///< against the truth, without any alignment
};

/// Called before a frame goes in; may change what goes in. False: the frame is left out.
using Tamper =
    std::function<bool(std::size_t frame, std::int64_t* stamp_ns, std::vector<ImuSample>* imu,
                       std::vector<FrameObservation>* observations)>;
/// Called after a frame was solved.
using Inspect = std::function<void(std::size_t frame, SlidingWindow& window)>;

/// Replays a recording, begun at the true state of its first frame.
WindowRun RunWindow(const Viotracks& recording, SlidingWindow* window, const Tamper& tamper = {},
                    const Inspect& inspect = {});

}  // namespace glissade::test
