// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/sparse_cholesky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/matrix_operator.h"

namespace glissade {
namespace {

struct System {
  std::vector<int> dims;
  std::vector<BlockIndex> pattern;
  Eigen::MatrixXd S;
  Eigen::VectorXd b;

  [[nodiscard]] test::MatrixOperator Operator(std::uint64_t version) const {
    return {S, dims, pattern, version};
  }
};

template <class Connected>
System Make(const std::vector<int>& dims, Connected&& connected, unsigned seed) {
  System system;
  system.dims = dims;
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return 2.0 * static_cast<double>(engine() >> 11) * 0x1.0p-53 - 1.0; };
  std::vector<int> offsets{0};
  for (const int dim : dims)
    offsets.push_back(offsets.back() + dim);
  const int n = offsets.back();
  system.S = Eigen::MatrixXd::Zero(n, n);
  for (std::int32_t j = 0; j < static_cast<std::int32_t>(dims.size()); ++j) {
    for (std::int32_t i = j; i < static_cast<std::int32_t>(dims.size()); ++i) {
      if (i != j && !connected(i, j)) continue;
      system.pattern.push_back({i, j});
      const auto row = static_cast<std::size_t>(i), col = static_cast<std::size_t>(j);
      for (int r = offsets[row]; r < offsets[row + 1]; ++r) {
        for (int c = offsets[col]; c < offsets[col + 1] && c <= r; ++c)
          system.S(r, c) = uniform();
      }
    }
  }
  system.b.resize(n);
  for (int k = 0; k < n; ++k) {
    system.S(k, k) = 2.0 * std::sqrt(n) + 5.0;
    system.b[k] = uniform();
  }
  return system;
}

void ExpectSolves(const System& system, SparseCholeskySolver* solver, std::uint64_t version) {
  test::MatrixOperator S = system.Operator(version);
  const Eigen::Index n = system.b.size();
  Eigen::VectorXd x = Eigen::VectorXd::Constant(n, NAN), y = x, product = x;
  ASSERT_TRUE(test::SolveWith(*solver, S, system.b.data(), x.data()).ok);
  DenseCholeskySolver dense;
  ASSERT_TRUE(test::SolveWith(dense, S, system.b.data(), y.data()).ok);
  S.Multiply(x.data(), product.data());
  for (Eigen::Index k = 0; k < n; ++k) {
    ASSERT_NEAR(x[k], y[k], 1e-13);
    ASSERT_NEAR(product[k], system.b[k], 1e-13);
  }
}

std::vector<int> WindowDims(int keyframes, bool inertial) {
  std::vector<int> dims(static_cast<std::size_t>(keyframes), 6);
  if (inertial) dims.insert(dims.end(), static_cast<std::size_t>(keyframes), 9);
  return dims;
}

System Window(int keyframes, bool inertial, unsigned seed) {
  return Make(
      WindowDims(keyframes, inertial),
      [=](int i, int j) {
        const int distance = std::abs(i % keyframes - j % keyframes);
        return i < keyframes && j < keyframes ? distance <= 7 : distance <= 1;
      },
      seed);
}

TEST(SparseCholesky, WindowsOfManySizes) {
  SparseCholeskySolver solver;  // one for all: the symbolic part must follow the pattern
  std::uint64_t version = 0;
  for (const int keyframes : {1, 2, 3, 5, 8, 9, 10, 20, 50, 70}) {
    for (const bool inertial : {false, true}) {
      SCOPED_TRACE(std::to_string(keyframes) + (inertial ? " inertial" : ""));
      const System system = Window(keyframes, inertial, 1);
      ExpectSolves(system, &solver, ++version);
      ExpectSolves(system, &solver, version);  // kept symbolic part
    }
  }
}

TEST(SparseCholesky, RandomPatternsWithBlocksOfAnySize) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 engine(seed);
    const auto below = [&](unsigned n) { return static_cast<int>(engine() % n); };
    std::vector<int> dims;
    for (int k = 1 + below(40); k > 0; --k)
      dims.push_back(1 + below(15));
    const int density = 1 + below(30);
    const System system = Make(
        dims, [&](int, int) { return below(100) < density; }, seed);
    SparseCholeskySolver solver;
    ExpectSolves(system, &solver, 1);
  }
}

TEST(SparseCholesky, SeveralRightHandSides) {
  const System system = Window(12, true, 2);
  test::MatrixOperator S = system.Operator(1);
  SparseCholeskySolver solver;
  S.SetForm(solver.Form(S.all_blocks()));
  ASSERT_TRUE(solver.Prepare(S).ok);
  Eigen::VectorXd x(system.b.size()), product(system.b.size());
  for (int k = 1; k <= 3; ++k) {
    const Eigen::VectorXd b = k * system.b + Eigen::VectorXd::Constant(system.b.size(), k);
    ASSERT_TRUE(solver.Solve(S, b.data(), x.data(), {}).ok);
    S.Multiply(x.data(), product.data());
    EXPECT_LT((product - b).norm(), 1e-13 * b.norm());
  }
}

TEST(SparseCholesky, WorksLessOnLongWindows) {
  SparseCholeskySolver solver;
  const System window = Window(50, true, 1);
  solver.Analyze(window.Operator(1).all_blocks());
  EXPECT_LT(solver.FlopRatio(), 0.05);
  const System small = Window(8, false, 1);  // everything sees everything
  solver.Analyze(small.Operator(2).all_blocks());
  EXPECT_GT(solver.FlopRatio(), 0.9);
}

TEST(SparseCholesky, NamesThePivotThatFails) {
  for (const int bad : {0, 7, 31, 100, 149}) {
    System system = Window(10, true, 3);
    system.S(bad, bad) = -1e6;
    SparseCholeskySolver solver;
    const LinearSolverResult result = solver.Prepare(system.Operator(1));
    EXPECT_FALSE(result.ok);
    EXPECT_EQ(result.failed_pivot, bad);
  }
}

}  // namespace
}  // namespace glissade
