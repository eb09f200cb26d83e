// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course's PCG never applied its first search direction (x += alpha p stood in its loop only):
// on diag(1, 2, 3) x = b, which one preconditioned step solves, it returns 0.
#include <gtest/gtest.h>

#include "glissade/linear/pcg.h"
#include "regression/course_support.h"
#include "support/matrix_operator.h"

namespace glissade {
namespace {

using test::MatrixOperator;
using test::SolveWith;

struct System {
  Eigen::MatrixXd S;
  Eigen::VectorXd b;

  /// Of one block.
  [[nodiscard]] MatrixOperator Operator() const { return {S, {static_cast<int>(b.size())}}; }
};

/// The check: |S x - b| <= 1e-6 |b|.
bool Solves(LinearSolver& solver, const System& system) {
  Eigen::VectorXd x = Eigen::VectorXd::Constant(system.b.size(), 7.0);
  MatrixOperator S = system.Operator();
  if (!SolveWith(solver, S, system.b.data(), x.data()).ok) return false;
  return (system.S * x - system.b).norm() <= 1.001e-6 * system.b.norm();
}

System Diagonal() {
  return {Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Vector3d(1, -2, 5)};
}

System Dense() {
  Eigen::MatrixXd A(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j)
      A(i, j) = std::sin(1.0 + 3.0 * i + 7.0 * j * j);
  }
  Eigen::VectorXd b(6);
  b << 1, -2, 3, -4, 5, -6;
  return {A * A.transpose() + Eigen::MatrixXd::Identity(6, 6), b};
}

TEST(PcgFirstStep, IsApplied) {
  for (const System& system : {Diagonal(), Dense()}) {
    for (auto preconditioner : {Preconditioner::kJacobi, Preconditioner::kBlockJacobi}) {
      PcgSolver ours(PcgSolver::Schur::kExplicit, preconditioner);
      EXPECT_TRUE(Solves(ours, system));
    }
    DenseCholeskySolver direct;
    EXPECT_TRUE(Solves(direct, system));
    test::TextbookPcg mended(false);
    EXPECT_TRUE(Solves(mended, system));
    test::TextbookPcg defective(true);
    EXPECT_FALSE(Solves(defective, system));
  }
}

TEST(PcgFirstStep, DefectReturnsZeroOnADiagonal) {
  const System system = Diagonal();
  Eigen::Vector3d x(7, 7, 7);
  test::TextbookPcg defective(true);
  MatrixOperator S = system.Operator();
  SolveWith(defective, S, system.b.data(), x.data());
  EXPECT_EQ(x, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace glissade
