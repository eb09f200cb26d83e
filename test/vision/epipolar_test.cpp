// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/epipolar.h"

#include <gtest/gtest.h>

#include <random>

#include "glissade/lie/so3.h"

namespace glissade::vision::internal {
namespace {

constexpr double kPx = 1.0 / 450.0;

struct Scene {
  Matrix3 R_a_b;
  std::vector<Match> matches;
  std::vector<unsigned char> good;
};

/// Points 2 to 8 m away, seen from two places `step` apart; each fifth match is wrong.
Scene MakeScene(const Vector3& step, const Vector3& turn, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.3 * kPx);
  Scene scene;
  scene.R_a_b = so3::Exp(turn);
  for (int k = 0; k < 150; ++k) {
    const Vector3 a(0.7 * uniform(random), 0.5 * uniform(random), 1.0);
    const double depth = 5.0 + 3.0 * uniform(random);
    const Vector3 b = scene.R_a_b.transpose() * Vector3(depth * a - step);
    Match m{{a[0], a[1]}, {b[0] / b[2] + noise(random), b[1] / b[2] + noise(random)}};
    const bool good = k % 5 != 0;
    if (!good) {
      m.b[0] += 0.05 * uniform(random);
      m.b[1] += 0.05 * uniform(random);
    }
    scene.matches.push_back(m);
    scene.good.push_back(good ? 1 : 0);
  }
  return scene;
}

/// Of the good ones kept, of the bad ones kept. Some bad ones lie on their line by chance.
std::pair<double, double> Kept(const Scene& scene, const std::vector<unsigned char>& fits) {
  double good = 0.0, kept_good = 0.0, bad = 0.0, kept_bad = 0.0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    (scene.good[k] ? good : bad) += 1.0;
    if (fits[k]) (scene.good[k] ? kept_good : kept_bad) += 1.0;
  }
  return {kept_good / good, kept_bad / bad};
}

TEST(Epipolar, FindsOutliersWhereTheTurnIsKnown) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene = MakeScene(Vector3(0.1, -0.05, 0.08), Vector3(0.02, -0.03, 0.05), seed);
    std::vector<unsigned char> fits;
    TwoViews views{scene.R_a_b, Vector3::Zero()};
    FitMatches(scene.matches, 1e-3, 1.5 * kPx, &views, &fits);
    const auto [good, bad] = Kept(scene, fits);
    EXPECT_GT(good, 0.97) << seed;
    EXPECT_LT(bad, 0.35) << seed;
    // (x/z, y/z) of the way say its direction.
    EXPECT_GT(std::abs(views.t_a.dot(Vector3(0.1, -0.05, 0.08).normalized())), 0.97) << seed;
  }
}

TEST(Epipolar, ATurnWithTheBiasInItIsCorrected) {
  // 0.08 rad/s for 50 ms: 1.8 px at the border.
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene = MakeScene(Vector3(0.08, 0.02, 0.03), Vector3(0.01, 0.02, -0.03), seed);
    const Matrix3 wrong = scene.R_a_b * so3::Exp(Vector3(0.0, 0.001, 0.004));
    std::vector<unsigned char> fits;
    TwoViews views{wrong, Vector3::Zero()};
    FitMatches(scene.matches, 5e-3, 1.5 * kPx, &views, &fits);
    const auto [good, bad] = Kept(scene, fits);
    EXPECT_GT(good, 0.95) << seed;
    EXPECT_LT(bad, 0.35) << seed;
  }
}

TEST(Epipolar, WithoutAWayWhatIsNoTurnIsFound) {
  const Scene scene = MakeScene(Vector3::Zero(), Vector3(0.02, -0.03, 0.05), 3);
  std::vector<unsigned char> fits;
  TwoViews views{scene.R_a_b, Vector3::Zero()};
  FitMatches(scene.matches, 1e-3, 1.5 * kPx, &views, &fits);
  EXPECT_GT(Kept(scene, fits).first, 0.97);
  EXPECT_LT(Kept(scene, fits).second, 0.4);
}

TEST(Epipolar, WithoutATurnFivePointsFindOutliers) {
  const Scene scene = MakeScene(Vector3(0.1, -0.05, 0.3), Vector3(0.02, -0.03, 0.05), 4);
  std::vector<unsigned char> fits;
  FitMatchesBlind(scene.matches, 1.5 * kPx, &fits);
  EXPECT_GT(Kept(scene, fits).first, 0.9);
  EXPECT_LT(Kept(scene, fits).second, 0.35);
}

TEST(Epipolar, DistanceIsThatFromTheLine) {
  TwoViews views;
  views.t_a = Vector3(1.0, 0.0, 0.0);  // lines are rows
  EXPECT_NEAR(EpipolarDistance(views, {{0.1, 0.2}, {-0.3, 0.2}}), 0.0, 1e-12);
  // Half of it in each image.
  EXPECT_NEAR(EpipolarDistance(views, {{0.1, 0.2}, {-0.3, 0.21}}), 0.01 / std::sqrt(2.0), 1e-6);
}

TEST(Epipolar, TooFewSayNothing) {
  std::vector<unsigned char> fits;
  TwoViews views;
  EXPECT_EQ(FitMatches({}, 1e-3, kPx, &views, &fits), 0);
  EXPECT_EQ(FitMatches({{{0, 0}, {1, 1}}}, 1e-3, kPx, &views, &fits), 1);
  EXPECT_EQ(FitMatchesBlind({{{0, 0}, {1, 1}}}, kPx, &fits), 1);
}

}  // namespace
}  // namespace glissade::vision::internal
