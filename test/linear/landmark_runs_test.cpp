// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Edges of a user's own in packs: the same H, b and cost as one edge at a time, whatever the edges
// are like and in whatever order they come.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "glissade/glissade.h"
#include "glissade/losses/cauchy.h"
#include "glissade/testing/check_jacobians.h"
#include "support/user_types.h"

namespace glissade {

/// A landmark whose view is not its state.
template <class T>
struct View<test::VertexBearing, T> {
  Vec<T, 3> d;
  Mat<T, 3, 2> basis;

  static View Of(const double* state) requires std::same_as<T, double> {
    test::VertexBearing v;
    std::copy_n(state, 3, v.data);
    const Matrix<3, 2> B = v.Basis();
    View view;
    std::copy_n(state, 3, view.d.a);
    std::copy_n(B.data(), 6, view.basis.a);
    return view;
  }
};

namespace {

/// Without any trait; one row.
struct RangeInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  static constexpr auto kLanes = Fields(&RangeInPacks::measured);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const T& range, Vec<T, 1>& r, Mat<T, 1, 6>* d_pose, Mat<T, 1, 3>* d_point) const {
    using std::sqrt;
    const Vec<T, 3> x = point.p - pose.p;
    const T distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (distance == T(0.0)) return false;
    r[0] = distance - range;
    const Mat<T, 1, 3> n = ((T(1.0) / distance) * x).Transpose();
    if (d_pose) *d_pose = {{-n[0], -n[1], -n[2], T(0.0), T(0.0), T(0.0)}};
    if (d_point) *d_point = n;
    return true;
  }
};

/// Three rows, and a member that is equal within a run.
struct OffsetInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  Vector3 measured = Vector3::Zero();
  double scale = 1.0;
  static constexpr auto kLanes = Fields(&OffsetInPacks::measured);
  [[nodiscard]] bool SameSensor(const OffsetInPacks& other) const { return scale == other.scale; }

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Vec<T, 3>& offset, Vec<T, 3>& r, Mat<T, 3, 6>* d_pose,
                Mat<T, 3, 3>* d_point) const {
    const Vec<T, 3> x = TransposeTimes(pose.R, point.p - pose.p);
    r = T(scale) * x - offset;
    const Mat<T, 3, 3> d = T(scale) * pose.R.Transpose();
    if (d_pose) {
      d_pose->Set(0, 0, -d);
      d_pose->Set(
          0, 3,
          T(scale) * Mat<T, 3, 3>{{T(0.0), -x[2], x[1], x[2], T(0.0), -x[0], -x[1], x[0], T(0.0)}});
    }
    if (d_point) *d_point = d;
    return true;
  }
};

/// Branches: quadratic far away.
struct BentInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double height = 0.0;
  static constexpr auto kLanes = Fields(&BentInPacks::height);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point, const T& at,
                Vec<T, 1>& r, Mat<T, 1, 6>* d_pose, Mat<T, 1, 3>* d_point) const {
    const T z = point.p[2] - pose.p[2] - at;
    T slope = T(1.0);
    r[0] = z;
    if (z > T(0.0)) {
      r[0] = z + z * z;
      slope = T(1.0) + T(2.0) * z;
    }
    if (d_pose) *d_pose = {{T(0.0), T(0.0), -slope, T(0.0), T(0.0), T(0.0)}};
    if (d_point) *d_point = {{T(0.0), T(0.0), slope}};
    return true;
  }
};

/// A two-dimensional landmark of one's own.
struct BearingInPacks {
  using Vertices = VertexList<VertexPose, test::VertexBearing>;
  static constexpr int kResidualDim = 2;
  Vector2 xy = Vector2::Zero();
  static constexpr auto kLanes = Fields(&BearingInPacks::xy);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<test::VertexBearing, T>& bearing,
                const Vec<T, 2>& at, Vec<T, 2>& r, Mat<T, 2, 6>* d_pose,
                Mat<T, 2, 2>* d_bearing) const {
    const Vec<T, 3> d = TransposeTimes(pose.R, bearing.d);
    const T inv_z = T(1.0) / d[2];
    r = {{d[0] * inv_z - at[0], d[1] * inv_z - at[1]}};
    const Mat<T, 2, 3> d_r_d_b = {{inv_z, T(0.0), -d[0] * inv_z * inv_z,  //
                                   T(0.0), inv_z, -d[1] * inv_z * inv_z}};
    if (d_pose) {
      for (int row = 0; row < 2; ++row) {
        d_pose->Set(row, 0, Mat<T, 1, 3>{{T(0.0), T(0.0), T(0.0)}});
        d_pose->Set(row, 3, Cross(d_r_d_b.Row(row), d));
      }
    }
    if (d_bearing) *d_bearing = d_r_d_b * pose.R.Transpose() * bearing.basis;
    return true;
  }
};

