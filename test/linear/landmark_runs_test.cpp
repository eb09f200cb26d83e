// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Edges of a user's own in packs: the same H, b and cost as one edge at a time, whatever the edges
// are like and in whatever order they come.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "support/template_edges.h"
#include "support/user_types.h"

namespace glissade {
namespace {

using test::BearingInPacks;
using test::BentInPacks;
using test::Normal;
using test::OffsetInPacks;
using test::OneByOne;
using test::RangeInPacks;

template <class E, bool kPacks>
auto Form(const E& edge) {
  if constexpr (kPacks) {
    return edge;
  } else {
    return OneByOne<E>{edge};
  }
}

struct Observation {
  int pose, landmark, kind;
  double noise[3];
};

/// Poses, points and bearings, with the observations in a random order.
template <bool kPacks>
Problem MakeProblem(unsigned seed, int num_poses, int num_landmarks) {
  std::mt19937 engine(seed);
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<Pose> truth;
  for (int k = 0; k < num_poses; ++k) {
    const Vector3 phi(Normal(engine, 0.1), Normal(engine, 0.1), Normal(engine, 0.1));
    const Vector3 p(0.3 * k, Normal(engine, 0.2), Normal(engine, 0.2));
    truth.emplace_back(so3::ExpQuaternion(phi), p);
    poses.push_back(problem.AddVertex(VertexPose{truth.back()}));
  }
  EXPECT_TRUE(problem.SetFixed(poses[0]).ok());
  std::vector<VertexHandle<VertexPointXYZ>> points;
  std::vector<VertexHandle<test::VertexBearing>> bearings;
  std::vector<Vector3> X, D;
  for (int l = 0; l < num_landmarks; ++l) {
    X.emplace_back(Normal(engine, 1.0), Normal(engine, 1.0), 5.0 + Normal(engine, 0.5));
    points.push_back(problem.AddVertex(VertexPointXYZ(X.back())));
    D.push_back(Vector3(Normal(engine, 0.2), Normal(engine, 0.2), 1.0).normalized());
    test::VertexBearing bearing;
    std::copy_n(D.back().data(), 3, bearing.data);
    bearings.push_back(problem.AddVertex(bearing));
  }
  std::vector<Observation> observations;
  for (int l = 0; l < num_landmarks; ++l) {
    for (int k = l % 3; k < num_poses; ++k) {
      for (int kind = 0; kind < 5; ++kind) {
        observations.push_back(
            {k, l, kind, {Normal(engine, 0.1), Normal(engine, 0.1), Normal(engine, 0.1)}});
      }
    }
  }
  std::shuffle(observations.begin(), observations.end(), engine);
  for (const Observation& o : observations) {
    const auto k = static_cast<std::size_t>(o.pose), l = static_cast<std::size_t>(o.landmark);
    const Vector3 x = truth[k].R().transpose() * (X[l] - truth[k].p());
    const Vector3 noise(o.noise[0], o.noise[1], o.noise[2]);
    const auto pose = poses[k];
    bool ok = true;
    if (o.kind == 0) {
      const RangeInPacks edge{x.norm() + noise[0]};
      using E = decltype(Form<RangeInPacks, kPacks>(edge));
      EdgeOptions<E> options;
      if (o.landmark % 2 == 0) options.loss = Cauchy{0.05};
      ok = problem.AddEdge(Form<RangeInPacks, kPacks>(edge), {pose, points[l]}, options).ok();
    } else if (o.kind < 3) {
      const OffsetInPacks edge{o.kind * x + noise, static_cast<double>(o.kind)};
      using E = decltype(Form<OffsetInPacks, kPacks>(edge));
      EdgeOptions<E> options;
      Matrix3 L = Matrix3::Identity();
      L(0, 1) = noise[0];
      L(2, 0) = 1.0;
      if (o.landmark % 3 != 0) options.sqrt_information = L;
      ok = problem.AddEdge(Form<OffsetInPacks, kPacks>(edge), {pose, points[l]}, options).ok();
    } else if (o.kind == 3) {
      const BentInPacks edge{X[l][2] - truth[k].p()[2] + noise[0]};
      ok = problem.AddEdge(Form<BentInPacks, kPacks>(edge), {pose, points[l]}).ok();
    } else {
      const Vector3 d = truth[k].R().transpose() * D[l];
      const BearingInPacks edge{Vector2(d[0] / d[2] + noise[0], d[1] / d[2] + noise[1])};
      ok = problem.AddEdge(Form<BearingInPacks, kPacks>(edge), {pose, bearings[l]}).ok();
    }
    EXPECT_TRUE(ok);
  }
  return problem;
}

TEST(LandmarkRuns, UsersEdgesInPacksAreThoseOneByOne) {
  for (const int num_poses : {2, 5, 9}) {
    for (const int num_landmarks : {1, 7, 8, 70}) {
      SCOPED_TRACE(std::to_string(num_poses) + " poses, " + std::to_string(num_landmarks));
      Problem packs = MakeProblem<true>(7, num_poses, num_landmarks);
      Problem single = MakeProblem<false>(7, num_poses, num_landmarks);
      ASSERT_TRUE(packs.MakeHessian().ok() && single.MakeHessian().ok());
      EXPECT_NEAR(packs.Cost().value(), single.Cost().value(), 1e-12 * single.Cost().value());
      const Eigen::MatrixXd H = single.Hessian();
      const Eigen::VectorXd b = single.Rhs();
      ASSERT_EQ(packs.Hessian().rows(), H.rows());
      EXPECT_LT((packs.Hessian() - H).cwiseAbs().maxCoeff(), 1e-12 * H.cwiseAbs().maxCoeff());
      EXPECT_LT((packs.Rhs() - b).cwiseAbs().maxCoeff(), 1e-12 * b.cwiseAbs().maxCoeff());
      const SolveSummary one = packs.Solve(), other = single.Solve();
      ASSERT_TRUE(one.ok() && other.ok()) << one.status.message();
      EXPECT_NEAR(one.final_cost, other.final_cost, 1e-9 * other.initial_cost);
    }
  }
}

TEST(LandmarkRuns, SummarySaysHowEdgesWereEvaluated) {
  const auto find = [](const SolveSummary& summary, std::string_view type) {
    for (const EdgeEvaluation& entry : summary.edges) {
      if (entry.type == type) return entry;
    }
    return EdgeEvaluation{};
  };
  Problem packs = MakeProblem<true>(7, 5, 40), single = MakeProblem<false>(7, 5, 40);
  const SolveSummary one = packs.Solve();
  const SolveSummary other = single.Solve();
  const EdgeEvaluation bent = find(one, kTypeInfo<BentInPacks>.name);
  const EdgeEvaluation offset = find(one, kTypeInfo<OffsetInPacks>.name);
  const EdgeEvaluation alone = find(other, kTypeInfo<OneByOne<BentInPacks>>.name);
  EXPECT_GT(bent.in_packs, 100);
  EXPECT_EQ(bent.one_by_one, 0);
  EXPECT_GT(bent.packs_redone, 0);
  EXPECT_EQ(offset.in_packs, 2 * bent.in_packs);
  EXPECT_EQ(offset.packs_redone, 0);
  EXPECT_EQ(bent.lanes % 8, 0);
  EXPECT_GE(bent.lanes, bent.in_packs);
  EXPECT_EQ(alone.in_packs, 0);
  EXPECT_EQ(alone.one_by_one, bent.in_packs);
  // Of one solve, not of all.
  const std::int64_t redone = bent.packs_redone;
  Problem again = MakeProblem<true>(7, 5, 40);
  ASSERT_TRUE(again.Solve().ok());
  EXPECT_LE(find(again.Solve(), kTypeInfo<BentInPacks>.name).packs_redone, redone);
}

/// Landmarks come in any order; each is seen by the poses that follow its own. Their edges are
/// shared out to several chunks.
TEST(LandmarkRuns, LanesAreFullWhateverTheOrderOfLandmarks) {
  constexpr int kViews = 5, kPoses = 200, kLandmarks = 8 * (kPoses - kViews);
  struct Landmark {
    int first;
    Vector3 x, noise;
  };
  std::mt19937 engine(5);
  std::vector<Landmark> landmarks;
  for (int l = 0; l < kLandmarks; ++l) {
    const int first = l / 8;
    const Vector3 x(0.3 * first + Normal(engine, 1.0), Normal(engine, 1.0), 5.0);
    const Vector3 noise(Normal(engine, 0.1), Normal(engine, 0.1), Normal(engine, 0.1));
    landmarks.push_back({first, x, noise});
  }
  double cost_in_order = 0.0;
  for (const bool shuffled : {false, true}) {
    SCOPED_TRACE(shuffled ? "shuffled" : "in order");
    if (shuffled) std::shuffle(landmarks.begin(), landmarks.end(), engine);
    Problem problem;
    std::vector<VertexHandle<VertexPose>> poses;
    for (int k = 0; k < kPoses; ++k) {
      poses.push_back(problem.AddVertex(
          VertexPose{Pose(so3::ExpQuaternion(Vector3::Zero()), Vector3(0.3 * k, 0.0, 0.0))}));
    }
    ASSERT_TRUE(problem.SetFixed(poses[0]).ok());
    for (const Landmark& landmark : landmarks) {
      const VertexHandle<VertexPointXYZ> point = problem.AddVertex(VertexPointXYZ(landmark.x));
      for (int k = landmark.first; k < landmark.first + kViews; ++k) {
        const Vector3 offset(landmark.x - Vector3(0.3 * k, 0.0, 0.0) + k % 3 * landmark.noise);
        ASSERT_TRUE(
            problem.AddEdge(OffsetInPacks{offset, 1.0}, {poses[static_cast<std::size_t>(k)], point})
                .ok());
      }
    }
    const SolveSummary summary = problem.Solve({.max_iterations = 3});
    ASSERT_TRUE(summary.ok()) << summary.status.message();
    ASSERT_EQ(summary.edges.size(), 1u);
    EXPECT_EQ(summary.edges[0].in_packs, kLandmarks * kViews);
    EXPECT_GT(summary.edges[0].in_packs, 0.85 * static_cast<double>(summary.edges[0].lanes));
    // And they are the same landmarks.
    EXPECT_GT(summary.final_cost, 1.0);
    EXPECT_LT(summary.final_cost, 0.9 * summary.initial_cost);
    if (!shuffled) cost_in_order = summary.final_cost;
    EXPECT_NEAR(summary.final_cost, cost_in_order, 1e-9 * cost_in_order);
  }
}

/// Squares that are numbers, and a sum of them that is none: it was looked for beyond their end.
TEST(LandmarkRuns, ACostThatOverflowsNamesNoEdge) {
  Problem problem;
  const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{});
  for (int k = 0; k < 3; ++k) {
    const VertexHandle<VertexPointXYZ> point = problem.AddVertex(VertexPointXYZ(1.0 + k, 0.0, 0.0));
    ASSERT_TRUE(problem.AddEdge(RangeInPacks{-1.3e154}, {pose, point}).ok());
  }
  const SolveSummary summary = problem.Solve();
  EXPECT_EQ(summary.status.code(), StatusCode::kNotFinite) << summary.status.message();
  EXPECT_FALSE(summary.status.edge());
}

}  // namespace
}  // namespace glissade
