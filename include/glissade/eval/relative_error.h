// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/eval/association.h"
#include "glissade/eval/statistics.h"

/// \file
/// Relative pose error (RPE): how much an odometry drifts over a time or a distance. Of a pair of
/// poses i < j the error is E = (T_ref,i^-1 T_ref,j)^-1 (T_est,i^-1 T_est,j) (Sturm et al., IROS
/// 2012, Eq. 1); no alignment by a rigid motion changes it.
namespace glissade::eval {

/// Of one pair.
struct PairError {
  std::size_t first = 0, last = 0;  ///< positions in the matched trajectories
  double translation_m = 0.0;       ///< |p of E|
  double rotation_deg = 0.0;        ///< |Log of E|, 0 to 180
};

struct TimeRpeOptions {
  std::int64_t interval_ns = 1'000'000'000;
  /// The most by which the time between the two poses of a pair may differ from the interval;
  /// negative: a tenth of the interval.
  std::int64_t tolerance_ns = -1;
  /// A pair begins at every n-th pose.
  int every = 1;

  [[nodiscard]] Status Validate() const;
};

struct TimeRpe {
  Statistics translation_m;
  Statistics rotation_deg;
  std::vector<PairError> pairs;
};

/// From each start to the pose whose stamp is nearest to interval_ns later (the earlier of two as
/// near), if it is within the tolerance; none where the trajectory ends before. Refused: what
/// MatchedTrajectories::Validate and the options refuse, and trajectories without a single such
/// pair (kInvalidArgument); kNotFinite where squares overflow.
[[nodiscard]] Result<TimeRpe> RpeOverTime(const MatchedTrajectories& matched,
                                          const TimeRpeOptions& options = {});

struct DistanceRpeOptions {
  /// m, > 0, increasing. The default are KITTI's.
  std::vector<double> lengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
  /// A segment begins at every n-th pose; 10 with KITTI.
  int every = 1;

  [[nodiscard]] Status Validate() const;
};

/// Of the segments of one length.
struct SegmentErrors {
  double length_m = 0.0;
  Statistics translation_percent;  ///< of 100 |p of E| / length
  Statistics rotation_deg_per_m;   ///< of |Log of E| / length
  std::vector<PairError> pairs;
};

struct DistanceRpe {
  std::vector<SegmentErrors> by_length;  ///< as in lengths_m; a count of 0 where none is so long
  /// Over the segments of all lengths, each counted once: the mean is what KITTI's table shows.
  Statistics translation_percent;
  Statistics rotation_deg_per_m;
};

/// A segment goes from its start i to the first pose j whose way along the reference's matched
/// poses, sum of |p_k+1 - p_k|, is at least the length; where the reference ends before, there is
/// no segment (A. Geiger et al., "Are we ready for autonomous driving?", CVPR 2012, and the code of
/// its benchmark). Refused as above.
[[nodiscard]] Result<DistanceRpe> RpeOverDistance(const MatchedTrajectories& matched,
                                                  const DistanceRpeOptions& options = {});

}  // namespace glissade::eval
