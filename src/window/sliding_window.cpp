// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/sliding_window.h"

#include <algorithm>
#include <array>
#include <utility>

#include "glissade/base/index.h"
#include "glissade/covariance/transform.h"
#include "window/sliding_window_impl.h"

namespace glissade {

using internal::Index;

SlidingWindow::Impl::Impl(SlidingWindowOptions o)
    : options(std::move(o)), options_status(options.Validate()) {
  if (!options.policy) options.policy = std::make_shared<OkvisPolicy>();
  if (!options_status.ok()) return;
  imu = ImuBuffer(options.imu);
  bias_prior = options.bias_prior;
  options_status = problem.SetFirstEstimates(options.first_estimates);
}

int SlidingWindow::Impl::FrameIndex(std::int64_t id) const {
  if (!frames.empty() && frames.back().id == id) return static_cast<int>(frames.size()) - 1;
  const auto at =
      std::lower_bound(frames.begin(), frames.end(), id,
                       [](const WindowFrame& frame, std::int64_t x) { return frame.id < x; });
  return at != frames.end() && at->id == id ? static_cast<int>(at - frames.begin()) : -1;
}

void SlidingWindow::Impl::Count(WindowEvent event, std::int64_t times) {
  total[event] += times;
  recent[event] += times;
}

Status SlidingWindow::Impl::Refused(Status why) {
  Count(WindowEvent::kFrameRefused);
  return why;
}

Gauge SlidingWindow::Impl::WindowGauge() const {
  return Gauge::Fixed{.anchor = frames.front().pose,
                      .reference = {},
                      .second = {},
                      .group = HasImu() ? GaugeGroup::kVisualInertial : GaugeGroup::kStereo};
}

void SlidingWindow::Impl::ReadStates() {
  for (WindowFrame& frame : frames)
    frame.T_w_b = problem.Get(frame.pose).pose;
  const WindowFrame& last = frames.back();
  newest.stamp_ns = last.stamp_ns;
  newest.T_w_b = last.T_w_b;
  if (last.HasSpeedBias()) newest.speed_bias = problem.Get(last.speed_bias);
}

SlidingWindow::SlidingWindow(SlidingWindowOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}
SlidingWindow::~SlidingWindow() = default;
SlidingWindow::SlidingWindow(SlidingWindow&&) noexcept = default;
SlidingWindow& SlidingWindow::operator=(SlidingWindow&&) noexcept = default;

SlidingWindow::Impl& SlidingWindow::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>(SlidingWindowOptions());
  return *impl_;
}
const SlidingWindow::Impl& SlidingWindow::impl() const {
  static const Impl none{SlidingWindowOptions()};
  return impl_ != nullptr ? *impl_ : none;
}

Status SlidingWindow::AddImu(std::span<const ImuSample> samples) {
  if (!impl().options_status.ok()) return impl().options_status;
  if (!impl().HasImu()) {
    return {StatusCode::kInvalidArgument, "IMU samples, but the options have no imu_noise"};
  }
  Status first;
  for (const ImuSample& sample : samples) {
    bool clock_was_set = false;
    Status s = impl().AddSample(sample, &clock_was_set);
    if (clock_was_set) Reinitialize();
    if (s.ok()) continue;
    impl().Count(WindowEvent::kImuSampleRefused);
    if (first.ok()) first = std::move(s);
  }
  return first;
}

Status SlidingWindow::AddFrame(std::int64_t stamp_ns,
                               std::span<const FrameObservation> observations,
                               KeyframeChoice keyframe) {
  Impl& w = impl();
  if (!w.options_status.ok()) return w.options_status;
  w.recent = {};
  if (w.FrameClockWasSet(stamp_ns)) {
    Reinitialize();
    w.seen.clear();
  }
  if (w.phase == WindowPhase::kInitializing) {
    if (Status s = w.CheckFrameStamp(stamp_ns); !s.ok()) return w.Refused(std::move(s));
    w.Remember(stamp_ns, observations);
    const std::size_t refused = observations.size() - w.seen.back().observations.size();
    if (Status s = TryToStart(stamp_ns); !s.ok()) return s;
    if (w.phase == WindowPhase::kInitializing) {
      // Nobody else will look at them.
      if (refused > 0) {
        w.Count(WindowEvent::kObservationRefused, static_cast<std::int64_t>(refused));
      }
      w.last_stamp_ns = stamp_ns;
      w.ForgetSamples();
      return {};
    }
  } else {
    if (Status s = Propagate(stamp_ns); !s.ok()) return w.Refused(std::move(s));
    w.Remember(stamp_ns, observations);
  }
  if (Status s = Associate(observations); !s.ok()) return s;
  if (Status s = TriangulateTracks(); !s.ok()) return s;
  if (Status s = UseStillness(); !s.ok()) return s;
  ChooseKeyframe(keyframe);
  return {};
}

