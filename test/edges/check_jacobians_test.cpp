// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The checker itself: edges with one fault each must be found, and the fault be named.
#include "glissade/testing/check_jacobians.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "glissade/lie/so3.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/vector.h"

namespace glissade {
namespace {

enum class Fault {
  kNone,
  kSlightlyWrong,
  kWrongSign,
  kUnwrittenEntry,
  kUnwrittenResidual,
  kResidualDependsOnJacobians,
  kJacobianDependsOnOthers,
  kReturnsFalse,
};

/// r = [x0 y, sin(x1) + exp(y)].
template <Fault fault>
struct EdgeWithFault {
  using Vertices = VertexList<VertexVector<2>, VertexVector<1>>;
  static constexpr int kResidualDim = 2;

  bool Evaluate(const VertexVector<2>& x, const VertexVector<1>& y, Vector<2>& r,
                Jacobian<2, 2>* d_r_d_x, Jacobian<2, 1>* d_r_d_y) const {
    const double x0 = x.value[0], x1 = x.value[1], y0 = y.value[0];
    r[0] = x0 * y0;
    if (fault != Fault::kUnwrittenResidual) r[1] = std::sin(x1) + std::exp(y0);
    if (fault == Fault::kResidualDependsOnJacobians && d_r_d_x) r[0] += 1.0;
    if (d_r_d_x) {
      (*d_r_d_x)(0, 0) = y0;
      (*d_r_d_x)(0, 1) = 0.0;
      if (fault != Fault::kUnwrittenEntry) (*d_r_d_x)(1, 0) = 0.0;
      (*d_r_d_x)(1, 1) = std::cos(x1) * (fault == Fault::kSlightlyWrong ? 1.0 + 2e-7 : 1.0);
    }
    if (d_r_d_y) {
      *d_r_d_y << x0, std::exp(y0);
      if (fault == Fault::kWrongSign) (*d_r_d_y)(1, 0) *= -1.0;
      if (fault == Fault::kJacobianDependsOnOthers && !d_r_d_x) d_r_d_y->setZero();
    }
    return fault != Fault::kReturnsFalse;
  }
};

template <Fault fault>
JacobianCheck Check(const JacobianCheckOptions& options = {}) {
  return CheckJacobians(EdgeWithFault<fault>{}, VertexVector<2>{{0.7, -0.4}},
                        VertexVector<1>{{1.3}}, options);
}

TEST(CheckJacobians, AcceptsACorrectEdgeWithRoomToSpare) {
  const JacobianCheck check = Check<Fault::kNone>();
  EXPECT_TRUE(check.ok) << check.message;
  EXPECT_LT(check.worst_error, 1e-10);
  EXPECT_TRUE(check.message.empty());
}

TEST(CheckJacobians, NamesTheWrongEntry) {
  const JacobianCheck check = Check<Fault::kWrongSign>();
  EXPECT_FALSE(check);
  EXPECT_EQ(check.vertex, 1);
  EXPECT_EQ(check.row, 1);
  EXPECT_EQ(check.column, 0);
  EXPECT_NEAR(check.analytic, -check.numeric, 1e-9);
}

TEST(CheckJacobians, ToleranceIsAnOption) {
  EXPECT_FALSE(Check<Fault::kSlightlyWrong>().ok);
  EXPECT_TRUE(Check<Fault::kSlightlyWrong>({.tolerance = 1e-6}).ok);
}

TEST(CheckJacobians, FindsWhatIsNotWritten) {
  EXPECT_NE(Check<Fault::kUnwrittenEntry>().message.find("entry (1, 0)"), std::string::npos);
  EXPECT_NE(Check<Fault::kUnwrittenResidual>().message.find("residual 1"), std::string::npos);
}

TEST(CheckJacobians, FindsOutputsThatDependOnEachOther) {
  EXPECT_NE(Check<Fault::kResidualDependsOnJacobians>().message.find("without Jacobians"),
            std::string::npos);
  EXPECT_NE(Check<Fault::kJacobianDependsOnOthers>().message.find("alone"), std::string::npos);
}

TEST(CheckJacobians, NeedsAPointWithAValue) {
  EXPECT_NE(Check<Fault::kReturnsFalse>().message.find("returned false"), std::string::npos);
}

enum class PackFault { kNone, kReadsTheMember, kWrongJacobian, kWrongResidual };

/// The form in packs, with faults that one edge alone does not have.
template <PackFault fault>
struct EdgeInPacks {
  using Vertices = VertexList<VertexVector<5>, VertexVector<2>>;
  static constexpr int kResidualDim = 1;
  double measured = 0.3;
  static constexpr auto kLanes = Fields(&EdgeInPacks::measured);

