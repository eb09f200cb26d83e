// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "glissade/lie/so3.h"
#include "glissade/sim/noise_source.h"
#include "window/init_two_view.h"

namespace glissade {
namespace {

using internal::Match;

struct TwoViews {
  Matrix3 R_b_a;
  Vector3 t;
  std::vector<Match> matches;

  /// Points of a room, or of one wall.
  TwoViews(std::uint64_t seed, int count, bool on_a_wall, double sigma, double outliers) {
    sim::NoiseSource random(seed);
    R_b_a = so3::Exp(Vector3(random.Uniform(0.05, 0.4) * random.Direction()));
    t = random.Direction();
    while (static_cast<int>(matches.size()) < count) {
      const double z = on_a_wall ? 5.0 : random.Uniform(2.5, 9.0);
      const Vector3 a(z * random.Uniform(-0.7, 0.7), z * random.Uniform(-0.5, 0.5),
                      z + (on_a_wall ? 0.3 * random.Uniform(-0.01, 0.01) : 0.0));
      const Vector3 b = R_b_a * a + 0.6 * t;
      if (b[2] < 0.5) continue;
      Match m;
      const auto noise = [&] { return random.Normal(sigma); };
      m.a = Vector2(a[0] / a[2] + noise(), a[1] / a[2] + noise());
      m.b = Vector2(b[0] / b[2] + noise(), b[1] / b[2] + noise());
      if (random.Uniform(0.0, 1.0) < outliers) {
        m.b = Vector2(random.Uniform(-0.7, 0.7), random.Uniform(-0.5, 0.5));
      }
      matches.push_back(m);
    }
  }
};

TEST(TwoView, FivePointsHaveTheirEssentialMatrixAmongTheSolutions) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const TwoViews views(seed, 5, false, 0.0, 0.0);
    const Eigen::Matrix3d E = Eigen::Matrix3d(so3::Hat(views.t)) * views.R_b_a / std::sqrt(2.0);
    std::vector<internal::Essential> found;
    internal::FivePoint(views.matches.data(), &found);
    EXPECT_LE(found.size(), 10u);
    double nearest = 1.0;
    for (const internal::Essential& candidate : found) {
      const Eigen::Matrix3d C(Eigen::Map<const Matrix3>(candidate.data()));
      EXPECT_NEAR(C.norm(), 1.0, 1e-12);
      EXPECT_NEAR(C.determinant(), 0.0, 1e-7) << seed;
      nearest = std::min({nearest, (C - E).norm(), (C + E).norm()});
    }
    EXPECT_LT(nearest, 1e-6) << seed;
  }
}

/// With noise of a pixel at f = 460 and a fifth of the matches wrong; the rotation that is expected
/// is off by 5 degrees. Of a wall there are two poses that fit, and either will be found: it must
/// fit as the true one does.
TEST(TwoView, RelativePoseDespiteOutliers) {
  const double sigma = 1.0 / 460.0;
  for (const bool on_a_wall : {false, true}) {
    int good = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const TwoViews views(seed, 80, on_a_wall, sigma, 0.2);
      const Pose expected(Matrix3(so3::Exp(Vector3(0.05, -0.05, 0.05)) * views.R_b_a),
                          Vector3::Zero());
      const auto pose = internal::FindRelativePose(views.matches, sigma, expected, 0.2);
      const auto again = internal::FindRelativePose(views.matches, sigma, expected, 0.2);
      ASSERT_TRUE(pose.ok) << seed;
      EXPECT_EQ(pose.t, again.t);
      EXPECT_NEAR(pose.t.norm(), 1.0, 1e-12);
      const double turned = so3::Log(Matrix3(pose.R_b_a.transpose() * views.R_b_a)).norm();
      const double direction = std::acos(std::min(1.0, pose.t.dot(views.t)));
      // A start for an adjustment: no more is asked of five points with noise.
      if (on_a_wall ? pose.inliers >= 45 : turned < 0.06 && direction < 0.35) ++good;
    }
    EXPECT_GE(good, 19) << on_a_wall;
  }
}

TEST(TwoView, ARotationExplainsItselfAndNoTranslation) {
  const double sigma = 1.0 / 460.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TwoViews views(seed, 100, false, sigma, 0.02);
    const Pose start(Matrix3(so3::Exp(Vector3(0.05, -0.05, 0.05)) * views.R_b_a), Vector3::Zero());
    EXPECT_GT(internal::FitRotation(views.matches, sigma, start).moved, 90) << seed;
    sim::NoiseSource random(seed, 3);
    for (Match& m : views.matches) {
      const Vector3 b = views.R_b_a * Vector3(m.a[0], m.a[1], 1.0);
      m.b = Vector2(b[0] / b[2] + random.Normal(sigma), b[1] / b[2] + random.Normal(sigma));
      m.a += Vector2(random.Normal(sigma), random.Normal(sigma));
    }
    const auto fit = internal::FitRotation(views.matches, sigma, start);
    // A half of 100, with a sigma of 5.
    EXPECT_GT(fit.moved, 28) << seed;
    EXPECT_LT(fit.moved, 72) << seed;
    EXPECT_NEAR(fit.median, std::sqrt(1.386), 0.35) << seed;
  }
}

}  // namespace
}  // namespace glissade
