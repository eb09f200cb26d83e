// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/nees.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "eval_test_util.h"
#include "glissade/eval/chi_square.h"

namespace glissade::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Quantiles at 1e-10, 0.025, 0.5, 0.95 and 0.999, computed with mpmath to 40 digits.
struct Quantiles {
  int dof;
  double at[5];
};
constexpr double kProbabilities[5] = {1e-10, 0.025, 0.5, 0.95, 0.999};
constexpr Quantiles kTable[] = {
    {1,
     {1.5707963267948967337e-20, 0.0009820691171752560214, 0.45493642311957275194,
      3.8414588206941244691, 10.827566170662730649}},
    {2,
     {2.0000000001000000729e-10, 0.050635615968579753654, 1.3862943611198906188,
      5.9914645471079802105, 13.815510557964272328}},
    {3,
     {5.2093976214344803303e-7, 0.21579528262389787679, 2.3659738843753382661,
      7.8147279032511779735, 16.266236196238129033}},
    {6,
     {0.0016872211249694548861, 1.2373442457912026001, 5.3481206274471206358, 12.591587243743977053,
      22.45774448482532314}},
    {15,
     {0.33828983390917300362, 6.2621377950432511997, 14.338859510956646872, 24.99579013972862708,
      37.697298218353825263}},
    {30,
     {3.0430403795533462328, 16.790772265566625064, 29.336031516661585933, 43.772971825742183683,
      59.703064304429927656}},
    {31,
     {3.308336168365616024, 17.53873858147548763, 30.335942458198119418, 44.98534328036513136,
      61.09830608105811666}},
    {32,
     {3.5825121361638513043, 18.290764907283047224, 31.33585908863449996, 46.194259520278466217,
      62.487219057088492867}},
    {100,
     {34.399823909124818271, 74.221927474923726324, 99.334129235988455754, 124.34211340400407469,
      149.44925277903870637}},
    {1800,
     {1444.2219006214043947, 1684.3077769870158864, 1799.3333772468887547, 1899.8150982441593838,
      1991.1273453299306674}},
    {100000,
     {97181.379818053887296, 99125.373300647351513, 99999.333334123462559, 100736.73617731899935,
      101387.69553252945475}},
};

TEST(ChiSquare, QuantilesOfATable) {
  for (const Quantiles& row : kTable) {
    for (int k = 0; k < 5; ++k) {
      const auto x = ChiSquareQuantile(kProbabilities[k], row.dof);
      ASSERT_TRUE(x.ok());
      EXPECT_NEAR(*x / row.at[k], 1.0, 1e-13) << row.dof << " " << kProbabilities[k];
      EXPECT_NEAR(ChiSquareCdf(row.at[k], row.dof) / kProbabilities[k], 1.0, 1e-12) << row.dof;
      EXPECT_NEAR(ChiSquareTail(row.at[k], row.dof) / (1.0 - kProbabilities[k]), 1.0, 1e-12);
    }
  }
}

TEST(ChiSquare, ClosedForms) {
  for (const double x : {1e-12, 0.1, 1.0, 2.0, 5.0, 30.0, 700.0}) {
    EXPECT_NEAR(ChiSquareCdf(x, 1), std::erf(std::sqrt(0.5 * x)), 1e-14);
    EXPECT_NEAR(ChiSquareTail(x, 1) / std::erfc(std::sqrt(0.5 * x)), 1.0, 2e-13);
    EXPECT_NEAR(ChiSquareCdf(x, 2) / -std::expm1(-0.5 * x), 1.0, 1e-13);
    EXPECT_NEAR(ChiSquareTail(x, 2) / std::exp(-0.5 * x), 1.0, 2e-13);
    const double h = 0.5 * x;
    EXPECT_NEAR(ChiSquareTail(x, 6) / (std::exp(-h) * (1 + h + h * h / 2)), 1.0, 2e-13);
  }
}

