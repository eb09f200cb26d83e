// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/flight.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "glissade/lie/so3.h"

namespace glissade::app {

namespace {

constexpr double kDenseS = 0.02;  // cubics between poses are as good as they are

/// Seconds from a to b, which may be earlier.
double Since(std::int64_t a, std::int64_t b) {
  return b >= a ? SecondsBetween(a, b) : -SecondsBetween(b, a);
}

Quaternion Turned(const Quaternion& q, const Vector3& phi) {
  return Quaternion(q * so3::ExpQuaternion(phi)).normalized();
}

/// The cubic that is (0, v0) at 0 and (x1, v1) at T, and its derivative.
void Cubic(const Vector3& v0, const Vector3& x1, const Vector3& v1, double T, double t, Vector3* x,
           Vector3* v) {
  const Vector3 c2 = (3.0 * x1 / T - 2.0 * v0 - v1) / T;
  const Vector3 c3 = (v0 + v1 - 2.0 * x1 / T) / (T * T);
  *x = ((c3 * t + c2) * t + v0) * t;
  *v = (3.0 * c3 * t + 2.0 * c2) * t + v0;
}

Vector3 TurnBetween(const Pose& a, const Pose& b) {
  return so3::Log(Quaternion(a.q().conjugate() * b.q()));
}

}  // namespace

Flight::Flight(std::vector<GroundTruthState> truth, std::vector<ImuSample> imu,
               const Vector3& gravity)
    : truth_(std::move(truth)), imu_(std::move(imu)), gravity_(gravity), interval_(truth_.size()) {
  const std::size_t last = truth_.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    if (truth_[k].speed_bias) {
      velocities_.emplace_back(truth_[k].speed_bias->v());
      continue;
    }
    const GroundTruthState &a = truth_[k == 0 ? 0 : k - 1], &b = truth_[std::min(k + 1, last)];
    velocities_.emplace_back((b.T_w_b.p() - a.T_w_b.p()) / Since(a.stamp_ns, b.stamp_ns));
  }
}

std::size_t Flight::IntervalOf(std::int64_t stamp_ns) const {
  const auto after =
      std::upper_bound(truth_.begin(), truth_.end(), stamp_ns,
                       [](std::int64_t t, const GroundTruthState& s) { return t < s.stamp_ns; });
  const auto k = static_cast<std::size_t>(after - truth_.begin());
  return std::clamp<std::size_t>(k, 1, truth_.size() - 1) - 1;
}

double Flight::GapAt(std::int64_t stamp_ns) const {
  const std::size_t k = IntervalOf(stamp_ns);
  return Since(truth_[k].stamp_ns, truth_[k + 1].stamp_ns);
}

void Flight::MakeKnots(std::size_t interval) {
  interval_ = interval;
  knots_.clear();
  const GroundTruthState &begin = truth_[interval], &end = truth_[interval + 1];
  seconds_ = Since(begin.stamp_ns, end.stamp_ns);
  if (seconds_ <= kDenseS) return;
  const auto earlier = [](const ImuSample& s, std::int64_t t) { return s.stamp_ns < t; };
  // The first reading at or after each end.
  auto first = std::lower_bound(imu_.begin(), imu_.end(), begin.stamp_ns, earlier);
  const auto last = std::lower_bound(first, imu_.end(), end.stamp_ns, earlier);
  if (last == imu_.end() || (first == imu_.begin() && first->stamp_ns > begin.stamp_ns)) return;
  if (first->stamp_ns > begin.stamp_ns) --first;
  for (auto it = first; it != last; ++it)
    if (NanosecondsBetween(it->stamp_ns, (it + 1)->stamp_ns) > kMaxImuGapNs) return;

  const auto reading_at = [&](std::vector<ImuSample>::const_iterator it, std::int64_t stamp_ns) {
    return it->stamp_ns == stamp_ns ? *it : Interpolate(*it, *(it + 1), stamp_ns);
  };
  const auto add = [&](const ImuSample& reading) {
    Knot& knot = knots_.emplace_back();
    knot.reading = reading;
    knot.q = begin.T_w_b.q();
    if (knots_.size() > 1) {
      const Knot& before = knots_[knots_.size() - 2];
      const double dt = Since(before.reading.stamp_ns, reading.stamp_ns);
      knot.q = Turned(before.q, 0.5 * dt * (before.reading.gyro + reading.gyro));
    }
  };
  add(reading_at(first, begin.stamp_ns));
  for (auto it = first + 1; it < last; ++it)
    if (it->stamp_ns > begin.stamp_ns) add(*it);
  add(last->stamp_ns == end.stamp_ns ? *last : reading_at(last - 1, end.stamp_ns));

  turn_missed_ = so3::Log(Quaternion(knots_.back().q.conjugate() * end.T_w_b.q()));
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    Knot& knot = knots_[k];
    const double t = Since(begin.stamp_ns, knot.reading.stamp_ns);
    knot.q = Turned(knot.q, turn_missed_ * (t / seconds_));
    knot.acceleration = knot.q * knot.reading.accel + gravity_;
    if (k == 0) {
      knot.p = begin.T_w_b.p();
      knot.v = velocities_[interval];
      continue;
    }
    // Accelerations are linear from one reading to the next.
    const Knot& before = knots_[k - 1];
    const double dt = Since(before.reading.stamp_ns, knot.reading.stamp_ns);
    knot.v = before.v + 0.5 * dt * (before.acceleration + knot.acceleration);
    knot.p =
        before.p + dt * before.v + dt * dt / 6.0 * (2.0 * before.acceleration + knot.acceleration);
  }
  p_missed_ = end.T_w_b.p() - knots_.back().p;
  v_missed_ = velocities_[interval + 1] - knots_.back().v;
}

