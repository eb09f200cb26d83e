// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "arrays.h"
#include "glissade/imu/sample.h"

namespace glissade::python {

/// Stamps [ns] (n,), angular rate [rad/s] and specific force [m/s^2] (n, 3).
std::vector<ImuSample> SamplesFrom(const IndexLike& stamps_ns, const ArrayLike& gyro,
                                   const ArrayLike& accel);
/// The same as a tuple of arrays.
nb::tuple ArraysOf(std::span<const ImuSample> samples);

}  // namespace glissade::python
