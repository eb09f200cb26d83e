// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/imu/sample.h"

namespace glissade {

struct ImuBufferOptions {
  /// Two neighbours further apart than this are counted as a gap. What becomes of one is for
  /// preintegration to say (ImuNoise::gaps).
  std::int64_t max_gap_ns = kMaxImuGapNs;
  /// Range of the sensors: a sample with an axis at or beyond it is marked saturated.
  double gyro_range = std::numeric_limits<double>::infinity();   ///< rad/s
  double accel_range = std::numeric_limits<double>::infinity();  ///< m/s^2

  [[nodiscard]] Status Validate() const;
};

/// What a buffer has been given since it was made.
struct ImuBufferCounts {
  std::int64_t accepted = 0;
  std::int64_t saturated = 0;  ///< of those accepted
  std::int64_t gaps = 0;       ///< between those accepted
  std::int64_t out_of_order = 0;
  std::int64_t duplicate = 0;
  std::int64_t not_finite = 0;
};

/// The samples of an interval, its ends interpolated.
struct ImuInterval {
  std::vector<ImuSample> samples;
  std::int64_t largest_gap_ns = 0;  ///< between neighbours in the recording
  int gaps = 0;                     ///< neighbours further apart than max_gap_ns
};

/// IMU samples in the order of time. What does not fit is refused with a status and counted, and
/// the buffer stays as it was. Storage is kept: a buffer that is emptied as fast as it is filled
/// does not allocate.
class ImuBuffer {
 public:
  /// Options that make no sense are replaced by the defaults; ask Validate() before.
  explicit ImuBuffer(const ImuBufferOptions& options = {});

  /// Refuses: a stamp seen last (kDuplicate), an older one (kInvalidArgument), a value that is not
  /// finite (kNotFinite).
  Status Add(const ImuSample& sample);

  /// Samples from begin_ns to end_ns, begin < end, with both ends interpolated where no sample has
  /// that stamp. kInvalidArgument where the buffer does not reach that far: nothing is
  /// extrapolated. A gap is no failure here; it is reported in the result,
  /// and samples that were interpolated say over what (ImuSample::interpolated_over_ns).
  Status Between(std::int64_t begin_ns, std::int64_t end_ns, ImuInterval* interval) const;

  /// Forgets what is not needed for intervals that begin at or after stamp_ns: everything before
  /// the last sample at or before it.
  void DropBefore(std::int64_t stamp_ns);

  [[nodiscard]] std::span<const ImuSample> samples() const {
    return std::span<const ImuSample>(samples_).subspan(begin_);
  }
  [[nodiscard]] const ImuBufferCounts& counts() const { return counts_; }
  [[nodiscard]] const ImuBufferOptions& options() const { return options_; }

 private:
  ImuBufferOptions options_;
  std::vector<ImuSample> samples_;
  std::size_t begin_ = 0;  // dropped: [0, begin_)
  ImuBufferCounts counts_;
};

}  // namespace glissade
