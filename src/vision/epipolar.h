// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "glissade/base/matrix.h"

/// \file
/// Epipolar geometry of two views, a the earlier and b the later, of points (x/z, y/z, 1).
namespace glissade::vision::internal {

struct Match {
  double a[2], b[2];  ///< (x/z, y/z)
};

/// R_a_b and the direction t_a of b's centre seen from a.
struct TwoViews {
  Matrix3 R_a_b = Matrix3::Identity();
  Vector3 t_a = Vector3::Zero();
};

/// Sampson's distance of a match from its epipolar lines, in normalized coordinates: first order in
/// the distance from the nearest pair of points that fits (Hartley and Zisserman, 2nd ed., 11.4.3).
double EpipolarDistance(const TwoViews& views, const Match& match);

/// Which matches fit a turn (views->R_a_b) and some direction of the way, which are then in *views.
/// Two matches make a hypothesis where the turn is known: t is normal to both f_a x R f_b. The turn
/// of an IMU whose bias nobody has estimated yet is wrong by some mrad; so the best hypothesis is
/// refined, with the turn (prior: sigma max_turn_error, rad) and by all matches within three times
/// the tolerance. tolerance in normalized coordinates. Without a way, where all points seem to
/// stay, any direction fits and what is no turn does not. Deterministic. Returns how many fit.
int FitMatches(const std::vector<Match>& matches, double max_turn_error, double tolerance,
               TwoViews* views, std::vector<unsigned char>* fits);

/// The same where the turn is not known: five points a hypothesis (Nister's, by OpenCV).
int FitMatchesBlind(const std::vector<Match>& matches, double tolerance,
                    std::vector<unsigned char>* fits);

}  // namespace glissade::vision::internal
