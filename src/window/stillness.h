// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/window/observation.h"
#include "glissade/window/stillness.h"
#include "window/track_table.h"
#include "window/verdicts.h"

/// \file
/// The tests of glissade/window/stillness.h for who asks at every frame: they allocate nothing.
namespace glissade::internal {

[[nodiscard]] StillnessTest TestStillness(std::span<const ImuSample> samples, const ImuNoise& noise,
                                          const StillnessOptions& options, Words words);

/// TestImageStillness with storage that serves again.
class ImageStillness {
 public:
  [[nodiscard]] ImageStillnessTest Test(std::span<const WindowCamera> cameras,
                                        std::span<const FrameObservations> frames,
                                        const StillnessOptions& options, Words words);

 private:
  /// Sums for a straight line through u(t), v(t) of a track in a camera.
  struct Line {
    int camera = 0;
    int n = 0;
    double t = 0.0, tt = 0.0, u = 0.0, v = 0.0, tu = 0.0, tv = 0.0;

    void Add(double at, double pu, double pv);
    /// (slope_u^2 / var_u + slope_v^2 / var_v) with the variances of a pixel.
    [[nodiscard]] double Chi2(double var_u, double var_v) const;
  };
  Line& LineOf(int camera, std::int64_t track);

  std::vector<TrackTable> line_of_track_;  // one for each camera
  std::vector<Line> lines_;
};

}  // namespace glissade::internal
