// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/imu/sample.h"
#include "glissade/io/euroc.h"

namespace glissade::app {

/// Where a body was at any time between the poses of a ground truth, which may be sparse.
///
/// Where true poses are more than 20 ms apart and the IMU has readings all the way from one to the
/// next, they say how the body got there: rates and accelerations are integrated from the first
/// pose, and what they miss the second one by is spread over the interval, in rotation evenly and
/// in position by the cubic that ends with the right position and velocity. Constant biases
/// disappear in that. Else position and rotation vector are cubics with the velocities of the
/// truth, or where it has none, with those between the neighbours of a pose.
class Flight {
 public:
  /// At least two states; stamps of both increase. gravity in W, m/s^2.
  Flight(std::vector<GroundTruthState> truth, std::vector<ImuSample> imu, const Vector3& gravity);

  [[nodiscard]] std::int64_t begin_ns() const { return truth_.front().stamp_ns; }
  [[nodiscard]] std::int64_t end_ns() const { return truth_.back().stamp_ns; }
  /// Pose, and where the truth has them, velocity and biases (linearly). Before the beginning and
  /// after the end, where half an exposure may reach, the motion goes on.
  GroundTruthState At(std::int64_t stamp_ns);
  /// Seconds between the two true poses around a stamp.
  [[nodiscard]] double GapAt(std::int64_t stamp_ns) const;

 private:
  /// What the IMU says at its readings, since the first pose of an interval.
  struct Knot {
    ImuSample reading;
    Quaternion q;                ///< R_W_B, with its part of the correction
    Vector3 p, v, acceleration;  ///< W; p and v without it
  };
  [[nodiscard]] std::size_t IntervalOf(std::int64_t stamp_ns) const;
  void MakeKnots(std::size_t interval);
  void AlongKnots(std::int64_t stamp_ns, Pose* pose, Vector3* velocity) const;
  void AlongCubic(std::size_t interval, double t, Pose* pose, Vector3* velocity) const;
  [[nodiscard]] Vector3 RateAt(std::size_t k) const;

  std::vector<GroundTruthState> truth_;
  std::vector<Vector3> velocities_;  // W, of each state
  std::vector<ImuSample> imu_;
  Vector3 gravity_;
  // Of the interval that was asked for last.
  std::size_t interval_;
  std::vector<Knot> knots_;  // none: the IMU says nothing
  double seconds_ = 0.0;     // its length
  Vector3 turn_missed_, p_missed_, v_missed_;
};

}  // namespace glissade::app
