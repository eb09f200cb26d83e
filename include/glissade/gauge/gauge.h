// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "glissade/vertices/pose.h"

namespace glissade {

/// What measurements leave open: the motions of the whole scene that no residual sees.
enum class GaugeGroup : std::uint8_t {
  kAuto,            ///< what the graph's vertices and edges tell, see DetectGaugeGroup()
  kVisualInertial,  ///< yaw about world z and translation: 4
  kStereo,          ///< rotation and translation: 6
  kMono,            ///< rotation, translation, scale: 7
};

constexpr int Dimension(GaugeGroup group) {
  return group == GaugeGroup::kVisualInertial ? 4
         : group == GaugeGroup::kStereo       ? 6
         : group == GaugeGroup::kMono         ? 7
                                              : 0;
}
/// "yaw", "x", "y", "z"; without IMU "rotation x", ..., "x", "y", "z", "scale".
std::string_view GaugeDirectionName(GaugeGroup group, int direction);

/// How a solve (SolveOptions::gauge) or a covariance treats the directions that nothing observes.
///
///     problem.Solve({.gauge = Gauge::Fixed{first}});
///     problem.Solve({.gauge = Gauge::Prior{first, 1e5}});
///
/// Free: nothing is added; damping keeps a solve finite, and it ends somewhere on the orbit.
///
/// Fixed: the columns of the anchor's gauge coordinates are removed. With IMU these are its
/// position and its yaw in the chart R = Exp(dphi) R0, dphi_z held (Zhang, Gallego, Scaramuzza, "On
/// the Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial State
/// Estimation", RA-L 2018, Eqs. 9-10). Without: the whole pose, and for a single camera one
/// coordinate of the second camera's centre in the anchor's frame, the largest of the baseline.
/// Everything is held where it is: the reference only defines what yaw means.
///
/// FixedPoses: both poses whole. For a single camera without IMU this is what much code does; it
/// removes five degrees of freedom that are observed.
///
/// Prior: adds the residual sqrt(weight) (p - p0, dphi_z), Eq. (11), in metres and radians under
/// one weight; without IMU (p - p0, dphi, and the coordinate of the second camera).
struct Gauge {
  enum class Kind : std::uint8_t { kFree, kFixed, kFixedPoses, kPrior };
  struct FreeTag {};
  static constexpr FreeTag Free{};

  struct Fixed {
    VertexHandle<VertexPose> anchor;
    /// p0, R0. Without: the anchor's pose when the graph first met it as an anchor, kept through
    /// all solves; Set() of the anchor or MoveToGauge() renew it.
    std::optional<Pose> reference = {};
    /// Whose camera holds the scale (kMono); null: the first other free pose of the graph.
    VertexHandle<VertexPose> second = {};
    GaugeGroup group = GaugeGroup::kAuto;
  };
  struct FixedPoses {
    VertexHandle<VertexPose> anchor;
    VertexHandle<VertexPose> second;
  };
  struct Prior {
    VertexHandle<VertexPose> anchor;
    double weight = 1e5;  ///< 1/m^2 and 1/rad^2
    std::optional<Pose> reference = {};
    VertexHandle<VertexPose> second = {};
    GaugeGroup group = GaugeGroup::kAuto;
  };

  Kind kind = Kind::kFree;
  GaugeGroup group = GaugeGroup::kAuto;
  VertexHandle<VertexPose> anchor, second;
  double weight = 0.0;
  std::optional<Pose> reference;

  Gauge() = default;
  Gauge(FreeTag) {}            // NOLINT: implicit, all of these: they are gauges
  Gauge(const Fixed& g);       // NOLINT
  Gauge(const FixedPoses& g);  // NOLINT
  Gauge(const Prior& g);       // NOLINT
};

}  // namespace glissade