TEST(ChiSquare, QuantileInvertsTheDistribution) {
  for (const int dof : {1, 2, 5, 14, 29, 33, 200, 5000, 1000000, 2000000000}) {
    double before = 0.0;
    for (const double p :
         {1e-300, 1e-20, 1e-3, 0.1, 0.4999, 0.5, 0.5001, 0.9, 0.999999, 1 - 1e-15}) {
      const auto x = ChiSquareQuantile(p, dof);
      ASSERT_TRUE(x.ok());
      if (dof == 1 && p < 1e-200) continue;  // below the least double
      EXPECT_GT(*x, before) << dof << " " << p;
      before = *x;
      // A rounding of x is so many of p, as steep as the distribution is there.
      const double steepness =
          std::sqrt(dof) * (1.0 + std::sqrt(-2.0 * std::log(std::min(p, 0.5))));
      EXPECT_NEAR(ChiSquareCdf(*x, dof) / p, 1.0, 1e-12 + 3e-16 * steepness) << dof << " " << p;
    }
  }
}

TEST(ChiSquare, Borders) {
  EXPECT_EQ(ChiSquareCdf(0.0, 3), 0.0);
  EXPECT_EQ(ChiSquareCdf(-1.0, 3), 0.0);
  EXPECT_EQ(ChiSquareTail(-kInf, 3), 1.0);
  EXPECT_EQ(ChiSquareCdf(kInf, 3), 1.0);
  EXPECT_EQ(ChiSquareTail(kInf, 3), 0.0);
  EXPECT_EQ(ChiSquareCdf(1e300, 3), 1.0);
  EXPECT_EQ(ChiSquareCdf(5e-324, 3), 0.0);
  EXPECT_TRUE(std::isnan(ChiSquareCdf(kNan, 3)));
  EXPECT_TRUE(std::isnan(ChiSquareCdf(1.0, 0)));
  for (const double p : {0.0, 1.0, -0.1, 1.1, kNan})
    EXPECT_EQ(ChiSquareQuantile(p, 3).status().code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(ChiSquareQuantile(0.5, 0).ok());
}

Eigen::MatrixXd RandomCovariance(Engine& engine, int n) {
  Eigen::MatrixXd A(n, n + 3);
  for (int i = 0; i < n; ++i) {
    // Rows of very different units.
    const double unit = std::pow(10.0, engine.Uniform(-6, 6));
    for (int j = 0; j < n + 3; ++j)
      A(i, j) = Normal(engine, unit);
  }
  return A * A.transpose();
}

TEST(Nees, IsTheQuadraticForm) {
  Engine engine(1);
  for (int n = 1; n <= 15; ++n) {
    const Eigen::MatrixXd P = RandomCovariance(engine, n);
    const Eigen::VectorXd d = P.diagonal().cwiseSqrt();
    Eigen::VectorXd e(n);
    for (int i = 0; i < n; ++i)
      e[i] = Normal(engine, d[i]);
    const Eigen::MatrixXd scaled =
        d.cwiseInverse().asDiagonal() * P * d.cwiseInverse().asDiagonal();
    const Eigen::VectorXd y = e.cwiseQuotient(d);
    const double expected = y.dot(scaled.fullPivLu().solve(y));
    const auto nees = Nees(e, P);
    ASSERT_TRUE(nees.ok()) << nees.status().message();
    EXPECT_NEAR(*nees / expected, 1.0, 1e-9);
  }
  // Fixed sizes and blocks.
  Matrix6 P = Matrix6::Identity();
  P(1, 0) = P(0, 1) = 0.5;
  EXPECT_NEAR(*Nees(Vector3(1, 2, 3), P.topLeftCorner<3, 3>()), 4.0 + 9.0, 1e-14);
}

TEST(Nees, OfManyRunsIsChiSquare) {
  Engine engine(2);
  constexpr int kDof = 6, kRuns = 4000;
  const Eigen::MatrixXd P = RandomCovariance(engine, kDof);
  const Eigen::MatrixXd L = P.llt().matrixL();
  const double median = *ChiSquareQuantile(0.5, kDof), high = *ChiSquareQuantile(0.95, kDof);
  std::vector<double> right, small;
  int below_median = 0, above_high = 0;
  for (int run = 0; run < kRuns; ++run) {
    Eigen::VectorXd z(kDof);
    for (int i = 0; i < kDof; ++i)
      z[i] = Normal(engine, 1.0);
    const Eigen::VectorXd e = L * z;
    right.push_back(*Nees(e, P));
    small.push_back(*Nees(e, P / 1.2));
    below_median += right.back() < median;
    above_high += right.back() > high;
  }
  // Four standard deviations of the binomial distribution.
  EXPECT_NEAR(below_median, 0.5 * kRuns, 4 * std::sqrt(0.25 * kRuns));
  EXPECT_NEAR(above_high, 0.05 * kRuns, 4 * std::sqrt(0.05 * 0.95 * kRuns));
  const auto consistent = SummarizeNees(right, kDof, 0.9999);
  ASSERT_TRUE(consistent.ok());
  EXPECT_TRUE(consistent->Consistent()) << consistent->mean;
  EXPECT_EQ(consistent->runs, kRuns);
  const auto optimistic = SummarizeNees(small, kDof, 0.9999);
  EXPECT_TRUE(optimistic->Optimistic());
  EXPECT_FALSE(optimistic->Consistent());
  EXPECT_NEAR(optimistic->mean, 1.2 * consistent->mean, 1e-9);
}

TEST(Nees, BoundsOfTheMean) {
  // 100 runs of 3 dof: chi-square of 300 dof, 253.912 and 349.874 at 2.5 % and 97.5 %.
  const auto bounds = BoundsOfMeanNees(3, 100, 0.95);
  ASSERT_TRUE(bounds.ok());
  EXPECT_NEAR(bounds->low, 2.53912, 5e-6);
  EXPECT_NEAR(bounds->high, 3.49874, 5e-6);
  EXPECT_FALSE(BoundsOfMeanNees(0, 100).ok());
  EXPECT_FALSE(BoundsOfMeanNees(3, 0).ok());
  EXPECT_FALSE(BoundsOfMeanNees(1 << 16, 1 << 15).ok());
  EXPECT_FALSE(BoundsOfMeanNees(3, 100, 1.0).ok());
  EXPECT_FALSE(BoundsOfMeanNees(3, 100, kNan).ok());
  EXPECT_FALSE(SummarizeNees({}, 3).ok());
  const std::vector<double> with_nan = {1.0, kNan};
  EXPECT_EQ(SummarizeNees(with_nan, 3).status().code(), StatusCode::kNotFinite);
  // How often a mean of uniform draws through the quantile function falls outside: 5 %.
  Engine engine(5);
  int outside = 0;
  const auto ten = BoundsOfMeanNees(3, 10);
  for (int trial = 0; trial < 2000; ++trial) {
    double mean = 0.0;
    for (int run = 0; run < 10; ++run)
      mean += 0.1 * RandomVector(engine, 1.0).squaredNorm();
    outside += mean < ten->low || mean > ten->high;
  }
  EXPECT_NEAR(outside, 100, 4 * std::sqrt(2000 * 0.05 * 0.95));
}

TEST(Nees, Refusals) {
  const Matrix3 I = Matrix3::Identity();
  const Vector3 e(1, 2, 3);
  Matrix3 P = I;
  P(2, 2) = 0.0;
  EXPECT_EQ(Nees(e, P).status().code(), StatusCode::kNotPositive);
  EXPECT_NE(Nees(e, P).status().message().find("coordinate 2"), std::string::npos);
  P = I;
  P(1, 0) = P(0, 1) = 1.0;  // singular
  EXPECT_EQ(Nees(e, P).status().code(), StatusCode::kNotPositive);
  P(1, 0) = P(0, 1) = 1.5;  // indefinite
  EXPECT_EQ(Nees(e, P).status().code(), StatusCode::kNotPositive);
  P = -I;
  EXPECT_EQ(Nees(e, P).status().code(), StatusCode::kNotPositive);
  P = I;
  P(2, 1) = kNan;
  EXPECT_EQ(Nees(e, P).status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(Nees(Vector3(1, kInf, 0), I).status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(Nees(Vector3(1e200, 0, 0), I).status().code(), StatusCode::kNotFinite);
  // Small is not singular.
  EXPECT_NEAR(*Nees(Vector3(1e-150, 0, 0), Matrix3(1e-300 * I)), 1.0, 1e-12);
  const Matrix6 six = Matrix6::Identity();
  EXPECT_EQ(Nees(e, six).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Nees(six, six).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Nees(std::vector<double>{}, std::vector<double>{}).status().code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade::eval
