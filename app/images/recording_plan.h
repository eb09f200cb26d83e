// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/vision/image_recording.h"
#include "images/flight.h"
#include "images/flight_source.h"

namespace glissade::app {

struct PlanOptions {
  double start_s = 0.0;   ///< after the beginning of the truth
  double seconds = 0.0;   ///< 0: to its end
  double rate_hz = 20.0;  ///< of frames
  bool mono = false;      ///< the first camera only
  std::string ending = "png";
};

/// A recording of that part of a flight, to be written to `folder`: all but the images. Truth is at
/// the frames; the IMU begins with the last reading before the first frame and ends with the first
/// one after the last. kInvalidArgument: nothing is left, or poses of the truth are more than a
/// second apart.
[[nodiscard]] Result<vision::ImageRecording> PlanRecording(const FlightSource& source,
                                                           const PlanOptions& options,
                                                           const std::string& folder,
                                                           Flight* flight);

}  // namespace glissade::app