/// The same edge with a signature of today's: one at a time.
template <class E>
struct OneByOne {
  using Vertices = typename E::Vertices;
  static constexpr int kResidualDim = E::kResidualDim;
  using A = EdgeVertex<E, 0>;
  using B = EdgeVertex<E, 1>;
  E edge;

  bool Evaluate(const A& a, const B& b, Vector<kResidualDim>& r,
                Jacobian<kResidualDim, A::kTangentDim>* d_a,
                Jacobian<kResidualDim, B::kTangentDim>* d_b) const {
    return internal::EvaluateInDouble(edge, std::tie(a, b), r, d_a, d_b);
  }
};

template <class E, bool kPacks>
auto Form(const E& edge) {
  if constexpr (kPacks) {
    return edge;
  } else {
    return OneByOne<E>{edge};
  }
}

double Normal(std::mt19937& engine, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(engine);
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

TEST(LandmarkRuns, TemplateEdgesHaveTheJacobiansOfTheirResiduals) {
  const VertexPose pose{Pose(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 0.2, 0.3))};
  const VertexPointXYZ point(1.0, -0.5, 4.0);
  test::VertexBearing bearing;
  for (const JacobianCheck& check :
       {CheckJacobians(RangeInPacks{2.0}, pose, point),
        CheckJacobians(OffsetInPacks{Vector3(1.0, 2.0, 3.0), 2.0}, pose, point),
        CheckJacobians(BentInPacks{1.0}, pose, point),
        CheckJacobians(BentInPacks{9.0}, pose, point),
        CheckJacobians(BearingInPacks{}, pose, bearing)}) {
    EXPECT_TRUE(check.ok) << check.message;
  }
}

/// One of many points lies where the pose is: a condition that one lane alone has, and no value.
TEST(LandmarkRuns, AnEdgeThatFailsInOneLaneIsNamed) {
  for (const int bad : {0, 3, 8, 20}) {
    Problem problem;
    const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{});
    EdgeHandle<RangeInPacks> culprit;
    for (int k = 0; k < 21; ++k) {
      const VertexHandle<VertexPointXYZ> point =
          problem.AddVertex(VertexPointXYZ(k == bad ? 0.0 : 1.0 + k, 0.0, 0.0));
      const EdgeHandle<RangeInPacks> edge = problem.AddEdge(RangeInPacks{1.0}, {pose, point});
      if (k == bad) culprit = edge;
    }
    const SolveSummary summary = problem.Solve();
    EXPECT_EQ(summary.status.code(), StatusCode::kEvaluationFailed);
    EXPECT_EQ(summary.status.edge(), AnyEdge(culprit)) << summary.status.message();
  }
}

/// NaN where it did not look for it.
TEST(LandmarkRuns, AnEdgeThatIsNotFiniteInOneLaneIsNamed) {
  for (const int bad : {0, 5, 19}) {
    Problem problem;
    VertexPose behind;
    const VertexHandle<VertexPose> pose = problem.AddVertex(behind);
    EdgeHandle<BearingInPacks> culprit;
    for (int k = 0; k < 20; ++k) {
      test::VertexBearing bearing;  // sideways: z is 0
      if (k == bad) {
        bearing.data[0] = 1.0;
        bearing.data[2] = 0.0;
      }
      const VertexHandle<test::VertexBearing> vertex = problem.AddVertex(bearing);
      const EdgeHandle<BearingInPacks> edge = problem.AddEdge(BearingInPacks{}, {pose, vertex});
      if (k == bad) culprit = edge;
    }
    const SolveSummary summary = problem.Solve();
    EXPECT_EQ(summary.status.code(), StatusCode::kEvaluationFailed);
    EXPECT_EQ(summary.status.edge(), AnyEdge(culprit)) << summary.status.message();
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
  std::mt19937 engine(5);
  std::vector<int> first;
  for (int l = 0; l < kLandmarks; ++l)
    first.push_back(l % (kPoses - kViews));
  std::shuffle(first.begin(), first.end(), engine);
  for (const bool shuffled : {false, true}) {
    if (!shuffled) std::sort(first.begin(), first.end());
    if (shuffled) std::shuffle(first.begin(), first.end(), engine);
    Problem problem;
    std::vector<VertexHandle<VertexPose>> poses;
    for (int k = 0; k < kPoses; ++k)
      poses.push_back(problem.AddVertex(
          VertexPose{Pose(so3::ExpQuaternion(Vector3::Zero()), Vector3(0.3 * k, 0.0, 0.0))}));
    ASSERT_TRUE(problem.SetFixed(poses[0]).ok());
    for (const int host : first) {
      const Vector3 x(0.3 * host + Normal(engine, 1.0), Normal(engine, 1.0), 5.0);
      const VertexHandle<VertexPointXYZ> point = problem.AddVertex(VertexPointXYZ(x));
      for (int k = host; k < host + kViews; ++k) {
        const Vector3 offset(x - Vector3(0.3 * k, 0.0, 0.0));
        ASSERT_TRUE(
            problem.AddEdge(OffsetInPacks{offset, 1.0}, {poses[static_cast<std::size_t>(k)], point})
                .ok());
      }
    }
    const SolveSummary summary = problem.Solve({.max_iterations = 1});
    ASSERT_TRUE(summary.ok()) << summary.status.message();
    ASSERT_EQ(summary.edges.size(), 1u);
    EXPECT_EQ(summary.edges[0].in_packs, kLandmarks * kViews);
    EXPECT_GT(summary.edges[0].in_packs, 0.85 * static_cast<double>(summary.edges[0].lanes))
        << (shuffled ? "shuffled" : "in order");
  }
}

/// RangeInPacks without its Jacobians.
struct RangeOfResidual {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  static constexpr auto kLanes = Fields(&RangeOfResidual::measured);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const T& range, Vec<T, 1>& r) const {
    using std::sqrt;
    const Vec<T, 3> x = point.p - pose.p;
    const T distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (distance == T(0.0)) return false;
    r[0] = distance - range;
    return true;
  }
};

