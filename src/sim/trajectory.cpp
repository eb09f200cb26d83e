// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace glissade::sim {

namespace {

constexpr double kPi = std::numbers::pi;

/// Once around a rectangle of unit perimeter, sides 0.3 and 0.2; s may lie outside [0, 1).
Vector3 OnRectangle(double s) {
  s -= std::floor(s);
  if (s < 0.3) return {s, 0.0, 0.0};
  if (s < 0.5) return {0.3, s - 0.3, 0.0};
  if (s < 0.8) return {0.8 - s, 0.2, 0.0};
  return {0.0, 1.0 - s, 0.0};
}

/// At s in [0, 1] of the way; lengths are for a path of one metre.
Vector3 PositionOn(TrajectoryKind kind, double s) {
  switch (kind) {
    case TrajectoryKind::kSine:
      return {0.84 * s, 0.08 * std::sin(3.0 * kPi * s), 0.03 * std::sin(2.0 * kPi * s + 1.0)};
    case TrajectoryKind::kArc: {
      const double phi = 2.0 / 3.0 * kPi * s, radius = 1.5 / kPi;
      return {radius * std::cos(phi), radius * std::sin(phi), 0.04 * std::sin(2.0 * kPi * s)};
    }
    case TrajectoryKind::kRec:
      return OnRectangle(s + 0.05) + Vector3(0.0, 0.0, 0.02 * std::sin(4.0 * kPi * s));
  }
  return Vector3::Zero();
}

Vector3 AnglesOn(TrajectoryKind kind, double s) {
  const double ahead = kind == TrajectoryKind::kArc ? 2.0 / 3.0 * kPi * s : 0.5 * kPi;
  return {ahead + 0.15 * std::sin(2.0 * kPi * s), 0.10 * std::sin(4.0 * kPi * s + 0.5),
          0.12 * std::cos(3.0 * kPi * s)};
}

}  // namespace

std::string_view ToString(TrajectoryKind kind) {
  switch (kind) {
    case TrajectoryKind::kSine:
      return "sine";
    case TrajectoryKind::kArc:
      return "arc";
    case TrajectoryKind::kRec:
      return "rec";
  }
  return "trajectory";
}

Trajectory::Trajectory(TrajectoryKind kind, double length, double speed, int laps) {
  const double lap = length / speed, duration = laps * lap;
  constexpr double kInterval = 0.125;
  const int segments = std::max(1, static_cast<int>(std::ceil(duration / kInterval - 1e-9)));
  const double interval = duration / segments;
  std::vector<Vector3> position, angles;
  for (int k = 0; k < segments + BSpline::kDegree; ++k) {
    const double s = (k - 2) * interval / lap;
    position.push_back(length * PositionOn(kind, s) + Vector3(0.0, 0.0, 1.5));
    angles.push_back(AnglesOn(kind, s));
  }
  position_ = BSpline(std::move(position), interval);
  angles_ = BSpline(std::move(angles), interval);
}

}  // namespace glissade::sim
