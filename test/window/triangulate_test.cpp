// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/triangulate.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "common/random_states.h"

namespace glissade {
namespace {

using test::Random;

/// Views from around the origin of a point in front of them, with Gaussian-like noise (sum of
/// uniforms) of `noise` times sigma.
std::vector<TriangulationView> MakeViews(Random& random, const Vector3& X, int count,
                                         double baseline, double noise, double sigma = 2e-3) {
  std::vector<TriangulationView> views;
  for (int k = 0; k < count; ++k) {
    TriangulationView view;
    const Vector3 p = random.Vec3(baseline);
    view.T_w_c = Pose(random.Rotation(0.1), p);
    view.sigma = sigma;
    const Vector3 x = view.T_w_c.Inverse() * X;
    for (int i = 0; i < 2; ++i) {
      double sum = 0.0;
      for (int n = 0; n < 12; ++n)
        sum += random.Uniform(-0.5, 0.5);
      view.uv[i] = x[i] / x[2] + noise * sigma * sum;
    }
    views.push_back(view);
  }
  return views;
}

TEST(Triangulate, FindsAPointThatIsSeenWithoutNoise) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3 X(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0),
                    random.Uniform(2.0, 20.0));
    const auto point =
        Triangulate(MakeViews(random, X, 2 + trial % 5, 0.5, 0.0), {.max_relative_sigma = 10.0});
    if (!point.ok()) {  // two views may happen to lie on one line with the point
      EXPECT_EQ(point.status().code(), StatusCode::kSingular);
      continue;
    }
    EXPECT_LT((point->X_w - X).norm(), 1e-8 * X.squaredNorm());
    EXPECT_LT(point->max_chi2, 1e-9);
  }
}

TEST(Triangulate, TheCovarianceIsThatOfTheError) {
  Random random(3);
  const Vector3 X(0.3, -0.2, 5.0);
  double nees = 0.0;
  int count = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto point = Triangulate(MakeViews(random, X, 4, 0.7, 1.0), {.max_chi2 = 1e9});
    if (!point.ok()) continue;
    const Vector3 e = point->X_w - X;
    nees += e.dot(Eigen::Matrix3d(point->covariance).inverse() * e);
    ++count;
  }
  ASSERT_GT(count, 1900);
  EXPECT_NEAR(nees / count, 3.0, 0.25);  // sigma of the mean: sqrt(6 / 2000) = 0.055
}

TEST(Triangulate, RefusesWhatIsNoPoint) {
  Random random(4);
  const Vector3 X(0.3, -0.2, 5.0);
  const auto code = [](const std::vector<TriangulationView>& views,
                       const TriangulationOptions& options = {}) {
    return Triangulate(views, options).status().code();
  };
  auto views = MakeViews(random, X, 3, 0.5, 0.0);
  EXPECT_EQ(code(views), StatusCode::kOk);
  EXPECT_EQ(code({views[0]}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({}), StatusCode::kInvalidArgument);
  // One place: no parallax.
  EXPECT_EQ(code({views[0], views[0]}), StatusCode::kSingular);
  // Far away for its noise.
  EXPECT_EQ(code(MakeViews(random, Vector3(0.0, 0.0, 500.0), 3, 0.5, 0.0)), StatusCode::kSingular);
  // Behind.
  EXPECT_EQ(code(MakeViews(random, Vector3(0.1, 0.1, -4.0), 3, 0.5, 0.0)),
            StatusCode::kEvaluationFailed);
  // One view of something else.
  auto wrong = views;
  wrong[1].uv[0] += 0.05;
  wrong[1].uv[1] -= 0.05;
  EXPECT_EQ(code(wrong), StatusCode::kEvaluationFailed);
  // Not finite.
  wrong = views;
  wrong[2].uv[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(wrong), StatusCode::kNotFinite);
  wrong = views;
  wrong[2].sigma = 0.0;
  EXPECT_EQ(code(wrong), StatusCode::kNotPositive);
}

}  // namespace
}  // namespace glissade
