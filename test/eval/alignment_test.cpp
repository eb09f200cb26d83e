// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "eval_test_util.h"

namespace glissade::eval {
namespace {

constexpr AlignmentKind kKinds[] = {AlignmentKind::kYaw, AlignmentKind::kSe3, AlignmentKind::kSim3};

/// A transform of a kind, about a vertical where it is one of yaw.
Alignment RandomAlignment(Engine& engine, AlignmentKind kind, const Vector3& vertical) {
  const double angle = engine.Uniform(-std::numbers::pi, std::numbers::pi);
  Alignment a;
  a.T_r_e = RandomPose(engine, 10.0, 2.0);
  if (kind == AlignmentKind::kYaw) {
    a.T_r_e = Pose(so3::ExpQuaternion(Vector3(angle * vertical)), a.T_r_e.p());
  }
  if (kind == AlignmentKind::kSim3) a.scale = std::exp(RandomVector(engine, 1.0)[0]);
  return a;
}

double Cost(const MatchedTrajectories& m, const Alignment& a) {
  double cost = 0.0;
  for (std::size_t k = 0; k < m.estimate.size(); ++k)
    cost += (a.Apply(m.estimate[k].T_w_b).p() - m.reference[k].T_w_b.p()).squaredNorm();
  return cost;
}

double AngleBetween(const Pose& a, const Pose& b) {
  return so3::Log(Quaternion(a.q().conjugate() * b.q())).norm();
}

TEST(Alignment, RecoversATransformThatIsThere) {
  Engine engine(1);
  for (const AlignmentKind kind : kKinds) {
    for (int trial = 0; trial < 100; ++trial) {
      AlignmentOptions options;
      options.kind = kind;
      if (trial % 2 == 1) options.vertical = RandomVector(engine, 1.0);
      const Vector3 u = options.vertical.normalized();
      MatchedTrajectories m;
      m.estimate = RandomTrajectory(engine, trial == 0 ? 4 : 50);
      const Alignment truth = RandomAlignment(engine, kind, u);
      m.reference = m.estimate;
      ApplyAlignment(truth, m.reference);
      const auto found = Align(m, options);
      ASSERT_TRUE(found.ok()) << found.status().message();
      EXPECT_NEAR(found->scale / truth.scale, 1.0, 1e-12);
      EXPECT_LT(AngleBetween(found->T_r_e, truth.T_r_e), 1e-10);
      EXPECT_LT((found->T_r_e.p() - truth.T_r_e.p()).norm(), 1e-10 * truth.scale);
      ApplyAlignment(*found, m.estimate);
      for (std::size_t k = 0; k < m.estimate.size(); ++k) {
        EXPECT_LT((m.estimate[k].T_w_b.p() - m.reference[k].T_w_b.p()).norm(), 1e-10 * truth.scale);
        EXPECT_LT(AngleBetween(m.estimate[k].T_w_b, m.reference[k].T_w_b), 1e-10);
      }
    }
  }
}

TEST(Alignment, IsOptimal) {
  Engine engine(2);
  for (const AlignmentKind kind : kKinds) {
    for (int trial = 0; trial < 30; ++trial) {
      AlignmentOptions options;
      options.kind = kind;
      if (trial % 2 == 1) options.vertical = RandomVector(engine, 1.0);
      const Vector3 u = options.vertical.normalized();
      MatchedTrajectories m;
      m.estimate = RandomTrajectory(engine, 20);
      m.reference = m.estimate;
      ApplyAlignment(RandomAlignment(engine, kind, u), m.reference);
      m.reference = Noisy(engine, m.reference, 0.5, 0.1);
      const auto best = Align(m, options);
      ASSERT_TRUE(best.ok());
      const double cost = Cost(m, *best);
      // Every direction that the kind has, both ways, from tiny to large.
      const auto higher = [&](const Pose& by, double scale) {
        Alignment other = *best;
        other.T_r_e = by * other.T_r_e;
        other.scale *= scale;
        EXPECT_GT(Cost(m, other), cost) << ToString(kind);
      };
      for (const double size : {1e-4, -1e-4, 1e-2, -1e-2, 1.0, -1.0}) {
        for (int i = 0; i < 3; ++i) {
          Vector3 d = Vector3::Zero();
          d[i] = size;
          higher(Pose(Quaternion::Identity(), d), 1.0);
          const Vector3 phi = kind == AlignmentKind::kYaw ? Vector3(size * u) : d;
          higher(Pose(so3::ExpQuaternion(phi), Vector3::Zero()), 1.0);
        }
        if (kind == AlignmentKind::kSim3) higher(Pose(), 1.0 + 0.5 * size);
      }
      // Any other transform of the kind.
      for (int k = 0; k < 20; ++k)
        EXPECT_GT(Cost(m, RandomAlignment(engine, kind, u)), cost);
    }
  }
}

TEST(Alignment, NeverReflects) {
  // Mirrored and planar positions: the best orthogonal matrix would be a reflection.
  Engine engine(4);
  MatchedTrajectories m;
  m.estimate = RandomTrajectory(engine, 30);
  m.reference = m.estimate;
  for (StampedPose& x : m.reference)
    x.T_w_b.p()[0] *= -1.0;
  for (const AlignmentKind kind : {AlignmentKind::kSe3, AlignmentKind::kSim3}) {
    AlignmentOptions options;
    options.kind = kind;
    const auto found = Align(m, options);
    ASSERT_TRUE(found.ok());
    EXPECT_NEAR(found->T_r_e.R().determinant(), 1.0, 1e-12);
    EXPECT_GT(found->scale, 0.0);
    const double cost = Cost(m, *found);
    for (int k = 0; k < 500; ++k)
      EXPECT_GE(Cost(m, RandomAlignment(engine, kind, {0, 0, 1})), cost);
  }
  for (StampedPose& x : m.estimate)
    x.T_w_b.p()[2] = 3.0;
  m.reference = m.estimate;
  ApplyAlignment(RandomAlignment(engine, AlignmentKind::kSe3, {0, 0, 1}), m.reference);
  AlignmentOptions options;
  options.kind = AlignmentKind::kSe3;
  const auto planar = Align(m, options);
  ASSERT_TRUE(planar.ok());
  EXPECT_LT(Cost(m, *planar), 1e-20);
}

TEST(Alignment, FarFromTheOrigin) {
  Engine engine(5);
  MatchedTrajectories m;
  m.estimate = RandomTrajectory(engine, 50);
  m.reference = m.estimate;
  Alignment truth = RandomAlignment(engine, AlignmentKind::kSe3, {0, 0, 1});
  truth.T_r_e.p() += Vector3(4e6, -5e5, 100.0);  // as UTM coordinates
  ApplyAlignment(truth, m.reference);
  AlignmentOptions options;
  options.kind = AlignmentKind::kSim3;
  const auto found = Align(m, options);
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found->scale, 1.0, 1e-9);
  EXPECT_LT(AngleBetween(found->T_r_e, truth.T_r_e), 1e-9);
}

/// Positions on a line through `from` along `to`.
MatchedTrajectories OnALine(const Vector3& from, const Vector3& to, int n) {
  MatchedTrajectories m;
  for (int k = 0; k < n; ++k) {
    const Vector3 p = from + (0.1 * k + 0.01 * k * k) * to;
    m.estimate.push_back({k, Pose(Quaternion::Identity(), p)});
  }
  m.reference = m.estimate;
  return m;
}

StatusCode CodeOf(const MatchedTrajectories& m, AlignmentKind kind) {
  AlignmentOptions options;
  options.kind = kind;
  return Align(m, options).status().code();
}

TEST(Alignment, DegenerateInputIsSingular) {
  const StatusCode ok = StatusCode::kOk, singular = StatusCode::kSingular;
  for (const double far : {0.0, 1.0, 1e6}) {
    const Vector3 from(far, -0.3 * far, 0.7 * far);
    const MatchedTrajectories oblique = OnALine(from, {0.3, -0.7, 0.2}, 1000);
    EXPECT_EQ(CodeOf(oblique, AlignmentKind::kSe3), singular) << far;
    EXPECT_EQ(CodeOf(oblique, AlignmentKind::kSim3), singular) << far;
    EXPECT_EQ(CodeOf(oblique, AlignmentKind::kYaw), ok) << far;
    const MatchedTrajectories vertical = OnALine(from, {0, 0, 1}, 1000);
    EXPECT_EQ(CodeOf(vertical, AlignmentKind::kSe3), singular) << far;
    EXPECT_EQ(CodeOf(vertical, AlignmentKind::kYaw), singular) << far;
    const MatchedTrajectories still = OnALine(from, {0, 0, 0}, 1000);
    for (const AlignmentKind kind : kKinds)
      EXPECT_EQ(CodeOf(still, kind), singular) << far << ToString(kind);
    EXPECT_EQ(CodeOf(still, AlignmentKind::kNone), ok);
  }
  // Too few.
  const MatchedTrajectories two = OnALine({0, 0, 0}, {1, 2, 3}, 2);
  EXPECT_EQ(CodeOf(two, AlignmentKind::kYaw), ok);
  EXPECT_EQ(CodeOf(two, AlignmentKind::kSe3), singular);
  const MatchedTrajectories one = OnALine({0, 0, 0}, {1, 2, 3}, 1);
  EXPECT_EQ(CodeOf(one, AlignmentKind::kYaw), singular);
  EXPECT_EQ(CodeOf(one, AlignmentKind::kNone), ok);
  for (const AlignmentKind kind : {AlignmentKind::kNone, AlignmentKind::kYaw, AlignmentKind::kSe3})
    EXPECT_EQ(CodeOf({}, kind), singular);
}

TEST(Alignment, AThinCurveIsNoLine) {
  // A road of 1 km that swerves by 10 cm.
  MatchedTrajectories m = OnALine({0, 0, 0}, {1, 0, 0}, 300);
  for (std::size_t k = 0; k < m.estimate.size(); ++k)
    m.estimate[k].T_w_b.p()[1] = 0.1 * std::sin(0.1 * static_cast<double>(k));
  m.reference = m.estimate;
  EXPECT_EQ(CodeOf(m, AlignmentKind::kSe3), StatusCode::kOk);
}

TEST(Alignment, Refusals) {
  Engine engine(6);
  MatchedTrajectories m;
  m.estimate = RandomTrajectory(engine, 10);
  m.reference = m.estimate;
  AlignmentOptions options;
  options.vertical = Vector3::Zero();
  EXPECT_EQ(Align(m, options).status().code(), StatusCode::kInvalidArgument);
  options.vertical[0] = std::nan("");
  EXPECT_EQ(Align(m, options).status().code(), StatusCode::kNotFinite);
  options.vertical = {0, 0, 1e-200};  // a direction all the same
  EXPECT_TRUE(Align(m, options).ok());
  options.kind = static_cast<AlignmentKind>(17);
  EXPECT_EQ(Align(m, options).status().code(), StatusCode::kInvalidArgument);
  m.estimate[3].T_w_b.data[0] = 1e300;
  EXPECT_EQ(Align(m).status().code(), StatusCode::kNotFinite);
  m.estimate.pop_back();
  EXPECT_EQ(Align(m).status().code(), StatusCode::kInvalidArgument);
}

TEST(Alignment, OfOnePoseLeavesNoPositionAndNoYaw) {
  Engine engine(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Pose estimate = RandomPose(engine, 5, 3), truth = RandomPose(engine, 5, 3);
    const Vector3 u =
        trial % 2 == 0 ? Vector3(0, 0, 1) : Vector3(RandomVector(engine, 1).normalized());
    const Alignment a = AlignPose(estimate, truth, u);
    EXPECT_EQ(a.scale, 1.0);
    // A rotation about the vertical.
    EXPECT_LT((a.T_r_e.R() * u - u).norm(), 1e-14);
    const Pose moved = a.Apply(estimate);
    EXPECT_LT((moved.p() - truth.p()).norm(), 1e-14);
    const Quaternion left(moved.q() * truth.q().conjugate());
    EXPECT_NEAR(left.vec().dot(u), 0.0, 1e-14);
    EXPECT_NEAR(RotationAbout(left.coeffs().data(), u), 0.0, 1e-13);
  }
}

TEST(Alignment, RotationAboutAnAxis) {
  const Vector3 u = Vector3(1, -2, 0.5).normalized();
  const Vector3 tilt = 0.4 * Vector3(2, 1, 0).normalized();  // across u
  for (const double angle : {-3.1, -1.0, 0.0, 1e-9, 2.0, 3.1}) {
    for (const double sign : {1.0, -1.0}) {
      Quaternion q(so3::ExpQuaternion(tilt) * so3::ExpQuaternion(Vector3(angle * u)));
      q.coeffs() *= sign;
      EXPECT_NEAR(RotationAbout(q.coeffs().data(), u), angle, 1e-15 + 1e-14 * std::abs(angle));
    }
  }
}

}  // namespace
}  // namespace glissade::eval
