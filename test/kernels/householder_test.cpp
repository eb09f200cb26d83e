// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/random_states.h"
#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

/// Products of columns are what an orthogonal transformation keeps.
TEST(HouseholderColumn, KeepsProductsOfColumnsAndClearsItsOwn) {
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    const KernelTable* table = KernelsFor(isa);
    if (table == nullptr) continue;
    for (const int rows : {1, 2, 3, 9, 40}) {
      for (const int cols : {1, 5, 8, 23, 57, 63, 64, 65, 120, 127, 128, 151, 176}) {
        for (const int col : {0, 1, 7, 8, 17, 70}) {
          if (col >= cols) continue;
          const int stride = (cols + 7) / 8 * 8;
          test::Random random(static_cast<std::uint64_t>(rows * 1000 + cols));
          std::vector<double> a(static_cast<std::size_t>(rows * stride), 0.0);
          for (int i = 0; i < rows; ++i) {
            for (int j = col; j < cols; ++j)
              a[static_cast<std::size_t>(i * stride + j)] = random.Uniform(-1, 1);
          }
          const std::vector<double> before = a;
          std::vector<double> v(static_cast<std::size_t>(rows));
          const double pivot =
              table->householder_column(rows, col, cols, a.data(), stride, v.data());
          const auto at = [&](const std::vector<double>& x, int i, int j) {
            return x[static_cast<std::size_t>(i * stride + j)];
          };
          EXPECT_EQ(pivot, at(a, 0, col));
          for (int i = 1; i < rows; ++i)
            EXPECT_EQ(at(a, i, col), 0.0);
          for (int j = 0; j < cols; ++j) {
            for (const int k : {col, j, cols - 1}) {
              double expected = 0.0, actual = 0.0;
              for (int i = 0; i < rows; ++i) {
                expected += at(before, i, j) * at(before, i, k);
                actual += at(a, i, j) * at(a, i, k);
              }
              EXPECT_NEAR(actual, expected, 1e-13 * rows)
                  << table->name << ": " << rows << " x " << cols << " at " << col << ", columns "
                  << j << ", " << k;
            }
          }
        }
      }
    }
  }
}

TEST(HouseholderColumn, AColumnThatIsZeroBelowIsLeftAlone) {
  const int stride = 8;
  std::vector<double> a(3 * stride, 0.0), v(3);
  a[2] = -0.5;
  a[3] = 1.0;
  a[stride + 3] = 2.0;
  const std::vector<double> before = a;
  EXPECT_EQ(Kernels().householder_column(3, 2, 4, a.data(), stride, v.data()), -0.5);
  EXPECT_EQ(a, before);
}

}  // namespace
}  // namespace glissade::kernels
