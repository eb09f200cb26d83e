// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <filesystem>
#include <string>

#include "common/data_dir.h"
#include "common/sanitized.h"
#include "glissade/bridge/ceres.h"
#include "glissade/io/bal.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "support/dense_reference.h"

// Two published problems, against Ceres.

namespace glissade::test {
namespace {

struct BalCase {
  const char* file;
  double start_cost;  ///< as published, seven digits
};

class BalTest : public testing::TestWithParam<BalCase> {
 protected:
  void SetUp() override {
    const std::filesystem::path path = DataDir() / "bal" / GetParam().file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
    const auto bal = ReadBal(path.string());
    ASSERT_TRUE(bal.ok()) << bal.status().message();
    ASSERT_TRUE(AddToGraph(bal.value(), problem_, loss_).ok());
  }

  Loss loss_;
  Problem problem_;
};

/// (J'J + lambda D) dx = -g in units of the columns, by a sparse factorization of all of it, with
/// refinement.
Eigen::VectorXd SparseDampedStep(const bridge::CeresLinearization& ceres, double lambda) {
  const Eigen::SparseMatrix<double> J = ceres.jacobian;
  Eigen::VectorXd diagonal(J.cols());
  for (int c = 0; c < J.cols(); ++c)
    diagonal[c] = J.col(c).squaredNorm();
  const Eigen::VectorXd damping = lambda * diagonal.cwiseMax(1e-6).cwiseMin(1e32);
  const Eigen::VectorXd scale = (diagonal + damping).cwiseSqrt().cwiseInverse();
  const Eigen::SparseMatrix<double> scaled = J * scale.asDiagonal();
  Eigen::SparseMatrix<double> H = scaled.transpose() * scaled;
  for (int c = 0; c < H.cols(); ++c)
    H.coeffRef(c, c) += damping[c] * scale[c] * scale[c];
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(H);
  const Eigen::VectorXd b = -(scale.asDiagonal() * ceres.gradient);
  Eigen::VectorXd x = ldlt.solve(b);
  for (int k = 0; k < 3; ++k)
    x += ldlt.solve(b - H * x);
  return scale.asDiagonal() * x;
}

TEST_P(BalTest, StartCostGradientAndStep) {
  const double cost = problem_.Cost().value();
  EXPECT_NEAR(cost, GetParam().start_cost, 5e-7 * cost);
  ASSERT_TRUE(problem_.MakeHessian().ok());
  const bridge::CeresProblem exported = bridge::Export(problem_);
  const auto ceres = bridge::Linearize(exported, problem_.FreeVertices());
  ASSERT_TRUE(ceres.ok()) << ceres.status().message();
  EXPECT_NEAR(cost, ceres->cost, 1e-12 * cost);
  EXPECT_LT(RelativeError(problem_.Rhs(), -ceres->gradient), 1e-12);
  for (const double lambda : {1e-4, 1e-2}) {
    ASSERT_TRUE(problem_.SolveLinearSystem(lambda).ok());
    EXPECT_LT(RelativeError(problem_.Step(), SparseDampedStep(ceres.value(), lambda)), 1e-9);
  }
}

TEST_P(BalTest, AtLeastAsGoodAsCeresUnderEveryIterationLimit) {
  for (const int limit : {5, 15, 50}) {
    if (kSanitized && limit > 5) break;
    SCOPED_TRACE(std::to_string(limit) + " iterations");
    Problem ours = problem_.Clone();
    SolveOptions options;
    options.max_iterations = limit;
    const SolveSummary& summary = ours.Solve(options);
    ASSERT_TRUE(summary.ok()) << summary.BriefReport();

    Problem theirs = problem_.Clone();
    ceres::Solver::Options ceres_options;
    ceres_options.linear_solver_type = ceres::DENSE_SCHUR;
    ceres_options.max_num_iterations = limit;
    // The same stopping rule; Ceres's default would let it off earlier.
    ceres_options.function_tolerance = options.cost_tolerance;
    ceres_options.parameter_tolerance = options.step_tolerance;
    const ceres::Solver::Summary ceres_summary = bridge::SolveWithCeres(&theirs, ceres_options);
    ASSERT_TRUE(ceres_summary.IsSolutionUsable());
    EXPECT_NEAR(summary.initial_cost, ceres_summary.initial_cost, 1e-12 * summary.initial_cost);
    // Equal steps give costs that differ by rounding.
    EXPECT_LE(summary.final_cost, (1.0 + 1e-11) * ceres_summary.final_cost)
        << summary.BriefReport() << "\n"
        << ceres_summary.BriefReport();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Published, BalTest,
    testing::Values(BalCase{"ladybug-problem-49-7776-pre.txt.gz", 8.509125e5},
                    BalCase{"trafalgar-problem-21-11315-pre.txt.gz", 4.413239e6}),
    [](const auto& info) { return std::string(info.index == 0 ? "Ladybug49" : "Trafalgar21"); });

}  // namespace
}  // namespace glissade::test
