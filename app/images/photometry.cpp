// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/photometry.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

#include "glissade/imu/sample.h"
#include "glissade/sim/noise_source.h"

namespace glissade::app {

namespace {

constexpr std::uint64_t kPhaseStream = 303;
constexpr std::uint64_t kNoiseStream = 310;  // and one more for each camera

constexpr double kDriftPeriodsS[2] = {11.0, 4.7};
constexpr double kDriftParts[2] = {0.75, 0.25};

constexpr double kTargetGrey = 100.0;
constexpr double kExposureStep = 1.08;
constexpr std::int64_t kExposureStepNs = 100'000'000;  // at most ten times a second

}  // namespace

Photometry::Photometry(const PhotometryOptions& options, int camera, int width, int height)
    : options_(options),
      camera_(camera),
      width_(width),
      height_(height),
      next_step_ns_(std::numeric_limits<std::int64_t>::min()) {
  sim::NoiseSource random(options.seed, kPhaseStream);
  for (int k = 0; k <= camera; ++k)
    for (double& phase : phase_)
      phase = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1), corner2 = cx * cx + cy * cy;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double r2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / std::max(corner2, 1.0);
      vignette_.push_back(static_cast<float>(1.0 - options.vignette * r2));
    }
  }
}

vision::Image Photometry::Capture(const std::vector<float>& light, std::int64_t stamp_ns) {
  if (!first_stamp_ns_) first_stamp_ns_ = stamp_ns;
  const double t = SecondsBetween(*first_stamp_ns_, stamp_ns);
  double drift = 0.0;
  for (int k = 0; k < 2; ++k) {
    drift += kDriftParts[k] * std::sin(2.0 * std::numbers::pi * t / kDriftPeriodsS[k] + phase_[k]);
  }
  gain_ = exposure_ * std::exp(options_.gain_drift * drift);

  cv::Mat noise = cv::Mat::zeros(height_, width_, CV_32F);
  if (options_.noise > 0.0) {
    sim::NoiseSource seed(options_.seed ^ static_cast<std::uint64_t>(stamp_ns),
                          kNoiseStream + static_cast<std::uint64_t>(camera_));
    cv::RNG(seed.Next()).fill(noise, cv::RNG::NORMAL, 0.0, options_.noise);
  }
  vision::Image image;
  image.width = width_;
  image.height = height_;
  image.pixels.resize(light.size());
  const auto gain = static_cast<float>(gain_);
  const float* added = noise.ptr<float>();
  double sum = 0.0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const float grey = gain * vignette_[i] * light[i] + added[i] + 0.5f;
    image.pixels[i] = static_cast<std::uint8_t>(std::min(std::max(grey, 0.0f), 255.0f));
    sum += image.pixels[i];
  }
  if (options_.auto_exposure) Adjust(sum / static_cast<double>(light.size()), stamp_ns);
  return image;
}

/// For the images that come: a step towards the mean that is wanted, once it is off by more than
/// two steps.
void Photometry::Adjust(double mean, std::int64_t stamp_ns) {
  if (stamp_ns < next_step_ns_) return;
  const double off = std::log(kTargetGrey / std::max(mean, 1.0)) / std::log(kExposureStep);
  if (std::abs(off) < 2.0) return;
  exposure_ *= off > 0.0 ? kExposureStep : 1.0 / kExposureStep;
  next_step_ns_ = stamp_ns + kExposureStepNs;
}

}  // namespace glissade::app
