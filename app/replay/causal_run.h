// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "glissade/eval/trajectory.h"
#include "glissade/window/sliding_window.h"
#include "replay/fault.h"

namespace glissade::app {

/// How a window is run, whatever its frames come from.
struct RunSettings {
  WindowBudget budget;
  bool covariance = false;    ///< of every newest state
  bool observations = false;  ///< remember which were taken out
  bool wall_clock = false;    ///< times of the clock on the wall instead of the thread's own
};

/// Which window.
struct WindowSettings {
  std::string policy = "okvis";
  int frames = 3;     ///< S
  int keyframes = 7;  ///< M
  double lag_s = 1.0;
  FirstEstimates first_estimates = FirstEstimates::kFull;
};

struct ReplaySettings : RunSettings, WindowSettings {
  bool mono = false, no_imu = false;
  double time_offset_s = 0.0;
  std::vector<Fault> faults;
};

/// Off, prior or full.
FirstEstimates ParseFirstEstimates(const std::string& word);
std::shared_ptr<WindowPolicy> MakePolicy(const WindowSettings& settings);

/// The options of a window for a recording; refused where they make no sense for it.
Result<SlidingWindowOptions> WindowOptions(const Viotracks& recording,
                                           const ReplaySettings& settings);

/// What the window said right after a frame.
struct FrameEstimate {
  std::size_t frame = 0;  ///< in the recording
  WindowState state;
  /// The window's oldest frame, in whose gauge (its position and yaw exact) sigmas are.
  eval::StampedPose oldest;
  std::array<double, 15> sigmas{};           ///< p, theta, v, ba, bg; NaN where not known
  std::array<double, 36> pose_covariance{};  ///< of p, theta; row-major, NaN where not known
  int num_frames = 0, num_landmarks = 0, num_observations = 0;
  double ms = 0.0;  ///< that the frame took
};

/// Of the thread's own clock, or of that on the wall, ms.
double ClockMs(bool wall_clock);

/// ms, of each frame that was taken; solve and reject of those only that the thread worked through
/// without being held up.
struct StageTimes {
  std::vector<double> total;
  std::vector<double> add;     ///< samples, prediction, tracks, triangulation
  std::vector<double> solve;   ///< of the window
  std::vector<double> reject;  ///< outliers, IMU terms anew
  std::vector<double> slide;   ///< what leaves: policy, marginalization
  /// Of the newest state, where it was asked for; not part of total.
  std::vector<double> covariance;
};

/// An observation of the recording.
struct ObservationKey {
  std::int64_t track = 0;
  std::size_t frame = 0;
  int camera = 0;
  friend auto operator<=>(const ObservationKey&, const ObservationKey&) = default;
};

struct CausalRun {
  std::vector<FrameEstimate> estimates;
  StageTimes ms;
  WindowEventCounts events;
  std::int64_t frames_delivered = 0, frames_refused = 0, solves_failed = 0;
  /// What the window had allocated at the end, graph and storage of its steps; 0: not known here.
  double window_mb = 0.0;
  std::string first_refusal;                  ///< of a frame or a solve; empty: none
  std::optional<double> initialized_at_s;     ///< after the first frame
  std::vector<ObservationKey> rejected_keys;  ///< sorted; with ReplaySettings::observations
};

/// Hands frames to a window one by one, and notes what it said right after each.
class CausalRunner {
 public:
  CausalRunner(const RunSettings& settings, SlidingWindowOptions options,
               std::int64_t first_stamp_ns);
  ~CausalRunner();
  CausalRunner(const CausalRunner&) = delete;
  CausalRunner& operator=(const CausalRunner&) = delete;

  /// Samples, then the frame. What is refused is counted and remembered.
  void Deliver(const Delivery& delivery);
  [[nodiscard]] const SlidingWindow& window() const;
  /// What there is until now.
  [[nodiscard]] const CausalRun& run() const;
  CausalRun Finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Called after each frame.
using AfterFrame = std::function<void()>;

/// Hands the recording to a window, frame by frame. After an interrupt: what there is until then.
Result<CausalRun> RunCausal(const Viotracks& recording, const ReplaySettings& settings,
                            const AfterFrame& after_frame);

/// The causal trajectory.
eval::Trajectory TrajectoryOf(const CausalRun& run);

}  // namespace glissade::app
