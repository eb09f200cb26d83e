// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "glissade/io/viotracks.h"
#include "replay/causal_run.h"

namespace glissade::app {

/// Whether the newest states are as wrong as their covariance says: the normalized estimation error
/// squared in the gauge of the window's oldest frame, in the mean over the frames that have a true
/// pose. 3 is expected; more says that the covariance is too small.
struct Consistency {
  double nees_position = 0.0;
  double nees_rotation = 0.0;
  std::size_t frames = 0;
};

/// The newest pose's error in position, m, axes of the estimate's world, as seen from the window's
/// oldest frame: what its sigmas are about. Absent where the truth (gravity against z, ReferenceOf)
/// does not reach.
std::optional<std::array<double, 3>> ErrorFromOldest(const FrameEstimate& estimate,
                                                     const eval::Trajectory& truth, bool has_imu);

/// Of a run with ReplaySettings::covariance; absent where the recording has no truth to hold it
/// against. Stamps of estimates are moved by -time_offset_s to those of the truth.
std::optional<Consistency> ConsistencyOf(const CausalRun& run, const Viotracks& recording,
                                         double time_offset_s, bool has_imu);

}  // namespace glissade::app
