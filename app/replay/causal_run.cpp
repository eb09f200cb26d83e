// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/causal_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "common/interrupt.h"
#include "glissade/io/replay.h"
#include "glissade/minimizer/summary.h"

namespace glissade::app {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Asks another policy, and remembers when it was asked: there the window begins to slide.
class PolicyWithClock : public WindowPolicy {
 public:
  PolicyWithClock(std::shared_ptr<WindowPolicy> policy, bool wall_clock)
      : policy_(std::move(policy)), wall_clock_(wall_clock) {}
  void Decide(const WindowView& window, WindowPlan* plan) override {
    asked_ms_ = ClockMs(wall_clock_);
    asked_wall_ms_ = ClockMs(true);
    policy_->Decide(window, plan);
  }
  void Forget() { asked_ms_ = asked_wall_ms_ = kNaN; }
  [[nodiscard]] double asked_ms() const { return asked_ms_; }
  [[nodiscard]] double asked_wall_ms() const { return asked_wall_ms_; }

 private:
  std::shared_ptr<WindowPolicy> policy_;
  bool wall_clock_;
  double asked_ms_ = kNaN, asked_wall_ms_ = kNaN;
};

/// Observations in a window's graph, by the recording's frames.
std::set<ObservationKey> InGraph(const WindowView& view,
                                 const std::map<std::int64_t, std::size_t>& frame_of_stamp) {
  std::map<std::int64_t, std::size_t> frame_of_id;
  for (const WindowFrame& frame : view.frames) {
    const auto known = frame_of_stamp.find(frame.stamp_ns);
    if (known != frame_of_stamp.end()) frame_of_id[frame.id] = known->second;
  }
  std::set<ObservationKey> keys;
  for (const WindowLandmark& landmark : view.landmarks) {
    for (const LandmarkObservation& o : landmark.observations) {
      const auto frame = frame_of_id.find(o.frame);
      if (o.edge.slot == kNullSlot || frame == frame_of_id.end()) continue;
      keys.insert({landmark.track, frame->second, o.camera});
    }
  }
  return keys;
}

/// Those that a solve took out of frames and landmarks that are both still there.
void CollectRejected(const std::set<ObservationKey>& before, const std::set<ObservationKey>& after,
                     std::vector<ObservationKey>* rejected) {
  std::set<std::size_t> frames;
  std::set<std::int64_t> tracks;
  for (const ObservationKey& key : after) {
    frames.insert(key.frame);
    tracks.insert(key.track);
  }
  for (const ObservationKey& key : before) {
    if (frames.contains(key.frame) && tracks.contains(key.track) && !after.contains(key)) {
      rejected->push_back(key);
    }
  }
}

/// By malloc, at present; 0 where it does not say.
double AllocatedBytes() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0.0;
#endif
}

bool IsFinite(const WindowState& state) {
  double sum = 0.0;
  for (const double x : state.T_w_b.data)
    sum += x;
  for (const double x : state.speed_bias.data)
    sum += x;
  return std::isfinite(sum);
}

}  // namespace

