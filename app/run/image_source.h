// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "glissade/vision/image.h"
#include "glissade/vision/image_recording.h"

namespace glissade::app {

enum class ImageFaultKind : std::uint8_t {
  kDropped,     ///< every second frame is missing
  kRepeated,    ///< every second frame is the one before, under its own stamp
  kOutOfOrder,  ///< in pairs, the later one first
  kBlack,
  kBright,   ///< overexposed
  kBlurred,  ///< by the motion of a shaken hand, 60 px
  kCovered,  ///< dark grey, with noise
};

/// What goes wrong from T to T, seconds after the first frame.
struct ImageFault {
  ImageFaultKind kind;
  double begin_s = 0.0, end_s = 0.0;
};

/// "black@3..3.5"; kInvalidArgument names what is wrong.
Result<ImageFault> ParseImageFault(const std::string& text);

/// What the cameras hand over.
struct SourceFrame {
  std::size_t index = 0;  ///< in the recording
  std::int64_t stamp_ns = 0;
  std::vector<vision::Image> images;  ///< empty ones: this camera has none
  double decode_ms = 0.0;

  [[nodiscard]] std::vector<vision::ImageView> views() const;
};

struct ImageSourceOptions {
  double start_s = 0.0, seconds = 1e9;  ///< part of the recording
  /// Frames come at their time; those that come while nobody asks are lost but for the newest. The
  /// clock stands still while an image is decoded: a camera hands over pixels.
  bool realtime = false;
  std::vector<ImageFault> faults;
};

/// Frames of a recording, one after another, decoded when they are asked for.
class ImageSource {
 public:
  /// The recording must outlive it.
  ImageSource(const vision::ImageRecording& recording, const ImageSourceOptions& options);

  /// Of the part: indices in the recording, first to last.
  [[nodiscard]] std::size_t begin() const { return begin_; }
  [[nodiscard]] std::size_t end() const { return end_; }
  /// The next frame; absent where there is none; a status where an image cannot be read.
  Result<std::optional<SourceFrame>> Next();
  /// Frames that were lost for want of time.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] double SecondsOf(std::size_t frame) const;
  [[nodiscard]] bool Faulty(ImageFaultKind kind, std::size_t frame) const;
  void WaitForFrame();
  Status Decode(std::size_t frame, SourceFrame* out);
  void Spoil(std::size_t frame, vision::Image* image);

  const vision::ImageRecording& recording_;
  ImageSourceOptions options_;
  std::size_t begin_ = 0, end_ = 0;
  std::vector<std::size_t> order_;  // of the frames to come
  std::size_t next_ = 0;
  std::int64_t dropped_ = 0;
  std::optional<Clock::time_point> started_;
  std::mt19937 random_{1};
};

}  // namespace glissade::app
