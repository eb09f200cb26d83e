// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Beginning anew, with what can still be trusted.
#include <algorithm>
#include <array>
#include <cmath>

#include "glissade/base/validate.h"
#include "window/sliding_window_impl.h"

namespace glissade {

namespace {

/// What is remembered of biases is this much less certain than it was.
constexpr double kWidening = 3.0;

double Largest(std::span<const double, 15 * 15> covariance, std::size_t first) {
  double variance = 0.0;
  for (std::size_t k = first; k < first + 3; ++k)
    variance = std::max(variance, covariance[16 * k]);
  return std::sqrt(variance);
}

}  // namespace

bool SlidingWindow::Impl::IsPlausible() const {
  const VertexSpeedBias& state = newest.speed_bias;
  if (!internal::AllFinite(newest.T_w_b.data, 7) || !internal::AllFinite(state.data, 9)) {
    return false;
  }
  const ImuBiasPrior& prior = options.bias_prior;
  return state.v().norm() <= options.max_speed &&
         (state.ba() - prior.mean.ba).norm() <= options.max_bias_sigmas * prior.accel_sigma &&
         (state.bg() - prior.mean.bg).norm() <= options.max_bias_sigmas * prior.gyro_sigma;
}

Status SlidingWindow::Impl::ClearGraph() {
  problem = Problem();
  frames.clear();
  preintegrations.clear();
  num_landmarks = 0;
  tracks.Clear();
  summary = nullptr;
  anchor_frame = -1;
  failed_solves = 0;
  Count(WindowEvent::kReset);
  return problem.SetFirstEstimates(options.first_estimates);
}

Status SlidingWindow::Reset() {
  Impl& w = impl();
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  const WindowState state = w.newest;
  if (Status s = w.ClearGraph(); !s.ok()) return s;
  const ImuBiasPrior& prior = w.options.bias_prior;
  return w.Start(state, InitialSigmas{.tilt = 0.05,
                                      .speed = 0.5,
                                      .accel_bias = prior.accel_sigma,
                                      .gyro_bias = prior.gyro_sigma});
}

void SlidingWindow::Reinitialize() {
  Impl& w = impl();
  if (w.phase != WindowPhase::kRunning) return;
  w.bias_prior = w.options.bias_prior;
  if (w.IsPlausible()) {
    w.resume_at = w.newest.T_w_b;
    std::array<double, 15 * 15> covariance{};
    if (w.HasImu() && NewestCovariance(covariance).ok()) {
      w.bias_prior.mean = {w.newest.speed_bias.ba(), w.newest.speed_bias.bg()};
      const auto widened = [&](std::size_t first, double most) {
        const double sigma = kWidening * Largest(covariance, first);
        return sigma > 0.0 ? std::min(sigma, most) : most;
      };
      w.bias_prior.accel_sigma = widened(9, w.bias_prior.accel_sigma);
      w.bias_prior.gyro_sigma = widened(12, w.bias_prior.gyro_sigma);
    }
  }
  static_cast<void>(w.ClearGraph());  // the modes of first estimates are valid, a graph is empty
  w.phase = WindowPhase::kInitializing;
  w.seen.clear();
  w.init_verdict = {};
}

}  // namespace glissade
