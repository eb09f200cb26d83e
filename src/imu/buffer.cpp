// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/buffer.h"

#include <algorithm>
#include <string>

#include "glissade/base/validate.h"

namespace glissade {

namespace {

bool Saturated(const Vector3& x, double range) {
  return std::abs(x[0]) >= range || std::abs(x[1]) >= range || std::abs(x[2]) >= range;
}

std::string At(std::int64_t stamp_ns) {
  return "IMU sample at " + std::to_string(stamp_ns) + " ns";
}

}  // namespace

Status ImuBufferOptions::Validate() const {
  if (max_gap_ns <= 0) return {StatusCode::kInvalidArgument, "max_gap_ns must be > 0"};
  // Written so that NaN fails; infinity means no limit.
  if (!(gyro_range > 0.0)) return {StatusCode::kInvalidArgument, "gyro_range must be > 0"};
  if (!(accel_range > 0.0)) return {StatusCode::kInvalidArgument, "accel_range must be > 0"};
  return {};
}

ImuBuffer::ImuBuffer(const ImuBufferOptions& options)
    : options_(options.Validate().ok() ? options : ImuBufferOptions{}) {}

Status ImuBuffer::Add(const ImuSample& sample) {
  // Words are made for what is refused alone: a sample that is taken allocates nothing for them.
  for (const Vector3* v : {&sample.gyro, &sample.accel}) {
    if (internal::AllFinite(v->data(), 3)) continue;
    ++counts_.not_finite;
    return ValidateFinite(v->data(), 3, At(sample.stamp_ns));
  }
  if (counts_.accepted > 0) {
    // The last sample outlives DropBefore, so that there is always one to compare with.
    const std::int64_t last = samples_.back().stamp_ns;
    if (sample.stamp_ns == last) {
      ++counts_.duplicate;
      return {StatusCode::kDuplicate, At(sample.stamp_ns) + ": there is one of that stamp"};
    }
    if (sample.stamp_ns < last) {
      ++counts_.out_of_order;
      return {StatusCode::kInvalidArgument, At(sample.stamp_ns) + ": older than the last one, of " +
                                                std::to_string(last) + " ns"};
    }
    if (NanosecondsBetween(last, sample.stamp_ns) > options_.max_gap_ns) ++counts_.gaps;
  }
  if (begin_ > 0 && samples_.size() == samples_.capacity()) {
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
  }
  ImuSample& added = samples_.emplace_back(sample);
  added.gyro_saturated |= Saturated(sample.gyro, options_.gyro_range);
  added.accel_saturated |= Saturated(sample.accel, options_.accel_range);
  ++counts_.accepted;
  if (added.gyro_saturated || added.accel_saturated) ++counts_.saturated;
  return {};
}

Status ImuBuffer::Between(std::int64_t begin_ns, std::int64_t end_ns, ImuInterval* interval) const {
  interval->samples.clear();
  interval->largest_gap_ns = 0;
  interval->gaps = 0;
  const auto all = samples();
  const auto range = [&] {
    return "from " + std::to_string(begin_ns) + " to " + std::to_string(end_ns) + " ns";
  };
  if (begin_ns >= end_ns) {
    return {StatusCode::kInvalidArgument, "IMU interval " + range() + " is empty"};
  }
  if (all.empty() || all.front().stamp_ns > begin_ns || all.back().stamp_ns < end_ns) {
    return {StatusCode::kInvalidArgument,
            "IMU interval " + range() + " is not covered: there are samples " +
                (all.empty() ? std::string("of no time")
                             : "from " + std::to_string(all.front().stamp_ns) + " to " +
                                   std::to_string(all.back().stamp_ns) + " ns")};
  }
  const auto later = [](std::int64_t stamp, const ImuSample& s) { return stamp < s.stamp_ns; };
  const auto earlier = [](const ImuSample& s, std::int64_t stamp) { return s.stamp_ns < stamp; };
  // [first, last] are the recorded samples that have a part in the interval.
  const auto first = std::upper_bound(all.begin(), all.end(), begin_ns, later) - 1;
  const auto last = std::lower_bound(first, all.end(), end_ns, earlier);
  for (auto k = first; k != last; ++k) {
    const std::int64_t gap = NanosecondsBetween(k->stamp_ns, (k + 1)->stamp_ns);
    interval->largest_gap_ns = std::max(interval->largest_gap_ns, gap);
    if (gap > options_.max_gap_ns) ++interval->gaps;
  }
  interval->samples.reserve(static_cast<std::size_t>(last - first) + 1);
  interval->samples.push_back(Interpolate(*first, *(first + 1), begin_ns));
  for (auto k = first + 1; k != last; ++k)
    interval->samples.push_back(*k);
  interval->samples.push_back(Interpolate(*(last - 1), *last, end_ns));
  return {};
}

void ImuBuffer::DropBefore(std::int64_t stamp_ns) {
  while (begin_ + 1 < samples_.size() && samples_[begin_ + 1].stamp_ns <= stamp_ns)
    ++begin_;
}

}  // namespace glissade
