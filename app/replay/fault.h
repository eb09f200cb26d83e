// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/options.h"
#include "glissade/io/replay.h"

/// \file
/// What goes wrong between sensors and an estimator, done to a recording on purpose.
namespace glissade::app {

enum class FaultKind : std::uint8_t {
  kImuGap,           ///< no samples
  kNoFeatures,       ///< frames in which nothing is seen
  kAllOutliers,      ///< every feature is anywhere in the image
  kCameraLost,       ///< nothing of the second camera
  kNanPixels,        ///< every second feature is not a number
  kImuSaturated,     ///< readings clipped and marked: half of the largest rate and motion
  kFrameDuplicate,   ///< each frame twice
  kFrameOutOfOrder,  ///< frames in pairs, the later one first
  kImuOutOfOrder,    ///< samples in pairs, the later one first
  kImuDuplicate,     ///< each sample twice
};

/// "imu-gap", ...: the words of --fault, in the order of the enumeration.
const std::vector<std::string>& FaultNames();

/// From begin_s to end_s after the first frame.
struct Fault {
  FaultKind kind = FaultKind::kImuGap;
  double begin_s = 0.0, end_s = 0.0;

  [[nodiscard]] bool Holds(std::int64_t stamp_ns, std::int64_t first_frame_ns) const {
    const double t = 1e-9 * static_cast<double>(stamp_ns - first_frame_ns);
    return t >= begin_s && t < end_s;
  }
};

/// "imu-gap@10..12".
Result<Fault> ParseFault(const std::string& text);

/// Which of some names, and when: what "NAME@T..T" says.
struct NamedTime {
  std::size_t name = 0;
  double begin_s = 0.0, end_s = 0.0;
};
Result<NamedTime> ParseNamedTime(const std::vector<std::string>& names, const std::string& text);

/// The option --fault of a program; `parse` makes a fault of a text.
template <class FaultType>
void AddFaults(CLI::App& cli, Result<FaultType> (*parse)(const std::string&),
               std::vector<FaultType>* faults) {
  cli.add_option_function<std::vector<std::string>>(
         "--fault",
         [parse, faults](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const auto fault = parse(text);
             if (!fault.ok()) RefuseOption(fault.status().message());
             faults->push_back(*fault);
           }
         },
         "KIND@T..T: goes wrong from T to T, seconds after the first frame; may be repeated")
      ->type_name("FAULT")
      ->allow_extra_args(false);
}

/// The recording with what happens to its IMU.
Viotracks WithImuFaults(Viotracks recording, std::span<const Fault> faults);

/// What arrives at the estimator: samples first, then the frame.
struct Delivery {
  std::size_t frame = 0;  ///< in the recording
  std::int64_t stamp_ns = 0;
  std::vector<ImuSample> imu;
  std::vector<FrameObservation> observations;
};

/// A replay with what happens to its frames. The same faults give the same outliers.
class FaultyReplay {
 public:
  /// The recording must outlive it.
  FaultyReplay(const Viotracks& recording, const ReplayOptions& options, std::vector<Fault> faults);

  /// The next delivery; null where there is none.
  const Delivery* Next();

 private:
  bool Take(Delivery* delivery);  // the next frame of the recording, its features tampered with
  void Tamper(Delivery* delivery);
  [[nodiscard]] bool Happens(FaultKind kind, std::size_t frame) const;

  const Viotracks* recording_;
  ViotracksReplay replay_;
  std::vector<Fault> faults_;
  std::mt19937_64 random_{1};
  Delivery current_, waiting_;
  bool is_waiting_ = false;
};

}  // namespace glissade::app
