// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course's PCG never applied its first search direction (x += alpha p stood in its loop only):
// on diag(1, 2, 3) x = b, which one preconditioned step solves, it returns 0.
#include <gtest/gtest.h>

#include "regression/course_support.h"

namespace glissade {
namespace {

/// A system of one block with the given matrix.
struct System {
  Eigen::MatrixXd S;
  Eigen::VectorXd b;
  std::vector<std::int32_t> offsets{0, static_cast<std::int32_t>(b.size())};

  [[nodiscard]] ReducedSystem View() const {
    ReducedSystem view;
    view.size = static_cast<int>(b.size());
    view.offsets = offsets;
    view.S = S.data();
    view.stride = static_cast<int>(S.rows());
    view.b = b.data();
    return view;
  }
};

/// The check: |S x - b| <= 1e-6 |b|.
bool Solves(LinearSolver& solver, const System& system) {
  Eigen::VectorXd x = Eigen::VectorXd::Constant(system.b.size(), 7.0);
  if (!solver.Solve(system.View(), x.data()).ok) return false;
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
      PcgSolver ours({.preconditioner = preconditioner});
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
  defective.Solve(system.View(), x.data());
  EXPECT_EQ(x, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace glissade
