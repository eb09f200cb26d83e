// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glissade/io/viotracks.h"
#include "glissade/vision/feature_tracker.h"
#include "glissade/vision/image_recording.h"
#include "replay/causal_run.h"
#include "run/image_source.h"
#include "run/run_config.h"

namespace glissade::app {

/// What the front end did in one frame.
struct VisionFrame {
  std::size_t frame = 0;  ///< in the recording
  double t = 0.0;         ///< s, after the first frame
  vision::TrackerReport report;
  int features = 0;
  double window_ms = 0.0, decode_ms = 0.0;
  bool running = false;
};

/// Something that a reader of a log wants to know; what comes again soon is the same event.
struct RunEvent {
  double t = 0.0;  ///< s, of the first frame
  std::string what;
  int frames = 1;       ///< that had it
  double last_t = 0.0;  ///< s, of the last one
};

struct Thumbnail {
  double t = 0.0;
  int shrink = 1, width = 0, height = 0;  ///< px, of the picture
  std::vector<std::uint8_t> jpeg;
  /// Places of each feature's track until then, newest last; px of the image.
  struct Tail {
    int age = 0;
    std::vector<std::array<float, 2>> px;
  };
  std::vector<Tail> tails;
};

struct SessionOutputs {
  bool landmarks = false;
  int thumbnails = 0;  ///< about so many over `seconds`
  double seconds = 0.0;
  bool tracks = false;  ///< to be saved
};

/// A recording of images through a front end into a window, frame by frame.
class VioSession {
 public:
  /// The recording must outlive it.
  VioSession(const vision::ImageRecording& recording, const RunConfig& config,
             const RunSettings& settings, SlidingWindowOptions options,
             const SessionOutputs& outputs, std::size_t first_frame);

  /// A frame. What the tracker or the window refuse is an event.
  void Take(const SourceFrame& frame);
  CausalRun Finish() { return runner_.Finish(); }

  [[nodiscard]] const std::vector<VisionFrame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<RunEvent>& events() const { return events_; }
  [[nodiscard]] const std::vector<Thumbnail>& thumbnails() const { return thumbnails_; }
  /// The last known place of each landmark, W.
  [[nodiscard]] const std::map<std::int64_t, Vector3>& landmarks() const { return landmarks_; }
  /// All that was handed to the window.
  [[nodiscard]] const Viotracks& tracks() const { return tracks_; }
  [[nodiscard]] const vision::FeatureTracker& tracker() const { return tracker_; }
  [[nodiscard]] const SlidingWindow& window() const { return runner_.window(); }
  /// s, after the first frame.
  [[nodiscard]] double SecondsOf(std::int64_t stamp_ns) const;
  /// "12.3 s, at 1.20 -0.35 0.80 m, 150 features, 2.1+2.7+0.3+1.0+4.6+1.5 ms": contrast, track,
  /// reject, detect, stereo (of two cameras), window.
  [[nodiscard]] std::string StatusText() const;

 private:
  void TakeImu(std::int64_t stamp_ns, Delivery* delivery);
  void NoteEvents(const VisionFrame& frame, const Status& tracked);
  void NoteLandmarks();
  void NoteTails();
  void NoteThumbnail(const SourceFrame& frame, double t);
  void NoteTracks(const Delivery& delivery);

  const vision::ImageRecording& recording_;
  SessionOutputs outputs_;
  std::int64_t offset_ns_, first_stamp_ns_;
  bool has_imu_;
  vision::FeatureTracker tracker_;
  CausalRunner runner_;
  std::size_t next_imu_ = 0;
  std::vector<VisionFrame> frames_;
  std::vector<RunEvent> events_;
  std::map<std::string, std::size_t> last_event_;  // of each kind
  double latest_t_ = 0.0;                          // s, of the frames until now
  std::int64_t period_ns_ = 0;                     // the usual time between frames
  std::vector<Thumbnail> thumbnails_;
  double next_thumbnail_s_ = 0.0;
  std::map<std::int64_t, Thumbnail::Tail> tails_;
  std::map<std::int64_t, Vector3> landmarks_;
  Viotracks tracks_;
};

}  // namespace glissade::app
