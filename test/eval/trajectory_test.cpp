// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "eval_test_util.h"
#include "glissade/eval/association.h"

namespace glissade::eval {
namespace {

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();

Trajectory At(std::initializer_list<std::int64_t> stamps) {
  Trajectory trajectory;
  for (const std::int64_t stamp : stamps) {
    const auto x = static_cast<double>(stamp);
    trajectory.push_back({stamp, Pose(so3::ExpQuaternion({0, 0, 0.01 * x}), {x, 0, 0})});
  }
  return trajectory;
}

std::vector<std::int64_t> StampsOf(const Trajectory& trajectory) {
  std::vector<std::int64_t> stamps;
  for (const StampedPose& x : trajectory)
    stamps.push_back(x.stamp_ns);
  return stamps;
}

using Stamps = std::vector<std::int64_t>;

TEST(Trajectory, ValidationNamesThePose) {
  Trajectory x = At({1, 2, 3, 4});
  EXPECT_TRUE(ValidateTrajectory(x, "truth").ok());
  EXPECT_TRUE(ValidateTrajectory({}, "truth").ok());
  x[2].stamp_ns = 2;
  EXPECT_EQ(ValidateTrajectory(x, "truth").code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(ValidateTrajectory(x, "truth").message(), "truth: pose 2: stamp 2 is not later than 2");
  x = At({1, 2, 3});
  x[1].T_w_b.data[2] = std::nan("");
  EXPECT_EQ(ValidateTrajectory(x, "truth").code(), StatusCode::kNotFinite);
  EXPECT_EQ(ValidateTrajectory(x, "truth").message().find("truth: pose 1"), 0u);
  x = At({1, 2, 3});
  x[0].T_w_b.data[6] = 1.1;
  EXPECT_EQ(ValidateTrajectory(x, "truth").code(), StatusCode::kInvalidArgument);
}

TEST(Trajectory, PathLength) {
  EXPECT_EQ(PathLength({}), 0.0);
  EXPECT_EQ(PathLength(At({1})), 0.0);
  EXPECT_DOUBLE_EQ(PathLength(At({1, 4, 10})), 9.0);
}

TEST(Trajectory, InterpolationIsLinearAndSlerp) {
  Engine engine(1);
  for (int trial = 0; trial < 100; ++trial) {
    const StampedPose a{1000, RandomPose(engine, 3, 2)};
    // Less than half a turn apart, so that the shorter way is this one.
    const Vector3 turn = 3.0 * RandomVector(engine, 1.0).normalized();
    StampedPose b{1800, Pose(Quaternion(a.T_w_b.q() * so3::ExpQuaternion(turn)), {1, 2, 3})};
    if (trial % 2 == 1) b.T_w_b.q().coeffs() *= -1.0;  // the same rotation
    const StampedPose x = Interpolate(a, b, 1200);
    EXPECT_EQ(x.stamp_ns, 1200);
    EXPECT_LT((x.T_w_b.p() - (0.75 * a.T_w_b.p() + 0.25 * b.T_w_b.p())).norm(), 1e-14);
    const Quaternion expected(a.T_w_b.q() * so3::ExpQuaternion(Vector3(0.25 * turn)));
    EXPECT_LT(so3::Log(Quaternion(expected.conjugate() * x.T_w_b.q())).norm(), 1e-14);
    EXPECT_EQ(Interpolate(a, b, 1000), a);
    EXPECT_EQ(Interpolate(a, b, 1800), b);
    EXPECT_EQ(Interpolate(a, b, kMin), a);  // clamped
    EXPECT_EQ(Interpolate(a, b, kMax), b);
  }
}

TEST(Trajectory, InterpolationOverAllOfTime) {
  const StampedPose a{kMin, Pose()}, b{kMax, Pose(Quaternion::Identity(), {1, 0, 0})};
  EXPECT_NEAR(Interpolate(a, b, 0).T_w_b.p()[0], 0.5, 1e-15);
}

TEST(Association, InterpolatesButDoesNotExtrapolate) {
  const auto matched = Associate(At({-5, 0, 3, 10, 14, 20, 21}), At({0, 10, 20}));
  ASSERT_TRUE(matched.ok());
  EXPECT_EQ(StampsOf(matched->estimate), (Stamps{0, 3, 10, 14, 20}));
  EXPECT_EQ(StampsOf(matched->reference), (Stamps{0, 3, 10, 14, 20}));
  for (std::size_t k = 0; k < 5; ++k) {
    const StampedPose &e = matched->estimate[k], &r = matched->reference[k];
    EXPECT_NEAR(r.T_w_b.p()[0], static_cast<double>(r.stamp_ns), 1e-14);
    EXPECT_LT(so3::Log(Quaternion(e.T_w_b.q().conjugate() * r.T_w_b.q())).norm(), 1e-15);
  }
  EXPECT_TRUE(matched->Validate().ok());
}

TEST(Association, DoesNotBridgeGaps) {
  AssociationOptions options;
  options.max_gap_ns = 10;
  const auto matched = Associate(At({5, 12, 21, 25}), At({0, 10, 21, 30}), options);
  ASSERT_TRUE(matched.ok());
  EXPECT_EQ(StampsOf(matched->estimate), (Stamps{5, 21, 25}));  // 12 lies in a gap of 11
}

TEST(Association, NearestIsMutualAndWithinTheTolerance) {
  AssociationOptions options;
  options.kind = AssociationKind::kNearest;
  options.tolerance_ns = 3;
  // 8 and 11 both want 10: 11 has it. 33 is 3 from 30, 44 is 4 from 40.
  const auto matched = Associate(At({0, 8, 11, 33, 44}), At({1, 10, 30, 40, 100}), options);
  ASSERT_TRUE(matched.ok());
  EXPECT_EQ(StampsOf(matched->estimate), (Stamps{0, 11, 33}));
  EXPECT_EQ(matched->reference[0].T_w_b.p()[0], 1.0);  // not interpolated
  EXPECT_EQ(matched->reference[1].T_w_b.p()[0], 10.0);
  EXPECT_EQ(matched->reference[2].T_w_b.p()[0], 30.0);
  // Of two as near, the earlier.
  options.tolerance_ns = 5;
  const auto tied = Associate(At({10, 20}), At({5, 15, 25}), options);
  ASSERT_TRUE(tied.ok());
  // 20 takes 15 of 15 and 25, but 15 has taken 10.
  EXPECT_EQ(StampsOf(tied->estimate), (Stamps{10}));
  EXPECT_EQ(tied->reference[0].T_w_b.p()[0], 5.0);
}

TEST(Association, NearestAgreesWithASearchOverAllPairs) {
  Engine engine(3);
  const auto stamp = [&] { return static_cast<std::int64_t>(engine.Uniform(0, 3000)); };
  for (int trial = 0; trial < 200; ++trial) {
    std::set<std::int64_t> a, b;
    for (int k = 0; k < 40; ++k)
      a.insert(stamp());
    for (int k = 0; k < 70; ++k)
      b.insert(stamp());
    Trajectory estimate, reference;
    for (const std::int64_t s : a)
      estimate.push_back(At({s})[0]);
    for (const std::int64_t s : b)
      reference.push_back(At({s})[0]);
    AssociationOptions options;
    options.kind = AssociationKind::kNearest;
    options.tolerance_ns = 20;
    const auto nearest = [](const std::set<std::int64_t>& in, std::int64_t to) {
      std::int64_t best = kMax, off = kMax;
      for (const std::int64_t s : in) {
        if (std::abs(s - to) < off) best = s, off = std::abs(s - to);
      }
      return best;
    };
    Stamps expected_e, expected_r;
    for (const std::int64_t s : a) {
      const std::int64_t r = nearest(b, s);
      if (std::abs(r - s) > 20 || nearest(a, r) != s) continue;
      expected_e.push_back(s);
      expected_r.push_back(r);
    }
    const auto matched = Associate(estimate, reference, options);
    ASSERT_TRUE(matched.ok());
    EXPECT_EQ(StampsOf(matched->estimate), expected_e);
    ASSERT_EQ(matched->reference.size(), expected_r.size());
    for (std::size_t k = 0; k < expected_r.size(); ++k)
      EXPECT_EQ(matched->reference[k].T_w_b.p()[0], static_cast<double>(expected_r[k]));
  }
}

TEST(Association, OffsetIsAddedToTheEstimate) {
  AssociationOptions options;
  options.offset_ns = 7;
  const auto matched = Associate(At({3, 13}), At({10, 20}), options);
  ASSERT_TRUE(matched.ok());
  EXPECT_EQ(StampsOf(matched->estimate), (Stamps{3, 13}));
  EXPECT_EQ(StampsOf(matched->reference), (Stamps{3, 13}));
  EXPECT_EQ(matched->reference[0].T_w_b.p()[0], 10.0);
  options.offset_ns = kMax;
  EXPECT_EQ(Associate(At({3, 13}), At({10, 20}), options).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(Association, Refusals) {
  const Trajectory good = At({1, 2, 3});
  Trajectory bad = good;
  bad[1].T_w_b.data[0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Associate(bad, good).status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(Associate(good, bad).status().code(), StatusCode::kNotFinite);
  EXPECT_NE(Associate(good, bad).status().message().find("reference"), std::string::npos);
  const auto apart = Associate(At({1000000000}), At({2000000000, 3000000000}));
  EXPECT_EQ(apart.status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(apart.status().message().find("covers 1.000 to 1.000 s"), std::string::npos);
  EXPECT_NE(apart.status().message().find("covers 2.000 to 3.000 s"), std::string::npos);
  EXPECT_FALSE(Associate({}, good).ok());
  EXPECT_FALSE(Associate(good, {}).ok());
  AssociationOptions options;
  options.tolerance_ns = -1;
  EXPECT_EQ(Associate(good, good, options).status().code(), StatusCode::kInvalidArgument);
}

TEST(Association, MatchedTrajectoriesMustMatch) {
  EXPECT_FALSE((MatchedTrajectories{At({1, 2}), At({1})}.Validate().ok()));
  EXPECT_FALSE((MatchedTrajectories{At({1, 2}), At({1, 3})}.Validate().ok()));
  EXPECT_FALSE((MatchedTrajectories{At({2, 1}), At({2, 1})}.Validate().ok()));
}

}  // namespace
}  // namespace glissade::eval