Status SlidingWindow::Optimize(const WindowBudget& budget) {
  if (!impl().options_status.ok()) return impl().options_status;
  if (impl().phase == WindowPhase::kInitializing) return {};
  if (Status s = Solve(budget); !s.ok()) {
    if (impl().failed_solves >= impl().options.max_failed_solves) Reinitialize();
    return s;
  }
  if (!impl().IsPlausible()) {
    Reinitialize();
    return {};
  }
  if (Status s = RejectOutliers(); !s.ok()) return s;
  if (Status s = ReplaceImuTerms(); !s.ok()) return s;
  return Slide();
}

Status SlidingWindow::Solve(const WindowBudget& budget) {
  Impl& w = impl();
  if (w.frames.empty()) return {};
  SolveOptions options;
  options.max_iterations = budget.max_iterations;
  options.max_time_s = budget.max_time_s;
  options.cost_tolerance = w.options.cost_tolerance;
  options.initial_lambda = 1e-6;
  // No rule here, so that the last step need not be linearized.
  options.gradient_tolerance = 0.0;
  // Associate() has seen to it.
  options.allow_duplicate_observations = true;
  options.gauge = w.WindowGauge();
  // A budget that makes no sense is no failed solve.
  if (Status s = options.Validate(); !s.ok()) return s;
  w.summary = &w.problem.Solve(options);
  if (!w.summary->ok()) {
    w.Count(WindowEvent::kSolveFailed);
    // What could not be solved has no edge to be solved: the first frame of a window without IMU.
    if (w.summary->status.code() != StatusCode::kNothingToSolve) {
      ++w.failed_solves;
      return w.summary->status;
    }
  }
  w.failed_solves = 0;
  w.ReadStates();
  return {};
}

WindowPhase SlidingWindow::phase() const {
  return impl().phase;
}
const InitVerdict& SlidingWindow::init_verdict() const {
  return impl().init_verdict;
}
double SlidingWindow::initial_scale_sigma() const {
  return impl().initial_scale_sigma;
}
const WindowState& SlidingWindow::newest() const {
  return impl().newest;
}
WindowView SlidingWindow::view() const {
  return {impl().frames,
          std::span<const WindowLandmark>(impl().landmarks).first(impl().num_landmarks)};
}
const Problem& SlidingWindow::problem() const {
  return impl().problem;
}
const SolveSummary& SlidingWindow::summary() const {
  static const SolveSummary none;
  return impl().summary != nullptr ? *impl().summary : none;
}
const WindowEventCounts& SlidingWindow::total_events() const {
  return impl().total;
}
const WindowEventCounts& SlidingWindow::recent_events() const {
  return impl().recent;
}

Result<JointCovariance> SlidingWindow::Impl::JointOfNewest() {
  const WindowFrame& oldest = frames.front();
  const WindowFrame& last = frames.back();
  std::array<AnyVertex, 3> vertices;
  std::size_t count = 0;
  if (frames.size() > 1) vertices[count++] = oldest.pose;
  vertices[count++] = last.pose;
  if (last.HasSpeedBias()) vertices[count++] = last.speed_bias;
  const std::span<const AnyVertex> asked = std::span(vertices).first(count);
  const Gauge gauge = WindowGauge();
  Result<JointCovariance> joint = problem.CovarianceOfLastSolve(asked);
  if (joint.ok()) {
    // The frame that was the oldest then may have left.
    return joint->gauge.anchor == gauge.anchor ? std::move(joint)
                                               : TransformCovariance(*joint, gauge);
  }
  // No solve has known the newest frame yet.
  CovarianceOptions options;
  options.gauge = gauge;
  if (Status s = covariance.Compute(&problem, options); !s.ok()) return s;
  return covariance.Joint(asked);
}

Status SlidingWindow::NewestCovariance(std::span<double> covariance) {
  Impl& w = impl();
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  const WindowFrame& last = w.frames.back();
  const std::size_t size = last.HasSpeedBias() ? 15 : 6;
  if (covariance.size() != size * size) {
    return {StatusCode::kInvalidArgument, size == 15 ? "covariance must have 15 x 15 numbers"
                                                     : "covariance must have 6 x 6 numbers"};
  }
  const Result<JointCovariance> joint = w.JointOfNewest();
  if (!joint.ok()) return joint.status();
  // The anchor, where it is another frame, comes first.
  const auto n = static_cast<std::size_t>(joint->size()), skipped = n - size;
  for (std::size_t k = 0; k < size; ++k)
    std::copy_n(joint->values.data() + (skipped + k) * n + skipped, size,
                covariance.data() + k * size);
  return {};
}

Result<NullspaceReport> SlidingWindow::CheckNullspace() {
  NullspaceOptions options;
  options.group = impl().HasImu() ? GaugeGroup::kVisualInertial : GaugeGroup::kStereo;
  return impl().problem.CheckNullspace(options);
}

}  // namespace glissade