double ClockMs(bool wall_clock) {
  timespec t{};
  clock_gettime(wall_clock ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

class CausalRunner::Impl {
 public:
  Impl(const RunSettings& settings, SlidingWindowOptions options, std::int64_t first_stamp_ns)
      : settings_(settings),
        has_imu_(options.imu_noise.has_value()),
        first_stamp_ns_(first_stamp_ns),
        policy_(std::make_shared<PolicyWithClock>(options.policy, settings.wall_clock)),
        window_(WithPolicy(std::move(options), policy_)) {}

  void Deliver(const Delivery& delivery) {
    ++run_.frames_delivered;
    const double begin = ClockMs(settings_.wall_clock);
    // Samples that make no sense are counted by the window's events.
    if (has_imu_) static_cast<void>(window_.AddImu(delivery.imu));
    if (const Status s = window_.AddFrame(delivery.stamp_ns, delivery.observations); !s.ok()) {
      ++run_.frames_refused;
      Remember(delivery, s);
      return;
    }
    if (window_.phase() != WindowPhase::kRunning) return;
    const double added = ClockMs(settings_.wall_clock);
    std::set<ObservationKey> before;
    if (settings_.observations) {
      frame_of_stamp_[delivery.stamp_ns] = delivery.frame;
      before = InGraph(window_.view(), frame_of_stamp_);
    }
    Optimize(delivery, added - begin);
    if (settings_.observations) {
      CollectRejected(before, InGraph(window_.view(), frame_of_stamp_), &run_.rejected_keys);
    }
    Read(delivery);
  }

  [[nodiscard]] const SlidingWindow& window() const { return window_; }
  [[nodiscard]] const CausalRun& run() const { return run_; }

  CausalRun Finish() {
    // All that was allocated since, but for what a run remembers.
    const double remembered = static_cast<double>(
        run_.estimates.capacity() * sizeof(FrameEstimate) +
        sizeof(double) *
            (run_.ms.total.capacity() + run_.ms.add.capacity() + run_.ms.solve.capacity() +
             run_.ms.reject.capacity() + run_.ms.slide.capacity() + run_.ms.covariance.capacity()));
    if (const double now = AllocatedBytes(); now > 0.0) {
      run_.window_mb = 1e-6 * std::max(0.0, now - allocated_before_ - remembered);
    }
    run_.events = window_.total_events();
    std::sort(run_.rejected_keys.begin(), run_.rejected_keys.end());
    return std::move(run_);
  }

 private:
  static SlidingWindowOptions WithPolicy(SlidingWindowOptions options,
                                         std::shared_ptr<WindowPolicy> policy) {
    options.policy = std::move(policy);
    return options;
  }

  void Remember(const Delivery& delivery, const Status& status) {
    if (!run_.first_refusal.empty()) return;
    run_.first_refusal = fmt::format("frame {}: {}", delivery.frame, status.message());
  }

  /// The window tells when it begins to slide (by asking its policy), and how long its solve took
  /// by the clock on the wall. So solve and reject are told apart in frames only that nobody else's
  /// work has held up: the two clocks agree.
  void Optimize(const Delivery& delivery, double add_ms) {
    policy_->Forget();
    const double begin = ClockMs(settings_.wall_clock), begin_wall = ClockMs(true);
    const Status solved = window_.Optimize(settings_.budget);
    const double end = ClockMs(settings_.wall_clock), end_wall = ClockMs(true);
    if (!solved.ok()) {
      ++run_.solves_failed;
      Remember(delivery, solved);
    }
    const bool slid = std::isfinite(policy_->asked_ms());
    const double slide_at = slid ? policy_->asked_ms() : end;
    run_.ms.total.push_back(add_ms + end - begin);
    run_.ms.add.push_back(add_ms);
    run_.ms.slide.push_back(end - slide_at);
    const double before = slide_at - begin;
    const double before_wall = (slid ? policy_->asked_wall_ms() : end_wall) - begin_wall;
    const double solve_wall = 1e3 * window_.summary().time.total_s;
    if (before_wall > 1.1 * before + 0.01 || solve_wall > before_wall) return;
    run_.ms.solve.push_back(solve_wall);
    run_.ms.reject.push_back(before_wall - solve_wall);
  }

  void Read(const Delivery& delivery) {
    const WindowState& state = window_.newest();
    if (state.stamp_ns != delivery.stamp_ns || !IsFinite(state)) return;
    if (!run_.initialized_at_s) {
      run_.initialized_at_s = 1e-9 * static_cast<double>(state.stamp_ns - first_stamp_ns_);
    }
    FrameEstimate estimate;
    estimate.frame = delivery.frame;
    estimate.state = state;
    estimate.ms = run_.ms.total.back();
    const WindowView view = window_.view();
    if (!view.frames.empty()) {
      estimate.oldest = {view.frames.front().stamp_ns, view.frames.front().T_w_b};
    }
    estimate.num_frames = static_cast<int>(view.frames.size());
    for (const WindowLandmark& landmark : view.landmarks)
      estimate.num_landmarks += landmark.InGraph() ? 1 : 0;
    for (const WindowFrame& frame : view.frames)
      estimate.num_observations += frame.num_observations;
    estimate.sigmas.fill(kNaN);
    estimate.pose_covariance.fill(kNaN);
    if (settings_.covariance) ReadSigmas(&estimate);
    run_.estimates.push_back(estimate);
  }

  void ReadSigmas(FrameEstimate* estimate) {
    const std::size_t n = has_imu_ ? 15 : 6;
    std::vector<double> covariance(n * n);
    const double begin = ClockMs(settings_.wall_clock);
    if (!window_.NewestCovariance(covariance).ok()) return;
    run_.ms.covariance.push_back(ClockMs(settings_.wall_clock) - begin);
    for (std::size_t k = 0; k < 36; ++k)
      estimate->pose_covariance[k] = covariance[n * (k / 6) + k % 6];
    for (std::size_t k = 0; k < n; ++k)
      estimate->sigmas[k] = std::sqrt(std::max(0.0, covariance[k * n + k]));
  }

  RunSettings settings_;
  double allocated_before_ = AllocatedBytes();
  bool has_imu_;
  std::int64_t first_stamp_ns_;
  std::shared_ptr<PolicyWithClock> policy_;
  SlidingWindow window_;
  std::map<std::int64_t, std::size_t> frame_of_stamp_;
  CausalRun run_;
};

CausalRunner::CausalRunner(const RunSettings& settings, SlidingWindowOptions options,
                           std::int64_t first_stamp_ns)
    : impl_(std::make_unique<Impl>(settings, std::move(options), first_stamp_ns)) {}
CausalRunner::~CausalRunner() = default;
void CausalRunner::Deliver(const Delivery& delivery) {
  impl_->Deliver(delivery);
}
const SlidingWindow& CausalRunner::window() const {
  return impl_->window();
}
const CausalRun& CausalRunner::run() const {
  return impl_->run();
}
CausalRun CausalRunner::Finish() {
  return impl_->Finish();
}

FirstEstimates ParseFirstEstimates(const std::string& word) {
  if (word == "off") return FirstEstimates::kOff;
  return word == "prior" ? FirstEstimates::kPriorOnly : FirstEstimates::kFull;
}

std::shared_ptr<WindowPolicy> MakePolicy(const WindowSettings& s) {
  if (s.policy == "vins") return std::make_shared<TwoWayPolicy>(s.frames + s.keyframes);
  if (s.policy == "basalt") return std::make_shared<LeastSeenKeyframePolicy>(s.frames, s.keyframes);
  if (s.policy == "lag") return std::make_shared<FixedLagPolicy>(s.lag_s);
  return std::make_shared<OkvisPolicy>(s.frames, s.keyframes);
}

Result<SlidingWindowOptions> WindowOptions(const Viotracks& recording,
                                           const ReplaySettings& settings) {
  SlidingWindowOptions options;
  options.cameras = WindowCameras(recording, settings.mono ? 1 : 2);
  if (!settings.no_imu) options.imu_noise = recording.imu_noise;
  options.gravity = recording.gravity.norm();
  options.policy = MakePolicy(settings);
  options.first_estimates = settings.first_estimates;
  const auto refused = [](std::string why) {
    return Status(StatusCode::kInvalidArgument, std::move(why));
  };
  if (recording.frames.empty()) return refused("the recording has no frames");
  if (options.cameras.size() < 2 && !options.imu_noise) {
    return refused("one camera and no IMU: nothing tells the scale");
  }
  for (const Fault& fault : settings.faults) {
    if (fault.kind == FaultKind::kCameraLost && options.cameras.size() < 2) {
      return refused("--fault: camera-lost needs a second camera");
    }
  }
  if (Status s = options.Validate(); !s.ok()) return s;
  return options;
}

Result<CausalRun> RunCausal(const Viotracks& recording, const ReplaySettings& settings,
                            const AfterFrame& after_frame) {
  auto options = WindowOptions(recording, settings);
  if (!options.ok()) return options.status();
  const Viotracks faulty = WithImuFaults(recording, settings.faults);
  const std::size_t num_cameras = options->cameras.size();
  CausalRunner runner(
      settings, std::move(options).value(),
      recording.frames.front().stamp_ns + std::llround(1e9 * settings.time_offset_s));
  FaultyReplay replay(faulty, {.num_cameras = num_cameras, .time_offset_s = settings.time_offset_s},
                      settings.faults);
  while (const Delivery* delivery = replay.Next()) {
    if (Interrupted()) break;
    runner.Deliver(*delivery);
    if (after_frame) after_frame();
  }
  return runner.Finish();
}

eval::Trajectory TrajectoryOf(const CausalRun& run) {
  eval::Trajectory trajectory;
  for (const FrameEstimate& estimate : run.estimates)
    trajectory.push_back({estimate.state.stamp_ns, estimate.state.T_w_b});
  return trajectory;
}

}  // namespace glissade::app
