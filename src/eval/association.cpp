// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/association.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>

#include "eval/elapsed.h"
#include "glissade/base/out_of_memory.h"

namespace glissade::eval {

namespace {

using Poses = std::span<const StampedPose>;

std::string Covered(Poses trajectory) {
  if (trajectory.empty()) return "has no pose";
  char text[96];
  std::snprintf(text, sizeof(text), "covers %.3f to %.3f s",
                1e-9 * static_cast<double>(trajectory.front().stamp_ns),
                1e-9 * static_cast<double>(trajectory.back().stamp_ns));
  return text;
}

Status NothingMatches(Poses estimate, Poses reference) {
  return {StatusCode::kInvalidArgument,
          std::string("no pose of the estimate has one of the reference: the estimate ")
              .append(Covered(estimate))
              .append(", the reference ")
              .append(Covered(reference))};
}

/// The first pose at or after a stamp; size() where there is none.
std::size_t FirstFrom(Poses trajectory, std::int64_t stamp_ns) {
  const auto at =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                       [](const StampedPose& x, std::int64_t stamp) { return x.stamp_ns < stamp; });
  return static_cast<std::size_t>(at - trajectory.begin());
}

/// The pose nearest to a stamp, of a trajectory that is not empty.
std::size_t Nearest(Poses trajectory, std::int64_t stamp_ns) {
  const std::size_t after = FirstFrom(trajectory, stamp_ns);
  if (after == 0) return 0;
  if (after == trajectory.size()) return after - 1;
  const bool earlier = internal::Elapsed(trajectory[after - 1].stamp_ns, stamp_ns) <=
                       internal::Elapsed(stamp_ns, trajectory[after].stamp_ns);
  return earlier ? after - 1 : after;
}

/// stamp + offset; false where no int64 holds it.
bool Shifted(std::int64_t stamp_ns, std::int64_t offset_ns, std::int64_t* shifted) {
  constexpr auto kLimits = std::numeric_limits<std::int64_t>();
  if (offset_ns > 0 ? stamp_ns > kLimits.max() - offset_ns : stamp_ns < kLimits.min() - offset_ns) {
    return false;
  }
  *shifted = stamp_ns + offset_ns;
  return true;
}

class Matcher {
 public:
  Matcher(Poses reference, const AssociationOptions& options)
      : reference_(reference), options_(options) {}

  void AddInterpolated(const StampedPose& estimate, std::int64_t stamp_ns) {
    const auto pose = PoseAt(reference_, stamp_ns, options_.max_gap_ns);
    if (pose) Add(estimate, *pose);
  }

  /// `shifted` is the estimate with the offset in its stamps: who else wants the same reference?
  void AddNearest(const StampedPose& estimate, std::size_t k, Poses shifted) {
    const std::int64_t stamp_ns = shifted[k].stamp_ns;
    const StampedPose& nearest = reference_[Nearest(reference_, stamp_ns)];
    const auto tolerance = static_cast<std::uint64_t>(options_.tolerance_ns);
    if (internal::Apart(stamp_ns, nearest.stamp_ns) > tolerance) return;
    if (Nearest(shifted, nearest.stamp_ns) == k) Add(estimate, nearest.T_w_b);
  }

  MatchedTrajectories matched;

 private:
  void Add(const StampedPose& estimate, const Pose& reference) {
    matched.estimate.push_back(estimate);
    matched.reference.push_back({estimate.stamp_ns, reference});
  }

  Poses reference_;
  const AssociationOptions& options_;
};

}  // namespace

std::optional<Pose> PoseAt(std::span<const StampedPose> trajectory, std::int64_t stamp_ns,
                           std::int64_t max_gap_ns) {
  const std::size_t after = FirstFrom(trajectory, stamp_ns);
  if (after == trajectory.size()) return {};
  if (trajectory[after].stamp_ns == stamp_ns) return trajectory[after].T_w_b;
  if (after == 0) return {};
  const StampedPose &a = trajectory[after - 1], &b = trajectory[after];
  if (internal::Elapsed(a.stamp_ns, b.stamp_ns) > static_cast<std::uint64_t>(max_gap_ns)) return {};
  return Interpolate(a, b, stamp_ns).T_w_b;
}

Status AssociationOptions::Validate() const {
  if (kind != AssociationKind::kNearest && kind != AssociationKind::kInterpolated) {
    return {StatusCode::kInvalidArgument, "association: no such kind"};
  }
  if (tolerance_ns < 0 || max_gap_ns < 0) {
    return {StatusCode::kInvalidArgument,
            "association: tolerance_ns and max_gap_ns must not be negative"};
  }
  return {};
}

Status MatchedTrajectories::Validate() const {
  if (estimate.size() != reference.size()) {
    return {StatusCode::kInvalidArgument, "matched trajectories differ in number of poses"};
  }
  for (std::size_t k = 0; k < estimate.size(); ++k) {
    if (estimate[k].stamp_ns != reference[k].stamp_ns) {
      return {StatusCode::kInvalidArgument,
              std::string("matched trajectories differ in the stamp of pose ")
                  .append(std::to_string(k))};
    }
  }
  if (Status s = ValidateTrajectory(estimate, "estimate"); !s.ok()) return s;
  return ValidateTrajectory(reference, "reference");
}

Result<MatchedTrajectories> Associate(Poses estimate, Poses reference,
                                      const AssociationOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  if (Status s = ValidateTrajectory(estimate, "estimate"); !s.ok()) return s;
  if (Status s = ValidateTrajectory(reference, "reference"); !s.ok()) return s;
  if (estimate.empty() || reference.empty()) return NothingMatches(estimate, reference);
  return glissade::internal::OrOutOfMemory([&]() -> Result<MatchedTrajectories> {
    Trajectory shifted(estimate.begin(), estimate.end());
    for (StampedPose& x : shifted) {
      if (!Shifted(x.stamp_ns, options.offset_ns, &x.stamp_ns)) {
        return Status(StatusCode::kInvalidArgument,
                      "association: a stamp with offset_ns leaves the range of int64");
      }
    }
    Matcher matcher(reference, options);
    for (std::size_t k = 0; k < estimate.size(); ++k) {
      if (options.kind == AssociationKind::kNearest) {
        matcher.AddNearest(estimate[k], k, shifted);
      } else {
        matcher.AddInterpolated(estimate[k], shifted[k].stamp_ns);
      }
    }
    if (matcher.matched.estimate.empty()) return NothingMatches(shifted, reference);
    return std::move(matcher.matched);
  });
}

}  // namespace glissade::eval
