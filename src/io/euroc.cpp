// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/euroc.h"
#include "glissade/base/out_of_memory.h"

#include <cmath>
#include <limits>

#include "io/csv_reader.h"

namespace glissade {

namespace {

using internal::CsvReader;

std::int64_t Stamp(CsvReader& in) {
  constexpr auto kLimits = std::numeric_limits<std::int64_t>();
  return in.Integer(0, kLimits.min(), kLimits.max(), "timestamp_ns");
}

/// Fails unless stamps increase.
void ExpectLater(CsvReader& in, bool first, std::int64_t before, std::int64_t stamp) {
  if (in.ok() && !first && stamp <= before) {
    in.Fail("timestamp " + std::to_string(stamp) + " is not later than " + std::to_string(before));
  }
}

}  // namespace

Result<std::vector<ImuSample>> ReadEurocImu(const std::string& path, Reading reading) {
  return internal::OrOutOfMemory([&]() -> Result<std::vector<ImuSample>> {
    auto reader = CsvReader::Open(path);
    if (!reader.ok()) return reader.status();
    CsvReader& in = reader.value();
    if (reading == Reading::kAsRecorded) in.AllowNonFinite();
    std::vector<ImuSample> samples;
    while (in.NextRow()) {
      in.ExpectFields(7, "timestamp_ns, wx, wy, wz, ax, ay, az");
      ImuSample& s = samples.emplace_back();
      s.stamp_ns = Stamp(in);
      in.Numbers(1, 3, s.gyro.data(), "angular rate");
      in.Numbers(4, 3, s.accel.data(), "specific force");
    }
    if (!in.ok()) return in.status();
    return samples;
  });
}

Result<std::vector<GroundTruthState>> ReadEurocGroundTruth(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<std::vector<GroundTruthState>> {
    auto reader = CsvReader::Open(path);
    if (!reader.ok()) return reader.status();
    CsvReader& in = reader.value();
    std::vector<GroundTruthState> states;
    while (in.NextRow()) {
      if (in.num_fields() != 8) {
        in.ExpectFields(17, "a time, a pose, and perhaps velocity and biases (8 or 17)");
      }
      const bool whole = in.num_fields() == 17;
      GroundTruthState x;
      x.stamp_ns = Stamp(in);
      ExpectLater(in, states.empty(), states.empty() ? 0 : states.back().stamp_ns, x.stamp_ns);
      double q[4];  // w x y z
      in.Numbers(1, 3, x.T_w_b.data, "position");
      in.Numbers(4, 4, q, "quaternion");
      const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (in.ok() && !(std::abs(norm - 1.0) < 1e-3)) {
        in.Fail("quaternion has norm " + std::to_string(norm) + ", not 1");
      }
      x.T_w_b.q() = Quaternion(q[0], q[1], q[2], q[3]);
      x.T_w_b.Normalize();
      if (whole) {
        VertexSpeedBias& s = x.speed_bias.emplace();
        in.Numbers(8, 3, s.v().data(), "velocity");
        in.Numbers(11, 3, s.bg().data(), "gyroscope bias");
        in.Numbers(14, 3, s.ba().data(), "accelerometer bias");
      }
      states.push_back(x);
    }
    if (!in.ok()) return in.status();
    return states;
  });
}

Result<std::vector<std::int64_t>> ReadEurocStamps(const std::string& path, Reading reading) {
  return internal::OrOutOfMemory([&]() -> Result<std::vector<std::int64_t>> {
    auto reader = CsvReader::Open(path);
    if (!reader.ok()) return reader.status();
    CsvReader& in = reader.value();
    std::vector<std::int64_t> stamps;
    while (in.NextRow()) {
      if (in.num_fields() != 1) in.ExpectFields(2, "timestamp_ns, file name");
      const std::int64_t stamp = Stamp(in);
      if (reading == Reading::kChecked) {
        ExpectLater(in, stamps.empty(), stamps.empty() ? 0 : stamps.back(), stamp);
      }
      stamps.push_back(stamp);
    }
    if (!in.ok()) return in.status();
    return stamps;
  });
}

}  // namespace glissade
