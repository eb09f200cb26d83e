// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run/image_source.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "replay/fault.h"

namespace glissade::app {

namespace {

/// In the order of the enumeration.
const std::vector<std::string>& FaultWords() {
  static const std::vector<std::string> words = {"dropped", "repeated", "out-of-order", "black",
                                                 "bright",  "blurred",  "covered"};
  return words;
}

/// Averages of 60 px along the rows: what a camera sees that turns while its shutter is open.
void Blur(vision::Image* image) {
  constexpr int kLength = 60;
  std::vector<int> sums(static_cast<std::size_t>(image->width) + 1);
  for (int y = 0; y < image->height; ++y) {
    std::uint8_t* row =
        image->pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image->width);
    for (int x = 0; x < image->width; ++x)
      sums[static_cast<std::size_t>(x) + 1] = sums[static_cast<std::size_t>(x)] + row[x];
    for (int x = 0; x < image->width; ++x) {
      const int low = std::max(0, x - kLength / 2), high = std::min(image->width, low + kLength);
      row[x] = static_cast<std::uint8_t>(
          (sums[static_cast<std::size_t>(high)] - sums[static_cast<std::size_t>(low)]) /
          (high - low));
    }
  }
}

}  // namespace

Result<ImageFault> ParseImageFault(const std::string& text) {
  const auto parsed = ParseNamedTime(FaultWords(), text);
  if (!parsed.ok()) return parsed.status();
  return ImageFault{static_cast<ImageFaultKind>(parsed->name), parsed->begin_s, parsed->end_s};
}

std::vector<vision::ImageView> SourceFrame::views() const {
  std::vector<vision::ImageView> views;
  for (const vision::Image& image : images)
    views.push_back(image.pixels.empty() ? vision::ImageView() : image.view());
  return views;
}

ImageSource::ImageSource(const vision::ImageRecording& recording, const ImageSourceOptions& options)
    : recording_(recording), options_(options) {
  const auto& frames = recording.frames;
  const auto seconds = [&](std::size_t k) {
    return SecondsBetween(frames[0].stamp_ns, frames[k].stamp_ns);
  };
  while (begin_ < frames.size() && seconds(begin_) < options.start_s)
    ++begin_;
  end_ = begin_;
  while (end_ < frames.size() && seconds(end_) <= options.start_s + options.seconds)
    ++end_;
  for (std::size_t k = begin_; k < end_; ++k) {
    if (recording.frames[k].files[0].empty()) continue;  // the first camera has none
    if (Faulty(ImageFaultKind::kDropped, k) && (k - begin_) % 2 == 1) continue;
    order_.push_back(k);
  }
  for (std::size_t k = 0; k + 1 < order_.size(); k += 2) {
    if (Faulty(ImageFaultKind::kOutOfOrder, order_[k])) std::swap(order_[k], order_[k + 1]);
  }
}

double ImageSource::SecondsOf(std::size_t frame) const {
  return 1e-9 * static_cast<double>(recording_.frames[frame].stamp_ns -
                                    recording_.frames[begin_].stamp_ns);
}

bool ImageSource::Faulty(ImageFaultKind kind, std::size_t frame) const {
  const double t = SecondsOf(frame);
  return std::any_of(options_.faults.begin(), options_.faults.end(), [&](const ImageFault& fault) {
    return fault.kind == kind && t >= fault.begin_s && t <= fault.end_s;
  });
}

void ImageSource::WaitForFrame() {
  if (!started_) {
    started_ = Clock::now();
    return;
  }
  const auto time_of = [&](std::size_t k) {
    return *started_ + std::chrono::nanoseconds(
                           std::llround(1e9 * (SecondsOf(order_[k]) - SecondsOf(order_[0]))));
  };
  std::this_thread::sleep_until(time_of(next_));
  const auto now = Clock::now();
  while (next_ + 1 < order_.size() && time_of(next_ + 1) <= now) {
    ++next_;
    ++dropped_;
  }
}

Result<std::optional<SourceFrame>> ImageSource::Next() {
  if (next_ >= order_.size()) return std::optional<SourceFrame>();
  if (options_.realtime) WaitForFrame();
  const auto begin = Clock::now();
  SourceFrame frame;
  frame.index = order_[next_];
  frame.stamp_ns = recording_.frames[frame.index].stamp_ns;
  const bool repeated = Faulty(ImageFaultKind::kRepeated, frame.index) && next_ % 2 == 1;
  if (Status s = Decode(repeated ? order_[next_ - 1] : frame.index, &frame); !s.ok()) return s;
  ++next_;
  const auto taken = Clock::now() - begin;
  frame.decode_ms = std::chrono::duration<double, std::milli>(taken).count();
  if (started_) *started_ += taken;
  return std::optional<SourceFrame>(std::move(frame));
}

Status ImageSource::Decode(std::size_t index, SourceFrame* out) {
  for (const std::string& file : recording_.frames[index].files) {
    vision::Image& image = out->images.emplace_back();
    if (!file.empty()) {
      auto read = vision::ReadImage(file);
      if (!read.ok()) return read.status();
      image = std::move(read).value();
      Spoil(index, &image);
    }
  }
  return {};
}

void ImageSource::Spoil(std::size_t frame, vision::Image* image) {
  auto& pixels = image->pixels;
  if (Faulty(ImageFaultKind::kBlack, frame)) std::fill(pixels.begin(), pixels.end(), 0);
  if (Faulty(ImageFaultKind::kBright, frame)) std::fill(pixels.begin(), pixels.end(), 255);
  if (Faulty(ImageFaultKind::kBlurred, frame)) Blur(image);
  if (Faulty(ImageFaultKind::kCovered, frame)) {
    for (std::uint8_t& x : pixels)
      x = static_cast<std::uint8_t>(12 + random_() % 5);
  }
}

}  // namespace glissade::app
