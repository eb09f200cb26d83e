// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/vision/image_recording.h"
#include "glissade/vision/tracker_options.h"
#include "replay/causal_run.h"

namespace glissade::app {

/// All that can be set of a run on images.
struct RunConfig {
  // camera
  bool mono = false;
  double sigma_px = 0.7;
  double time_offset_s = 0.0;
  // tracker
  vision::TrackerOptions tracker;
  // imu
  bool use_imu = true;
  double noise_scale = 3.0, walk_scale = 1.0;
  double gyro_range = 0.0, accel_range = 0.0;  ///< 0: none
  double gravity = 9.81;
  // window
  WindowSettings window;
  std::string first_estimates = "full";
  WindowBudget budget;
  KeyframeRules keyframes;
  double max_chi2 = SlidingWindowOptions().max_chi2;

  RunConfig();
};

/// Keys that a YAML file gives; the others keep their values. kIoError, or kParseError with
/// "file:line: what" for unknown keys, wrong types and values out of range.
Status ReadConfig(const std::string& path, RunConfig* config);

/// A file that ReadConfig takes, with what each key means.
std::string ConfigText(const RunConfig& config);

/// The window for a recording; refused where the two do not go together.
Result<SlidingWindowOptions> WindowOptions(const vision::ImageRecording& recording,
                                           const RunConfig& config);

}  // namespace glissade::app
