// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "glissade/base/matrix.h"
#include "glissade/base/small_matrix.h"
#include "glissade/base/validate.h"

namespace glissade {

/// An image point whose time is not exactly known. The time offset td (s) of a camera is defined by
/// t_body = t_camera + td. The state of a frame belongs to body time t_camera + td_0, td_0 being
/// what was believed when the frame was made; if td turns out different, the image was exposed td -
/// td_0 later, and at the time of the state the point was at uv - (td - td_0) velocity (T. Qin, S.
/// Shen, "Online Temporal Calibration for Monocular Visual-Inertial Systems", IROS 2018).
struct TimedObservation {
  Vector2 uv = Vector2::Zero();
  Vector2 velocity = Vector2::Zero();  ///< image coordinates per second
  double td_0 = 0.0;                   ///< s

  [[nodiscard]] Vector2 At(double td) const { return uv - (td - td_0) * velocity; }

  [[nodiscard]] Status Validate(std::string_view what) const {
    if (Status s = ValidateFinite(uv.data(), 2, what); !s.ok()) return s;
    if (Status s = ValidateFinite(velocity.data(), 2, what); !s.ok()) return s;
    return ValidateFinite(&td_0, 1, what);
  }
};

namespace internal {
static_assert(sizeof(TimedObservation) == 5 * sizeof(double));
/// A TimedObservation as the five numbers it is made of.
template <class T>
Vec<T, 2> ObservedVelocity(const Vec<T, 5>& observed) {
  return {{observed[2], observed[3]}};
}
template <class T>
Vec<T, 2> ObservedAt(const Vec<T, 5>& observed, const T& td) {
  return Vec<T, 2>{{observed[0], observed[1]}} - (td - observed[4]) * ObservedVelocity(observed);
}
}  // namespace internal

}  // namespace glissade
