// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace glissade {

/// What a window tells of besides its states.
enum class WindowEvent : std::uint8_t {
  kInitialized,          ///< the first state is there
  kKeyframe,             ///< a frame was made a keyframe
  kObservationRefused,   ///< not finite, no such camera, or seen twice in one image
  kObservationRejected,  ///< did not fit, and was taken out
  kLandmarkTriangulated,
  kLandmarkMarginalized,
  kLandmarkStarved,        ///< too few observations left: taken out without a trace
  kFrameWithoutLandmarks,  ///< nothing known was seen: the IMU alone tells where the body went
  kImuSampleRefused,       ///< not finite, out of order, a stamp twice
  kImuSaturated,           ///< a sample at the end of its range, trusted less
  kImuGap,                 ///< readings are missing between two frames
  kImuTermReplaced,        ///< integrated again, since its biases had moved
  kStandingStill,          ///< no motion between two frames, by the IMU and the images
  kSolveFailed,
  kReset,                  ///< began anew, keeping what can be trusted
  kFrameRefused,           ///< a stamp that makes no sense, or IMU samples that are not there yet
  kCameraWithoutFeatures,  ///< one camera saw nothing where another did
};
inline constexpr std::size_t kNumWindowEvents = 17;

/// "observation rejected"
std::string_view ToString(WindowEvent event);

/// How often each has happened.
struct WindowEventCounts {
  std::array<std::int64_t, kNumWindowEvents> count{};

  [[nodiscard]] std::int64_t operator[](WindowEvent event) const {
    return count[static_cast<std::size_t>(event)];
  }
  std::int64_t& operator[](WindowEvent event) { return count[static_cast<std::size_t>(event)]; }
};

}  // namespace glissade
