// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run/vio_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "glissade/problem/problem.h"

namespace glissade::app {

namespace {

constexpr std::size_t kTailLength = 12;

/// Those of a window's events that are worth a line in a log.
constexpr WindowEvent kToldEvents[] = {
    WindowEvent::kInitialized,  WindowEvent::kFrameWithoutLandmarks, WindowEvent::kImuGap,
    WindowEvent::kImuSaturated, WindowEvent::kStandingStill,         WindowEvent::kSolveFailed,
    WindowEvent::kReset,        WindowEvent::kFrameRefused};

}  // namespace

VioSession::VioSession(const vision::ImageRecording& recording, const RunConfig& config,
                       const RunSettings& settings, SlidingWindowOptions options,
                       const SessionOutputs& outputs, std::size_t first_frame)
    : recording_(recording),
      outputs_(outputs),
      offset_ns_(std::llround(1e9 * config.time_offset_s)),
      first_stamp_ns_(recording.frames[first_frame].stamp_ns + offset_ns_),
      has_imu_(options.imu_noise.has_value()),
      tracker_(recording.cameras, config.tracker),
      runner_(settings, options, first_stamp_ns_) {
  std::vector<std::int64_t> gaps;
  const vision::ImageFrame* last = nullptr;
  for (const vision::ImageFrame& frame : recording.frames) {
    if (frame.files[0].empty()) continue;
    if (last != nullptr) gaps.push_back(frame.stamp_ns - last->stamp_ns);
    last = &frame;
  }
  if (!gaps.empty()) {
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    period_ns_ = *middle;
  }
  // A device that is switched on has no samples of the time before.
  const auto& imu = recording.imu;
  while (next_imu_ + 1 < imu.size() && imu[next_imu_ + 1].stamp_ns <= first_stamp_ns_)
    ++next_imu_;
  tracks_.origin = "images";
  tracks_.gravity = Vector3(0.0, 0.0, -options.gravity);
  for (std::size_t k = 0; k < options.cameras.size(); ++k) {
    const WindowCamera& c = options.cameras[k];
    const vision::Camera& image = recording.cameras[k];
    tracks_.cameras.push_back(
        {c.fx, c.fy, c.cx, c.cy, image.width, image.height, c.sigma_px, c.T_b_c});
  }
  tracks_.imu_noise = options.imu_noise;
  tracks_.imu_rate_hz = recording.imu_rate_hz;
  tracks_.ground_truth = recording.ground_truth;
}

void VioSession::TakeImu(std::int64_t stamp_ns, Delivery* delivery) {
  // Up to the first one at or after the frame.
  const auto& imu = recording_.imu;
  while (has_imu_ && next_imu_ < imu.size()) {
    const bool last = imu[next_imu_].stamp_ns >= stamp_ns;
    if (last && next_imu_ > 0 && imu[next_imu_ - 1].stamp_ns >= stamp_ns) break;
    delivery->imu.push_back(imu[next_imu_++]);
    if (last) break;
  }
}

void VioSession::Take(const SourceFrame& source) {
  Delivery delivery;
  delivery.frame = source.index;
  delivery.stamp_ns = source.stamp_ns + offset_ns_;
  TakeImu(delivery.stamp_ns, &delivery);

  std::optional<vision::BodyTurn> turn;
  if (const auto last = tracker_.last_stamp_ns(); last && has_imu_) {
    // Before there is a state the bias is not known; the tracker allows for that.
    ImuBias bias;
    if (window().phase() == WindowPhase::kRunning) bias.bg = window().newest().speed_bias.bg();
    turn = vision::IntegrateGyro(recording_.imu, *last, delivery.stamp_ns, bias);
  }
  VisionFrame frame;
  frame.frame = source.index;
  frame.t = 1e-9 * static_cast<double>(delivery.stamp_ns - first_stamp_ns_);
  frame.decode_ms = source.decode_ms;
  const Status tracked = tracker_.Track(delivery.stamp_ns, source.views(), turn, &frame.report);
  if (tracked.ok()) {
    const auto observations = tracker_.observations();
    delivery.observations.assign(observations.begin(), observations.end());
    for (const vision::Feature& f : tracker_.features())
      frame.features += f.camera == 0 ? 1 : 0;
  }
  // Before there is a state the window looks for one, which takes its time, too.
  const std::size_t timed = runner_.run().ms.total.size();
  const double begin = ClockMs(false);
  runner_.Deliver(delivery);
  const auto& ms = runner_.run().ms.total;
  frame.window_ms = ms.size() > timed ? ms.back() : ClockMs(false) - begin;
  frame.running = window().phase() == WindowPhase::kRunning;
  frames_.push_back(frame);
  NoteEvents(frame, tracked);
  if (outputs_.tracks) NoteTracks(delivery);
  if (!tracked.ok()) return;
  if (outputs_.landmarks) NoteLandmarks();
  if (outputs_.thumbnails > 0) {
    NoteTails();
    NoteThumbnail(source, frame.t);
  }
}

void VioSession::NoteEvents(const VisionFrame& frame, const Status& tracked) {
  std::vector<std::string> now;
  for (std::size_t k = 0; k < vision::kNumTrackerEvents; ++k) {
    if (frame.report.events[k]) {
      now.emplace_back(vision::ToString(static_cast<vision::TrackerEvent>(k)));
    }
  }
  for (const WindowEvent event : kToldEvents) {
    if (window().recent_events()[event] > 0) now.emplace_back(ToString(event));
  }
  if (frames_.size() > 1) {
    const double gap = frame.t - latest_t_;
    if (gap > 1.6e-9 * static_cast<double>(period_ns_)) now.emplace_back("frame missing");
  }
  latest_t_ = std::max(latest_t_, frame.t);
  // The window refuses what the tracker refuses, but an image of another size.
  if (!tracked.ok() && window().recent_events()[WindowEvent::kFrameRefused] == 0) {
    now.push_back(tracked.message());
  }
  constexpr double kSoon = 0.25;  // s
  for (const std::string& what : now) {
    const auto known = last_event_.find(what);
    if (known != last_event_.end() && frame.t - events_[known->second].last_t <= kSoon) {
      ++events_[known->second].frames;
      events_[known->second].last_t = frame.t;
    } else {
      last_event_[what] = events_.size();
      events_.push_back({frame.t, what, 1, frame.t});
    }
  }
}

void VioSession::NoteLandmarks() {
  const Problem& problem = window().problem();
  for (const WindowLandmark& landmark : window().view().landmarks) {
    if (!landmark.InGraph()) continue;
    const VertexPointXYZ* point = problem.Find(landmark.point);
    if (point != nullptr) landmarks_[landmark.track] = point->p();
  }
}

void VioSession::NoteTails() {
  std::map<std::int64_t, Thumbnail::Tail> tails;
  for (const vision::Feature& f : tracker_.features()) {
    if (f.camera != 0) continue;
    Thumbnail::Tail& tail = tails[f.track];
    if (const auto known = tails_.find(f.track); known != tails_.end()) {
      tail = std::move(known->second);
    }
    tail.age = f.age;
    tail.px.push_back({static_cast<float>(f.px[0]), static_cast<float>(f.px[1])});
    if (tail.px.size() > kTailLength) tail.px.erase(tail.px.begin());
  }
  tails_ = std::move(tails);
}

void VioSession::NoteThumbnail(const SourceFrame& frame, double t) {
  if (t < next_thumbnail_s_) return;
  next_thumbnail_s_ += outputs_.seconds / outputs_.thumbnails;
  const vision::Image& image = frame.images[0];
  Thumbnail thumbnail;
  thumbnail.t = t;
  thumbnail.shrink = std::max(1, image.width / 320);
  thumbnail.width = image.width / thumbnail.shrink;
  thumbnail.height = image.height / thumbnail.shrink;
  auto jpeg = vision::EncodeJpeg(image.view(), thumbnail.shrink);
  if (!jpeg.ok()) return;
  thumbnail.jpeg = std::move(jpeg).value();
  for (const auto& entry : tails_)
    thumbnail.tails.push_back(entry.second);
  thumbnails_.push_back(std::move(thumbnail));
}

void VioSession::NoteTracks(const Delivery& delivery) {
  tracks_.imu.insert(tracks_.imu.end(), delivery.imu.begin(), delivery.imu.end());
  if (window().recent_events()[WindowEvent::kFrameRefused] > 0) return;
  const auto index = static_cast<std::int32_t>(tracks_.frames.size());
  tracks_.frames.push_back({static_cast<std::int32_t>(delivery.frame), delivery.stamp_ns});
  for (const FrameObservation& o : delivery.observations) {
    tracks_.tracks.push_back({index, static_cast<std::int32_t>(o.track), o.camera, o.u, o.v});
  }
}

double VioSession::SecondsOf(std::int64_t stamp_ns) const {
  return 1e-9 * static_cast<double>(stamp_ns - first_stamp_ns_);
}

std::string VioSession::StatusText() const {
  if (frames_.empty()) return {};
  const VisionFrame& f = frames_.back();
  std::string where = "looking for a start";
  if (f.running) {
    const auto p = window().newest().T_w_b.p();
    where = fmt::format("at {:.2f} {:.2f} {:.2f} m", p[0], p[1], p[2]);
  }
  // Within the 79 columns of a terminal.
  std::string stages = fmt::format("{:.1f}+{:.1f}+{:.1f}+{:.1f}", f.report.contrast_ms,
                                   f.report.track_ms, f.report.reject_ms, f.report.detect_ms);
  if (tracker_.cameras().size() > 1) stages += fmt::format("+{:.1f}", f.report.stereo_ms);
  return fmt::format("{:.1f} s, {}, {} features, {}+{:.1f} ms", f.t, where, f.features, stages,
                     f.window_ms);
}

}  // namespace glissade::app
