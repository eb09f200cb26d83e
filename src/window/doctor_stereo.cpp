// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Tracks that two cameras see in one frame, against the cameras' given places on the body.
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/lie/so3.h"
#include "window/doctor.h"
#include "window/doctor_two_view.h"

namespace glissade::internal {

namespace {

/// Evenly over the recording, not more than some thousands.
std::vector<TwoViewMatch> MatchesOf(const DoctorCase& c, std::size_t left, std::size_t right) {
  std::vector<TwoViewMatch> matches;
  const std::size_t stride = std::max<std::size_t>(c.frames.size() / 200, 1);
  for (std::size_t k = 0; k < c.frames.size(); k += stride) {
    const auto& a = c.frames[k].features[left];
    const auto& b = c.frames[k].features[right];
    auto j = b.begin();
    for (const DoctorFeature& i : a) {
      while (j != b.end() && j->track < i.track)
        ++j;
      if (j != b.end() && j->track == i.track) matches.push_back({i.x, i.y, j->x, j->y});
    }
  }
  return matches;
}

/// Share of the matches with parallax that lie behind the cameras.
double ShareBehind(const std::vector<TwoViewMatch>& matches, const Matrix3& R, const Vector3& t,
                   double sigma) {
  std::int64_t behind = 0, all = 0;
  for (const TwoViewMatch& m : matches) {
    const Vector3 y = R * Vector3(m.x1, m.y1, 1.0), f(m.x2, m.y2, 1.0);
    // depth2 f = depth1 y + t: both crossed with f.
    const Vector3 n = f.cross(y);
    if (!(n.norm() > 5.0 * sigma * f.norm() * y.norm())) continue;
    ++all;
    if (-n.dot(f.cross(t)) < 0.0) ++behind;
  }
  return all >= 20 ? static_cast<double>(behind) / static_cast<double>(all) : 0.0;
}

void CheckPair(std::size_t left, std::size_t right, DoctorCase* c) {
  const std::vector<TwoViewMatch> matches = MatchesOf(*c, left, right);
  const WindowCamera &a = c->input.cameras[left], &b = c->input.cameras[right];
  const Pose T_right_left = b.T_b_c.Inverse() * a.T_b_c;
  const double baseline = Vector3(T_right_left.p()).norm();
  const std::string sensor = Text("cameras %zu, %zu", left, right);
  if (matches.size() < 100) return;
  if (!(baseline > 1e-6 && baseline < 1e6)) {
    c->Add(DoctorKind::kStereoExtrinsic, DoctorSeverity::kError, sensor,
           Text("share %zu tracks, but are %.3g m apart", matches.size(), baseline),
           "give the baseline in T_b_c, in metres");
    return;
  }
  const Vector3 t = T_right_left.p() / baseline;
  const Matrix3 R = T_right_left.R();
  const double sigma_x = 0.5 * (a.sigma_px / a.fx + b.sigma_px / b.fx);
  const double sigma_y = 0.5 * (a.sigma_px / a.fy + b.sigma_px / b.fy);
  const double behind = ShareBehind(matches, R, t, sigma_x);
  if (behind > 0.5) {
    DoctorFinding& f =
        c->Add(DoctorKind::kStereoSwapped, DoctorSeverity::kError, sensor,
               Text("%.0f %% of the points that both see lie behind them", 100.0 * behind),
               "left and right exchanged, or the baseline has the wrong sign in T_b_c");
    f.estimate = behind;
  }
  std::vector<double> errors;
  for (const TwoViewMatch& m : matches)
    errors.push_back(std::abs(EpipolarError(R, t, m, sigma_x, sigma_y)));
  const double given = RobustSigma(std::move(errors));
  const TwoViewMotion fit = RefineTwoView(matches, sigma_x, sigma_y, R, t);
  if (!fit.ok) {
    c->Add(DoctorKind::kStereoExtrinsic, DoctorSeverity::kError, sensor,
           Text("no relative rotation fits two fifths of the %zu tracks that both see",
                matches.size()),
           "track numbers differ between the cameras, or T_b_c is far off");
    return;
  }
  const Vector3 d = so3::Log(Matrix3(fit.R * R.transpose()));
  const double sigmas = std::sqrt(std::max(d.dot(fit.covariance.inverse() * d), 0.0));
  if (given > 1.3 * std::max(fit.noise, 0.2) && sigmas > 5.0) {
    const Vector3 deg = d / kDegree;
    const double sigma_deg = std::sqrt(fit.covariance.trace()) / kDegree;
    DoctorFinding& f = c->Add(
        DoctorKind::kStereoExtrinsic,
        given < 1.2                              ? DoctorSeverity::kInfo  // less than was expected
        : given > 2.0 * std::max(fit.noise, 0.5) ? DoctorSeverity::kError
                                                 : DoctorSeverity::kWarning,
        sensor,
        Text("epipolar errors of %.3g sigmas, %.3g with camera %zu rotated by (%.3f, %.3f, %.3f) "
             "deg in its own axes",
             given, fit.noise, right, deg[0], deg[1], deg[2]),
        "calibrate the pair anew, or rectify again");
    f.estimate = deg.norm();
    f.sigma = sigma_deg;
    f.sigmas = sigmas;
    f.unit = "deg";
  }
  const auto n = static_cast<double>(matches.size());
  const double share = fit.outliers / n;
  if (!(share > 0.05)) return;
  DoctorFinding& f = c->Add(
      DoctorKind::kStereoOutliers, share > 0.3 ? DoctorSeverity::kError : DoctorSeverity::kWarning,
      sensor,
      Text("%.3g %% of the tracks that both see are off their epipolar lines", 100.0 * share),
      "match left to right and back, gate by row; use a robust loss");
  f.count = fit.outliers;
  f.estimate = share;
  f.sigma = std::sqrt(share * (1.0 - share) / n);
  f.sigmas = (share - 0.05) / *f.sigma;
}

}  // namespace

void CheckStereo(DoctorCase* c) {
  for (std::size_t right = 1; right < c->camera_ok.size(); ++right) {
    if (c->camera_ok[0] && c->camera_ok[right]) CheckPair(0, right, c);
  }
}

}  // namespace glissade::internal