  template <class T>
  bool Evaluate(const View<VertexVector<5>, T>& x, const View<VertexVector<2>, T>& y, const T& at,
                Vec<T, 1>& r, Mat<T, 1, 5>* d_x, Mat<T, 1, 2>* d_y) const {
    constexpr bool kPacks = !std::is_same_v<T, double>;
    const T factor = kPacks && fault == PackFault::kWrongResidual ? T(1.0 + 1e-9) : T(1.0);
    r[0] = factor * x[0] * y[0] + y[1] - (fault == PackFault::kReadsTheMember ? T(measured) : at);
    T bend = T(0.0);
    if (y[0] > T(1.3)) {  // not so in all lanes
      bend = y[0] - T(1.3);
      r[0] += bend * bend;
    }
    if (d_x) *d_x = {{y[0], T(0.0), T(0.0), T(0.0), T(0.0)}};
    if (d_y) {
      const T sign = T(kPacks && fault == PackFault::kWrongJacobian ? -1.0 : 1.0);
      *d_y = {{sign * x[0] + T(2.0) * bend, T(1.0)}};
    }
    return true;
  }
};

template <PackFault fault>
JacobianCheck Check() {
  return CheckJacobians(EdgeInPacks<fault>{}, VertexVector<5>{{0.7, -0.4, 0.1, 0.2, 0.3}},
                        VertexVector<2>{{1.3002, 0.4}}, JacobianCheckOptions{.step = 1e-3});
}

TEST(CheckJacobians, ChecksTheFormInPacksToo) {
  const JacobianCheck check = Check<PackFault::kNone>();
  EXPECT_TRUE(check.ok) << check.message;
  EXPECT_NE(Check<PackFault::kReadsTheMember>().message.find("the residual in packs"),
            std::string::npos);
  EXPECT_NE(Check<PackFault::kWrongResidual>().message.find("the residual in packs"),
            std::string::npos);
  EXPECT_NE(Check<PackFault::kWrongJacobian>().message.find("Jacobian 1: in packs"),
            std::string::npos);
}

/// A Jacobian that is the difference of two terms nearly equal, rounded otherwise in packs than in
/// one edge, or alone than with the others: what contraction to FMA makes of it.
template <bool kAlone>
struct EdgeOfDifference {
  using Vertices = VertexList<VertexVector<1>, VertexVector<1>>;
  static constexpr int kResidualDim = 1;
  static constexpr double kSmall = 1.23456789e-6;
  double measured = 0.0;
  static constexpr auto kLanes = Fields(&EdgeOfDifference::measured);