TEST(LandmarkRuns, EdgesWithoutJacobiansAreThoseWithJacobians) {
  const auto make = [](auto edge) {
    std::mt19937 engine(11);
    Problem problem;
    std::vector<VertexHandle<VertexPose>> poses;
    for (int k = 0; k < 4; ++k) {
      const Vector3 phi(Normal(engine, 0.3), Normal(engine, 0.3), Normal(engine, 0.3));
      const Vector3 p(0.5 * k, Normal(engine, 0.2), Normal(engine, 0.2));
      poses.push_back(problem.AddVertex(VertexPose{Pose(so3::ExpQuaternion(phi), p)}));
    }
    for (int l = 0; l < 21; ++l) {
      const VertexHandle<VertexPointXYZ> point = problem.AddVertex(
          VertexPointXYZ(Normal(engine, 2.0), Normal(engine, 2.0), 5.0 + Normal(engine, 0.5)));
      for (const VertexHandle<VertexPose>& pose : poses) {
        edge.measured = 5.0 + Normal(engine, 0.5);
        EXPECT_TRUE(problem.AddEdge(edge, {pose, point}).ok());
      }
    }
    EXPECT_TRUE(problem.MakeHessian().ok());
    return problem;
  };
  const Problem by_hand = make(RangeInPacks{}), found = make(RangeOfResidual{});
  const Eigen::MatrixXd H = by_hand.Hessian();
  const Eigen::VectorXd b = by_hand.Rhs();
  ASSERT_EQ(found.Hessian().rows(), H.rows());
  EXPECT_LT((found.Hessian() - H).cwiseAbs().maxCoeff(), 1e-12 * H.cwiseAbs().maxCoeff());
  EXPECT_LT((found.Rhs() - b).cwiseAbs().maxCoeff(), 1e-12 * b.cwiseAbs().maxCoeff());
}

/// Derives from a template edge, and has an Evaluate of its own; or has not.
struct HalfRange : RangeInPacks {
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector<1>& r,
                Jacobian<1, 6>* d_pose, Jacobian<1, 3>* d_point) const {
    const bool ok = internal::EvaluateInDouble(static_cast<const RangeInPacks&>(*this),
                                               std::tie(pose, point), r, d_pose, d_point);
    r *= 0.5;
    if (d_pose) *d_pose *= 0.5;
    if (d_point) *d_point *= 0.5;
    return ok;
  }
};
struct OtherRange : RangeInPacks {};

TEST(LandmarkRuns, AnEdgeThatDerivesFromATemplateEdgeHasItsOwnEvaluate) {
  static_assert(!kEvaluatesInPacks<HalfRange> && kEvaluatesInPacks<OtherRange>);
  Problem problem;
  const VertexHandle<VertexPose> pose = problem.AddVertex(VertexPose{});
  for (int k = 0; k < 9; ++k) {
    const VertexHandle<VertexPointXYZ> point = problem.AddVertex(VertexPointXYZ(1.0 + k, 0.0, 0.0));
    ASSERT_TRUE(problem.AddEdge(HalfRange{{k + 3.0}}, {pose, point}).ok());
    ASSERT_TRUE(problem.AddEdge(OtherRange{{k + 2.0}}, {pose, point}).ok());
  }
  ASSERT_TRUE(problem.MakeHessian().ok());
  EXPECT_NEAR(problem.Rhs()[0], 9 * -0.5 + 9 * -1.0, 1e-13);
  EXPECT_NEAR(problem.Solve({.max_iterations = 0}).initial_cost, 18 * 0.5, 1e-13);
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
