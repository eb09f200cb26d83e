// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/gauge.h"

namespace glissade {

std::string_view GaugeDirectionName(GaugeGroup group, int direction) {
  static constexpr std::string_view kInertial[] = {"yaw", "x", "y", "z"};
  static constexpr std::string_view kVision[] = {"rotation x", "rotation y", "rotation z", "x",
                                                 "y",          "z",          "scale"};
  if (direction < 0 || direction >= Dimension(group)) return "";
  return group == GaugeGroup::kVisualInertial ? kInertial[direction] : kVision[direction];
}

Gauge::Gauge(const Fixed& g)
    : kind(Kind::kFixed),
      group(g.group),
      anchor(g.anchor),
      second(g.second),
      reference(g.reference) {}

Gauge::Gauge(const FixedPoses& g) : kind(Kind::kFixedPoses), anchor(g.anchor), second(g.second) {}

Gauge::Gauge(const Prior& g)
    : kind(Kind::kPrior),
      group(g.group),
      anchor(g.anchor),
      second(g.second),
      weight(g.weight),
      reference(g.reference) {}

}  // namespace glissade