  template <class T>
  bool Evaluate(const View<VertexVector<1>, T>& x, const View<VertexVector<1>, T>& y, const T& at,
                Vec<T, 1>& r, Mat<T, 1, 1>* d_x, Mat<T, 1, 1>* d_y) const {
    r[0] = x[0] + T(kSmall) * y[0] - at;
    if (d_x) *d_x = {{T(1.0)}};
    if (d_y) {
      const bool rounds = std::is_same_v<T, double> && (!kAlone || d_x != nullptr);
      *d_y = {{rounds ? T((1.0 + kSmall) - 1.0) : T(kSmall)}};
    }
    return true;
  }
};

TEST(CheckJacobians, RoundingOfTermsThatCancelIsNoFault) {
  constexpr double kSmall = EdgeOfDifference<false>::kSmall;
  EXPECT_GT(std::abs((1.0 + kSmall) - 1.0 - kSmall), 1e-11 * kSmall);
  const VertexVector<1> x{{1e-3}}, y{{2.0}};
  const JacobianCheck packs = CheckJacobians(EdgeOfDifference<false>{}, x, y);
  EXPECT_TRUE(packs.ok) << packs.message;
  const JacobianCheck alone = CheckJacobians(EdgeOfDifference<true>{}, x, y);
  EXPECT_TRUE(alone.ok) << alone.message;
}

/// A residual whose terms in y cancel: what its differences have is the rounding of the terms.
struct EdgeOfTermsThatCancel {
  using Vertices = VertexList<VertexVector<1>, VertexVector<1>>;
  static constexpr int kResidualDim = 1;
  double factor = 1.0;
  bool Evaluate(const VertexVector<1>& x, const VertexVector<1>& y, Vector<1>& r,
                Jacobian<1, 1>* d_x, Jacobian<1, 1>* d_y) const {
    r[0] = x.value[0] + factor * y.value[0] - y.value[0];
    if (d_x) (*d_x)(0, 0) = 1.0;
    if (d_y) (*d_y)(0, 0) = factor - 1.0;
    return true;
  }
};

TEST(CheckJacobians, RoundingOfAResidualWhoseTermsCancelIsNoFault) {
  for (const double left : {1e-7, 1e-8, 1e-9, 1e-10}) {
    const JacobianCheck check = CheckJacobians(EdgeOfTermsThatCancel{1.0 + left},
                                               VertexVector<1>{{0.7}}, VertexVector<1>{{2.3}});
    EXPECT_TRUE(check.ok) << check.message;
  }
}

/// Central differences at h = 1e-6 alone would miss by more than 1e-7 here.
struct EdgeLargeNumbers {
  using Vertices = VertexList<VertexVector<1>>;
  static constexpr int kResidualDim = 1;
  bool Evaluate(const VertexVector<1>& x, Vector<1>& r, Jacobian<1, 1>* d_r_d_x) const {
    r[0] = 1e6 + std::sin(3.0 * x.value[0]);
    if (d_r_d_x) (*d_r_d_x)(0, 0) = 3.0 * std::cos(3.0 * x.value[0]);
    return true;
  }
};

TEST(CheckJacobians, ExtrapolationReachesWhatAPlainDifferenceDoesNot) {
  const VertexVector<1> x{{0.3}};
  const double h = 1e-6;
  const double plain = ((1e6 + std::sin(0.9 + 3 * h)) - (1e6 + std::sin(0.9 - 3 * h))) / (2 * h);
  EXPECT_GT(std::abs(plain / (3.0 * std::cos(0.9)) - 1.0), 1e-7);
  const JacobianCheck check = CheckJacobians(EdgeLargeNumbers{}, x);
  EXPECT_TRUE(check.ok) << check.message;
}

/// Says that it knows its poses by their relative pose, and looks at their mean.
struct MeanOfPoses {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 1;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  bool Evaluate(const VertexPose& a, const VertexPose& b, const VertexInverseDepth& depth,
                Vector<1>& r, Jacobian<1, 6>* d_a, Jacobian<1, 6>* d_b,
                Jacobian<1, 1>* d_rho) const {
    r[0] = 0.5 * (a.pose.p()[0] + b.pose.p()[0]) - depth.rho;
    if (d_a != nullptr) *d_a << 0.5, 0.0, 0.0, 0.0, 0.0, 0.0;
    if (d_b != nullptr) *d_b << 0.5, 0.0, 0.0, 0.0, 0.0, 0.0;
    if (d_rho != nullptr) *d_rho << -1.0;
    return true;
  }
};

TEST(CheckJacobians, AFirstEstimateRuleThatIsNotSoIsFound) {
  const VertexPose a{Pose(so3::ExpQuaternion(Vector3(0.1, 0.2, 0.3)), Vector3(1.0, 2.0, 3.0))};
  const VertexPose b{Pose(so3::ExpQuaternion(Vector3(0.3, 0.1, 0.2)), Vector3(2.0, 2.0, 3.0))};
  const JacobianCheck check = CheckJacobians(MeanOfPoses{}, a, b, VertexInverseDepth{0.3});
  EXPECT_FALSE(check.ok);
  EXPECT_NE(check.message.find("kFirstEstimateRule"), std::string::npos) << check.message;
}

}  // namespace
}  // namespace glissade
