// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/gyro_rotation.h"

#include <algorithm>

#include "glissade/lie/so3.h"

namespace glissade::vision {

std::optional<BodyTurn> IntegrateGyro(std::span<const ImuSample> samples, std::int64_t from_ns,
                                      std::int64_t to_ns, const ImuBias& bias,
                                      std::int64_t max_gap_ns) {
  if (samples.empty() || to_ns <= from_ns) return {};
  const auto far = [&](std::int64_t a, std::int64_t b) {
    return NanosecondsBetween(std::min(a, b), std::max(a, b)) > max_gap_ns;
  };
  // The last sample at or before the beginning, or the first one.
  auto at = std::upper_bound(samples.begin(), samples.end(), from_ns,
                             [](std::int64_t t, const ImuSample& s) { return t < s.stamp_ns; });
  if (at != samples.begin()) --at;
  if (far(at->stamp_ns, from_ns)) return {};
  Quaternion q = Quaternion::Identity();
  for (std::int64_t now = from_ns; now < to_ns; ++at) {
    const auto next = at + 1;
    std::int64_t until = to_ns;
    if (next != samples.end()) {
      if (next->stamp_ns <= at->stamp_ns || far(at->stamp_ns, next->stamp_ns)) return {};
      until = std::min(to_ns, at->stamp_ns + NanosecondsBetween(at->stamp_ns, next->stamp_ns) / 2);
    } else if (far(at->stamp_ns, to_ns)) {
      return {};
    }
    if (!at->gyro.allFinite()) return {};
    if (until > now) {
      const Vector3 turn = SecondsBetween(now, until) * (at->gyro - bias.bg);
      q = Quaternion(q * so3::ExpQuaternion(turn));
      now = until;
    }
    if (next == samples.end() && now < to_ns) return {};
  }
  q.normalize();
  BodyTurn out;
  out.R_from_to = q.toRotationMatrix();
  if (!out.R_from_to.allFinite()) return {};
  return out;
}

}  // namespace glissade::vision
