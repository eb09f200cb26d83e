// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/doctor_gyro_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/lie/so3.h"
#include "window/doctor_gyro_correlation.h"
#include "window/doctor_gyro_integral.h"

namespace glissade::internal {

namespace {

/// Pairs of the camera between which the IMU has no gap, at any offset that is searched.
std::vector<DoctorPair> PairsWithImu(const DoctorCase& c, int camera) {
  const double margin = c.options.max_time_offset_s;
  std::vector<DoctorPair> pairs;
  std::vector<double> gaps;  // where they begin and end
  for (std::size_t k = 1; k < c.imu.size(); ++k) {
    if (c.imu[k].t - c.imu[k - 1].t > c.imu_max_gap) {
      gaps.push_back(c.imu[k - 1].t);
      gaps.push_back(c.imu[k].t);
    }
  }
  for (const DoctorPair& p : c.pairs) {
    if (p.camera != camera) continue;
    // Begins and ends between the same two numbers, and not within a gap.
    const auto from = std::upper_bound(gaps.begin(), gaps.end(), p.t0 - margin) - gaps.begin();
    const auto to = std::upper_bound(gaps.begin(), gaps.end(), p.t1 + margin) - gaps.begin();
    if (from != to || from % 2 != 0) continue;
    pairs.push_back(p);
  }
  return pairs;
}

/// The rotation R that maximizes trace(R' M), M a little bent towards a rotation that is taken
/// where M leaves it open.
Matrix3 BestRotation(const Matrix3& M, const Matrix3& given) {
  const Eigen::Matrix3d bent = M + 0.02 * given;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(bent, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  Eigen::Vector3d d(1.0, 1.0, (U * V.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  return U * d.asDiagonal() * V.transpose();
}

using Vector8 = Vector<8>;
using Matrix8 = SquareMatrix<8>;

/// One pair's part of the least squares problem.
struct Term {
  Matrix<3, 8> J;    ///< of the predicted rotation vector
  Vector3 gradient;  ///< of half of `squared` by it
  Matrix3 information;
  double squared = 0.0;
  double cost = 0.0;
};

/// What the model says of a pair, and its derivative.
Vector3 Predict(const GyroFit& x, const GyroIntegral& gyro, const DoctorPair& p, double h,
                Term* term) {
  const double S = x.time_offset_s;
  const double k = x.sign * x.scale;
  const Matrix3 R_c_b = x.R_b_c.transpose();
  const Vector3 body = gyro.Between(p.t0 + S, p.t1 + S);
  const Vector3 slope =
      (gyro.Between(p.t0 + S + h, p.t1 + S + h) - gyro.Between(p.t0 + S - h, p.t1 + S - h)) /
      (2.0 * h);
  const Vector3 predicted = k * (R_c_b * body);
  term->J.leftCols<3>() = k * (R_c_b * so3::Hat(body));
  term->J.col(3) = k * (R_c_b * slope);
  term->J.middleCols<3>(4) = -k * (p.t1 - p.t0) * R_c_b;
  term->J.col(7) = predicted;
  return predicted;
}

/// Scale errors, jitter of stamps: half a percent, and a tenth of a milliradian.
Matrix3 ModelError(const DoctorPair& p) {
  const double model = 1e-4 + 0.005 * p.phi.norm();
  return model * model * Matrix3::Identity();
}

/// Against the rotation that the pair's tracks have alone.
Term AgainstRotation(const GyroFit& x, const GyroIntegral& gyro, const DoctorPair& p, double h,
                     Vector3*) {
  Term term;
  const Vector3 r = Predict(x, gyro, p, h, &term) - p.phi;
  term.information = Matrix3(p.covariance + ModelError(p)).inverse();
  term.gradient = term.information * r;
  term.squared = r.dot(term.gradient);
  term.cost = 12.0 * std::log1p(term.squared / 12.0);
  return term;
}

/// Against the tracks themselves. Rotation and translation of two images alone are hard to tell
/// apart, and a pair's own rotation may be that of a wrong minimum; at the predicted rotation only
/// the translation's direction is open.
class AgainstTracks {
 public:
  explicit AgainstTracks(const DoctorCase& c) : c_(c) {}
  Term operator()(const GyroFit& x, const GyroIntegral& gyro, const DoctorPair& p, double h,
                  Vector3* t) const {
    Term term;
    const Vector3 phi = Predict(x, gyro, p, h, &term);
    const WindowCamera& k = c_.input.cameras[Index(p.camera)];
    const double noise = std::max(p.noise, 0.05) * k.sigma_px;
    const EpipolarSum sum =
        SumEpipolar(p.some, noise / k.fx, noise / k.fy, so3::Exp(Vector3(-phi)), 3, t);
    term.cost = sum.cost;
    // Exp(-phi - d) = Exp(-Jr(phi) d) Exp(-phi).
    const Matrix3 Jr = so3::Jr(phi);
    const Matrix3 information = Jr.transpose() * sum.information * Jr + 1e-3 * Matrix3::Identity();
    const Matrix3 covariance = information.inverse();
    const Vector3 r = covariance * (-(Jr.transpose() * sum.gradient));
    term.information = Matrix3(covariance + ModelError(p)).inverse();
    term.gradient = term.information * r;
    term.squared = r.dot(term.gradient);
    return term;
  }

 private:
  const DoctorCase& c_;
};

/// Covariance of a fit of which neighbouring terms are not independent: pairs of images overlap,
/// and see the same points. Sandwich with the lags that overlap (W. Newey and K. West, Econometrica
/// 1987), and the plain one on top, which alone would be too sure, and the sandwich of few terms,
/// too.
///
/// Then what does not average out: noise of the tracks biases the rotation of a pair, the more the
/// weaker its geometry, and to the same side in all of them. A bias of kBias of a pair's sigma in
/// every pair does at most kBias sqrt(number of pairs) sigmas to the fit. (In simulation, where a
/// camera flies along walls and hardly turns, kBias = 0 is too sure by a factor of two.)
Matrix8 CovarianceOf(const Matrix8& H, const std::vector<Vector8>& gradients, std::size_t lags) {
  const Matrix8 plain = H.inverse();
  Matrix8 S = Matrix8::Zero();
  for (std::size_t lag = 0; lag <= lags && lag < gradients.size(); ++lag) {
    const double w = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    Matrix8 product = Matrix8::Zero();
    for (std::size_t i = lag; i < gradients.size(); ++i)
      product += gradients[i] * gradients[i - lag].transpose();
    S += lag == 0 ? product : Matrix8(w * (product + product.transpose()));
  }
  constexpr double kBias = 0.15;
  return (1.0 + kBias * kBias * static_cast<double>(gradients.size())) * plain + plain * S * plain;
}

/// Gauss-Newton with Cauchy's weights from the fit's own start. False where nothing came of it.
/// `cost` is the mean of that of the pairs, robust.
template <class MakeTerm>
bool Polish(const DoctorCase& c, const std::vector<DoctorPair>& pairs, const MakeTerm& make_term,
            int iterations, GyroFit* x, double* cost) {
  const double h = std::clamp(c.imu_dt, 1e-4, 0.02);
  // How far each may be from its start (rad, s, rad/s, log): wide, against what motion leaves open.
  Vector8 prior;
  prior << 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 4.0;
  double scale2 = 1.0;   // of the squared distances
  std::size_t lags = 0;  // neighbours that overlap with a pair
  for (const DoctorPair& p : pairs)
    lags += p.t0 > pairs.front().t0 && p.t0 < pairs.front().t1 ? 1 : 0;
  std::vector<Vector3> translations;
  for (const DoctorPair& p : pairs)
    translations.push_back(p.t);
  for (int k = 0; k < iterations; ++k) {
    const GyroIntegral gyro(c.imu, x->unit, x->bias);
    std::vector<Term> terms;
    std::vector<double> distances;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const DoctorPair& p = pairs[i];
      const double S = x->time_offset_s;
      if (!gyro.Covers(p.t0 + S - h, p.t1 + S + h)) continue;
      terms.push_back(make_term(*x, gyro, p, h, &translations[i]));
      distances.push_back(terms.back().squared);
    }
    if (terms.size() < 10) return false;
    x->pairs = static_cast<int>(terms.size());
    scale2 = std::max(QuantileOf(&distances, 0.5) / 2.366, 1e-6);  // median of chi2 with 3 degrees
    Matrix8 H = Matrix8::Zero();
    Vector8 g = Vector8::Zero();
    double sum = 0.0;
    std::vector<Vector8> gradients;
    for (const Term& term : terms) {
      const double s = term.squared / scale2;
      const double w = 1.0 / (1.0 + s / 12.0);
      H += w / scale2 * term.J.transpose() * term.information * term.J;
      gradients.emplace_back(w / scale2 * term.J.transpose() * term.gradient);
      g += gradients.back();
      sum += term.cost;
    }
    H.diagonal() += prior;
    *cost = sum / static_cast<double>(terms.size());
    x->covariance = CovarianceOf(H, gradients, lags);
    x->misfit = std::sqrt(scale2);
    Vector8 d = -(H.ldlt().solve(g));
    if (!d.allFinite() || !x->covariance.allFinite()) return false;
    // Not further at once than the slope in S holds.
    const double most = std::max(std::abs(d[3]) / 0.05, d.head<3>().norm() / 0.5);
    if (most > 1.0) d /= most;
    x->R_b_c = so3::Exp(Vector3(d.head<3>())) * x->R_b_c;
    x->time_offset_s += d[3];
    x->bias += d.segment<3>(4);
    x->scale *= std::exp(d[7]);
    if (d.norm() < 1e-6) break;
  }
  return std::abs(x->time_offset_s) < 2.0 * c.options.max_time_offset_s + 0.1;
}

}  // namespace

GyroFit FitGyroToPairs(const DoctorCase& c, int camera) {
  GyroFit fit;
  if (c.imu.size() < 20) return fit;
  const std::vector<DoctorPair> pairs = PairsWithImu(c, camera);
  fit.pairs = static_cast<int>(pairs.size());
  if (pairs.size() < 10) return fit;
  std::vector<double> noise;
  for (const DoctorPair& p : pairs)
    noise.push_back(p.covariance.trace());
  fit.noise_rms = std::sqrt(QuantileOf(&noise, 0.5));

  const GyroIntegral plain(c.imu, 1.0, Vector3::Zero());
  const double range = c.options.max_time_offset_s, step = 0.01;
  const int steps = static_cast<int>(std::ceil(range / step));
  GyroCorrelation best;
  double best_offset = 0.0;
  for (int k = -steps; k <= steps; ++k) {
    const double S = std::clamp(k * step, -range, range);
    const GyroCorrelation r = CorrelationAt(plain, pairs, S);
    if (k == -steps || std::max(r.proper, r.mirrored) > std::max(best.proper, best.mirrored)) {
      best = r;
      best_offset = S;
    }
  }
  fit.rotation_rms = best.camera_rms;
  fit.correlation = std::clamp(std::max(best.proper, best.mirrored), 0.0, 1.0);
  fit.time_offset_s = best_offset;
  if (!(fit.rotation_rms > 2.0 * fit.noise_rms) || fit.correlation < 0.5) return fit;
  for (const double unit : {kDegree, 1.0 / kDegree}) {
    if (best.scale > 0.6 * unit && best.scale < 1.7 * unit) fit.unit = unit;
  }
  const Matrix3 given = c.input.cameras[Index(camera)].T_b_c.R();
  GyroFit proper = fit, mirrored = fit;
  proper.R_b_c = BestRotation(best.M, given);
  mirrored.R_b_c = BestRotation(Matrix3(-best.M), given);
  mirrored.sign = -1.0;
  double cost = 0.0, mirrored_cost = 0.0;
  proper.ok = Polish(c, pairs, AgainstRotation, 15, &proper, &cost);
  mirrored.ok = Polish(c, pairs, AgainstRotation, 15, &mirrored, &mirrored_cost);
  // A mirror is believed where rotations are clearly worse: about one axis both fit.
  if (mirrored.ok && (!proper.ok || (mirrored_cost < 0.5 * cost && cost > 9.0))) proper = mirrored;
  if (!proper.ok) return proper;
  // On the tracks themselves, from what the rotations say and from what was given: whatever the
  // tracks like better.
  GyroFit nominal = proper;
  nominal.R_b_c = given;
  nominal.sign = 1.0;
  nominal.scale = 1.0;
  nominal.time_offset_s = 0.0;
  const AgainstTracks on_tracks(c);
  double fitted_cost = 0.0, nominal_cost = 0.0;
  proper.ok = Polish(c, pairs, on_tracks, 8, &proper, &fitted_cost);
  nominal.ok = Polish(c, pairs, on_tracks, 8, &nominal, &nominal_cost);
  return nominal.ok && (!proper.ok || nominal_cost < fitted_cost) ? nominal : proper;
}

}  // namespace glissade::internal
