// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "glissade/vision/image_recording.h"
#include "images/flight.h"
#include "images/photometry.h"
#include "images/scene.h"

namespace glissade::app {

struct RenderOptions {
  PhotometryOptions photometry;
  double exposure_ms = 4.0;  ///< the shutter is open; a stamp is the middle of that
  int blur_samples = 8;      ///< at most so many views are averaged, about one a pixel of motion
  int jpeg_quality = 95;
};

struct RenderFigures {
  int images = 0;
  double views = 0.0;  ///< of all images together
  double render_s = 0.0, write_s = 0.0;
  [[nodiscard]] double total_s() const { return render_s + write_s; }
};

/// Renders and writes the images of all frames to their files, whose folders are there. After
/// Ctrl-C the recording ends with the frame at work. `progress` is told after each frame which part
/// is done. kIoError where a file cannot be written.
Result<RenderFigures> RenderRecording(
    const RenderOptions& options, const Scene& scene, Flight* flight,
    vision::ImageRecording* recording,
    const std::function<void(const RenderFigures& figures, double part)>& progress);

}  // namespace glissade::app
