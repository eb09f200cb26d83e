// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/relative_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "eval/elapsed.h"
#include "glissade/base/out_of_memory.h"
#include "glissade/lie/so3.h"

namespace glissade::eval {

namespace {

Status Refused(const std::string& what) {
  return {StatusCode::kInvalidArgument, std::string("relative errors: ").append(what)};
}

Status Overflow() {
  return {StatusCode::kNotFinite, "relative errors: the squares overflow"};
}

PairError ErrorOf(const MatchedTrajectories& matched, std::size_t i, std::size_t j) {
  const Pose reference = matched.reference[i].T_w_b.Inverse() * matched.reference[j].T_w_b;
  const Pose estimate = matched.estimate[i].T_w_b.Inverse() * matched.estimate[j].T_w_b;
  const Pose E = reference.Inverse() * estimate;
  PairError error;
  error.first = i;
  error.last = j;
  error.translation_m = E.p().norm();
  error.rotation_deg = 180.0 / std::numbers::pi * so3::Log(Quaternion(E.q())).norm();
  return error;
}

/// The pose after i that is nearest to `interval` later, if it is within the tolerance; else i.
std::size_t PartnerInTime(const Trajectory& poses, std::size_t i, std::uint64_t interval,
                          std::uint64_t tolerance) {
  const auto elapsed = [&](std::size_t j) {
    return internal::Elapsed(poses[i].stamp_ns, poses[j].stamp_ns);
  };
  const auto at = std::partition_point(
      poses.begin() + static_cast<std::ptrdiff_t>(i) + 1, poses.end(), [&](const StampedPose& x) {
        return internal::Elapsed(poses[i].stamp_ns, x.stamp_ns) < interval;
      });
  if (at == poses.end()) return i;
  std::size_t best = static_cast<std::size_t>(at - poses.begin());
  std::uint64_t off = elapsed(best) - interval;
  if (best > i + 1 && interval - elapsed(best - 1) <= off) {
    --best;
    off = interval - elapsed(best);
  }
  return off <= tolerance ? best : i;
}

std::vector<double> TranslationsOf(const std::vector<PairError>& pairs, double factor) {
  std::vector<double> values;
  for (const PairError& pair : pairs)
    values.push_back(factor * pair.translation_m);
  return values;
}

std::vector<double> RotationsOf(const std::vector<PairError>& pairs, double factor) {
  std::vector<double> values;
  for (const PairError& pair : pairs)
    values.push_back(factor * pair.rotation_deg);
  return values;
}

std::string Decimal(double x) {
  std::string text = std::to_string(x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

Result<TimeRpe> ComputeOverTime(const MatchedTrajectories& matched, const TimeRpeOptions& o) {
  const auto interval = static_cast<std::uint64_t>(o.interval_ns);
  const std::uint64_t tolerance =
      o.tolerance_ns < 0 ? interval / 10 : static_cast<std::uint64_t>(o.tolerance_ns);
  TimeRpe rpe;
  for (std::size_t i = 0; i < matched.estimate.size(); i += static_cast<std::size_t>(o.every)) {
    const std::size_t j = PartnerInTime(matched.estimate, i, interval, tolerance);
    if (j != i) rpe.pairs.push_back(ErrorOf(matched, i, j));
  }
  if (rpe.pairs.empty()) {
    return Refused(std::string("no two poses are ")
                       .append(Decimal(1e-9 * static_cast<double>(interval)))
                       .append(" s apart, within ")
                       .append(Decimal(1e-9 * static_cast<double>(tolerance)))
                       .append(" s"));
  }
  rpe.translation_m = StatisticsOf(TranslationsOf(rpe.pairs, 1.0));
  rpe.rotation_deg = StatisticsOf(RotationsOf(rpe.pairs, 1.0));
  if (!std::isfinite(rpe.translation_m.rmse)) return Overflow();
  return rpe;
}

Result<DistanceRpe> ComputeOverDistance(const MatchedTrajectories& matched,
                                        const DistanceRpeOptions& o) {
  const std::size_t n = matched.reference.size();
  std::vector<double> way(n, 0.0);
  for (std::size_t k = 1; k < n; ++k) {
    const Vector3 step = matched.reference[k].T_w_b.p() - matched.reference[k - 1].T_w_b.p();
    way[k] = way[k - 1] + step.norm();
  }
  if (n > 0 && !std::isfinite(way.back())) return Overflow();
  DistanceRpe rpe;
  std::vector<double> all_translations, all_rotations;
  for (const double length : o.lengths_m) {
    SegmentErrors& segments = rpe.by_length.emplace_back();
    segments.length_m = length;
    for (std::size_t i = 0; i < n; i += static_cast<std::size_t>(o.every)) {
      const auto end =
          std::lower_bound(way.begin() + static_cast<std::ptrdiff_t>(i), way.end(), length,
                           [&](double x, double wanted) { return x - way[i] < wanted; });
      if (end == way.end()) break;  // nor is there one from any later start
      segments.pairs.push_back(ErrorOf(matched, i, static_cast<std::size_t>(end - way.begin())));
    }
    const std::vector<double> translations = TranslationsOf(segments.pairs, 100.0 / length);
    const std::vector<double> rotations = RotationsOf(segments.pairs, 1.0 / length);
    segments.translation_percent = StatisticsOf(translations);
    segments.rotation_deg_per_m = StatisticsOf(rotations);
    all_translations.insert(all_translations.end(), translations.begin(), translations.end());
    all_rotations.insert(all_rotations.end(), rotations.begin(), rotations.end());
  }
  if (all_translations.empty()) {
    return Refused(std::string("the reference goes ")
                       .append(Decimal(n > 0 ? way.back() : 0.0))
                       .append(" m, less than the shortest segment of ")
                       .append(Decimal(o.lengths_m[0]))
                       .append(" m"));
  }
  rpe.translation_percent = StatisticsOf(all_translations);
  rpe.rotation_deg_per_m = StatisticsOf(all_rotations);
  if (!std::isfinite(rpe.translation_percent.rmse) || !std::isfinite(rpe.rotation_deg_per_m.rmse)) {
    return Overflow();
  }
  return rpe;
}

}  // namespace

Status TimeRpeOptions::Validate() const {
  if (interval_ns <= 0) return Refused("interval_ns must be > 0");
  if (every < 1) return Refused("every must be >= 1");
  return {};
}

Status DistanceRpeOptions::Validate() const {
  if (every < 1) return Refused("every must be >= 1");
  if (lengths_m.empty()) return Refused("lengths_m has no length");
  for (std::size_t k = 0; k < lengths_m.size(); ++k) {
    const double least = k == 0 ? 0.0 : lengths_m[k - 1];
    if (!(lengths_m[k] > least && std::isfinite(lengths_m[k]))) {
      return Refused("lengths_m must be > 0, finite and increasing");
    }
  }
  return {};
}

Result<TimeRpe> RpeOverTime(const MatchedTrajectories& matched, const TimeRpeOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  if (Status s = matched.Validate(); !s.ok()) return s;
  return glissade::internal::OrOutOfMemory([&] { return ComputeOverTime(matched, options); });
}

Result<DistanceRpe> RpeOverDistance(const MatchedTrajectories& matched,
                                    const DistanceRpeOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  if (Status s = matched.Validate(); !s.ok()) return s;
  return glissade::internal::OrOutOfMemory([&] { return ComputeOverDistance(matched, options); });
}

}  // namespace glissade::eval
