// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/sparse_cholesky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace glissade {
namespace {

/// A block system with its own storage.
struct System {
  std::vector<std::int32_t> offsets{0};
  std::vector<BlockIndex> pattern;
  std::vector<double> S, b;
  int stride = 0;

  [[nodiscard]] ReducedSystem View(std::uint64_t version) const {
    ReducedSystem view;
    view.size = offsets.back();
    view.offsets = offsets;
    view.S = S.data();
    view.stride = stride;
    view.b = b.data();
    view.pattern = pattern;
    view.pattern_version = version;
    return view;
  }
};

template <class Connected>
System Make(const std::vector<int>& dims, Connected&& connected, unsigned seed) {
  System system;
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return 2.0 * static_cast<double>(engine() >> 11) * 0x1.0p-53 - 1.0; };
  for (const int dim : dims)
    system.offsets.push_back(system.offsets.back() + dim);
  const int n = system.offsets.back();
  system.stride = (n + 7) / 8 * 8;
  system.S.assign(static_cast<std::size_t>(system.stride) * static_cast<std::size_t>(n), 0.0);
  const auto at = [&](int r, int c) -> double& {
    return system.S[static_cast<std::size_t>(r) +
                    static_cast<std::size_t>(c) * static_cast<std::size_t>(system.stride)];
  };
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(dims.size()); ++i) {
    for (std::int32_t j = 0; j <= i; ++j) {
      if (i != j && !connected(i, j)) continue;
      system.pattern.push_back({i, j});
      const auto row = static_cast<std::size_t>(i), col = static_cast<std::size_t>(j);
      for (int r = system.offsets[row]; r < system.offsets[row + 1]; ++r) {
        for (int c = system.offsets[col]; c < system.offsets[col + 1] && c <= r; ++c) {
          at(r, c) = uniform();
        }
      }
    }
  }
  for (int k = 0; k < n; ++k) {
    at(k, k) = 2.0 * std::sqrt(n) + 5.0;
    system.b.push_back(uniform());
  }
  return system;
}

void ExpectSolves(const System& system, SparseCholeskySolver* solver, std::uint64_t version) {
  const ReducedSystem view = system.View(version);
  const auto n = static_cast<std::size_t>(view.size);
  std::vector<double> x(n, NAN), y(n), product(n);
  ASSERT_TRUE(solver->Solve(view, x.data()).ok);
  DenseCholeskySolver dense;
  ASSERT_TRUE(dense.Solve(view, y.data()).ok);
  view.Multiply(x.data(), product.data());
  for (std::size_t k = 0; k < n; ++k) {
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

TEST(SparseCholesky, EmptyPatternMeansDense) {
  System system = Window(5, true, 2);
  for (std::size_t k = 0; k < system.S.size(); ++k) {
    if (system.S[k] == 0.0) system.S[k] = 1e-3;
  }
  system.pattern.clear();
  SparseCholeskySolver solver;
  ExpectSolves(system, &solver, 1);
}

TEST(SparseCholesky, WorksLessOnLongWindows) {
  SparseCholeskySolver solver;
  const System window = Window(50, true, 1);
  solver.Analyze(window.View(1));
  EXPECT_LT(solver.FlopRatio(), 0.05);
  const System small = Window(8, false, 1);  // everything sees everything
  solver.Analyze(small.View(2));
  EXPECT_GT(solver.FlopRatio(), 0.9);
}

TEST(SparseCholesky, NamesThePivotThatFails) {
  for (const int bad : {0, 7, 31, 100, 149}) {
    System system = Window(10, true, 3);
    system.S[static_cast<std::size_t>(bad) * static_cast<std::size_t>(system.stride + 1)] = -1e6;
    SparseCholeskySolver solver;
    std::vector<double> x(system.b.size());
    const LinearSolverResult result = solver.Solve(system.View(1), x.data());
    EXPECT_FALSE(result.ok);
    EXPECT_EQ(result.failed_pivot, bad);
  }
}

}  // namespace
}  // namespace glissade
