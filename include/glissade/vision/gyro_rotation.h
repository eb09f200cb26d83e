// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "glissade/base/matrix.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"

namespace glissade::vision {

/// How a body turned between two instants.
struct BodyTurn {
  Matrix3 R_from_to = Matrix3::Identity();  ///< axes of the later body in those of the earlier
};

/// From the rates of the gyroscope, less their bias, each rate holding until the middle to the
/// next. Samples are in the order of time; where they do not reach one of the stamps the nearest
/// rate is held. Absent: to_ns <= from_ns, samples further apart, or further from a stamp, than
/// max_gap_ns, rates that are not finite.
[[nodiscard]] std::optional<BodyTurn> IntegrateGyro(std::span<const ImuSample> samples,
                                                    std::int64_t from_ns, std::int64_t to_ns,
                                                    const ImuBias& bias = {},
                                                    std::int64_t max_gap_ns = kMaxImuGapNs);

}  // namespace glissade::vision