void Flight::AlongKnots(std::int64_t stamp_ns, Pose* pose, Vector3* velocity) const {
  const auto after =
      std::upper_bound(knots_.begin(), knots_.end(), stamp_ns,
                       [](std::int64_t t, const Knot& knot) { return t < knot.reading.stamp_ns; });
  const auto count = static_cast<std::ptrdiff_t>(knots_.size());
  const auto k = std::clamp<std::ptrdiff_t>(after - knots_.begin(), 1, count - 1);
  const Knot &a = knots_[static_cast<std::size_t>(k - 1)], &b = knots_[static_cast<std::size_t>(k)];
  const double dt = Since(a.reading.stamp_ns, b.reading.stamp_ns);
  const double s = Since(a.reading.stamp_ns, stamp_ns), part = s / dt;
  const Vector3 rate = a.reading.gyro + 0.5 * part * (b.reading.gyro - a.reading.gyro);
  const Quaternion q = Turned(a.q, s * rate + turn_missed_ * (s / seconds_));
  const Vector3 change = part * (b.acceleration - a.acceleration);
  Vector3 p = a.p + s * a.v + s * s * (0.5 * a.acceleration + change / 6.0);
  Vector3 v = a.v + s * (a.acceleration + 0.5 * change);
  Vector3 p_more, v_more;
  Cubic(Vector3::Zero(), p_missed_, v_missed_, seconds_,
        Since(truth_[interval_].stamp_ns, stamp_ns), &p_more, &v_more);
  *pose = Pose(q, p + p_more);
  *velocity = v + v_more;
}

/// Rotation rate in the body's axes, from the poses beside it.
Vector3 Flight::RateAt(std::size_t k) const {
  const GroundTruthState& a = truth_[k == 0 ? 0 : k - 1];
  const GroundTruthState& b = truth_[std::min(k + 1, truth_.size() - 1)];
  return TurnBetween(a.T_w_b, b.T_w_b) / Since(a.stamp_ns, b.stamp_ns);
}

void Flight::AlongCubic(std::size_t interval, double t, Pose* pose, Vector3* velocity) const {
  const GroundTruthState &a = truth_[interval], &b = truth_[interval + 1];
  const double T = Since(a.stamp_ns, b.stamp_ns);
  Vector3 phi, p, unused;
  Cubic(RateAt(interval), TurnBetween(a.T_w_b, b.T_w_b), RateAt(interval + 1), T, t, &phi, &unused);
  Cubic(velocities_[interval], b.T_w_b.p() - a.T_w_b.p(), velocities_[interval + 1], T, t, &p,
        velocity);
  *pose = Pose(Turned(Quaternion(a.T_w_b.q()), phi), a.T_w_b.p() + p);
}

GroundTruthState Flight::At(std::int64_t stamp_ns) {
  const std::size_t k = IntervalOf(stamp_ns);
  if (k != interval_) MakeKnots(k);
  const double t = Since(truth_[k].stamp_ns, stamp_ns);
  GroundTruthState state;
  state.stamp_ns = stamp_ns;
  Vector3 velocity;
  if (knots_.empty()) {
    AlongCubic(k, t, &state.T_w_b, &velocity);
  } else {
    AlongKnots(stamp_ns, &state.T_w_b, &velocity);
  }
  const auto &a = truth_[k].speed_bias, &b = truth_[k + 1].speed_bias;
  if (a && b) {
    const double part = std::clamp(t / seconds_, 0.0, 1.0);
    const Vector3 ba = a->ba() + part * (b->ba() - a->ba());
    const Vector3 bg = a->bg() + part * (b->bg() - a->bg());
    state.speed_bias = VertexSpeedBias(velocity, ba, bg);
  }
  return state;
}

}  // namespace glissade::app
