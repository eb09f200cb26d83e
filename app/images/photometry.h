// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "glissade/vision/image.h"

namespace glissade::app {

/// What a sensor makes of the light that reaches it.
struct PhotometryOptions {
  double noise = 2.0;          ///< sigma of a pixel, grey values
  double vignette = 0.25;      ///< part of the light that is lost in the corners
  double gain_drift = 0.15;    ///< size of the slow change of the natural logarithm of the gain
  bool auto_exposure = false;  ///< steps of the gain that keep the mean grey value near 100
  std::uint64_t seed = 1;
};

/// Of one camera.
class Photometry {
 public:
  Photometry(const PhotometryOptions& options, int camera, int width, int height);

  /// The image of what a Renderer gives: times gain and vignette, noise on top, rounded and cut off
  /// at 0 and 255. Stamps increase. The noise depends on seed, camera and stamp alone.
  vision::Image Capture(const std::vector<float>& light, std::int64_t stamp_ns);
  /// Of the last image.
  [[nodiscard]] double gain() const { return gain_; }

 private:
  void Adjust(double mean, std::int64_t stamp_ns);

  PhotometryOptions options_;
  int camera_, width_, height_;
  std::vector<float> vignette_;  // factor of each pixel
  double phase_[2];              // of the drift
  double exposure_ = 1.0;        // what auto-exposure has come to
  double gain_ = 1.0;
  std::optional<std::int64_t> first_stamp_ns_;
  std::int64_t next_step_ns_;
};

}  // namespace glissade::app
