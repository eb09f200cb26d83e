// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Fronts: partial factorization and the solves that go with it, under every instruction set.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

std::vector<const KernelTable*> Tables() {
  std::vector<const KernelTable*> tables;
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    if (const KernelTable* table = KernelsFor(isa)) tables.push_back(table);
  }
  return tables;
}

struct Front {
  int n, lda;
  std::vector<double> a;
  [[nodiscard]] double& At(int r, int c) {
    return a[static_cast<std::size_t>(r) +
             static_cast<std::size_t>(c) * static_cast<std::size_t>(lda)];
  }
};

Front Random(int n, unsigned seed) {
  Front front{n, n + 3, std::vector<double>(static_cast<std::size_t>((n + 3) * n), 7.0)};
  std::mt19937_64 engine(seed);
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r) {
      front.At(r, c) = static_cast<double>(engine() >> 11) * 0x1.0p-53 - 0.5 + (r == c ? n : 0.0);
    }
  }
  return front;
}

/// Column by column, in long double.
void Reference(Front* front, int nb) {
  for (int k = 0; k < nb; ++k) {
    const long double pivot = std::sqrt(static_cast<long double>(front->At(k, k)));
    front->At(k, k) = static_cast<double>(pivot);
    for (int r = k + 1; r < front->n; ++r) {
      front->At(r, k) = static_cast<double>(front->At(r, k) / pivot);
    }
    for (int c = k + 1; c < front->n; ++c) {
      for (int r = c; r < front->n; ++r) {
        front->At(r, c) -= front->At(r, k) * front->At(c, k);
      }
    }
  }
}

TEST(CholeskyPartial, EqualsTheReference) {
  for (const KernelTable* table : Tables()) {
    SCOPED_TRACE(table->name);
    for (int n = 1; n <= 70; n += n < 20 ? 1 : 7) {
      for (int nb = 0; nb <= n; ++nb) {
        Front front = Random(n, 5), reference = front;
        Reference(&reference, nb);
        ASSERT_EQ(table->cholesky_partial(n, nb, front.a.data(), front.lda), 0);
        for (int c = 0; c < n; ++c) {
          for (int r = 0; r < front.lda; ++r) {
            // Above the diagonal and beyond n nothing is touched.
            ASSERT_NEAR(front.At(r, c), reference.At(r, c), 1e-12 * n) << n << ' ' << nb;
          }
        }
      }
    }
  }
}

TEST(CholeskyPartial, SolvesUndoTheFactor) {
  for (const KernelTable* table : Tables()) {
    SCOPED_TRACE(table->name);
    for (const int n : {1, 7, 8, 15, 24, 33, 66}) {
      for (const int nb : {1, 6, 9, 15, 24}) {
        if (nb > n) continue;
        Front L = Random(n, 9);
        ASSERT_EQ(table->cholesky_partial(n, nb, L.a.data(), L.lda), 0);
        std::vector<double> x(static_cast<std::size_t>(n)), forward, backward;
        for (int k = 0; k < n; ++k)
          x[static_cast<std::size_t>(k)] = std::cos(k + 1.0);
        const auto at = [](std::vector<double>& v, int k) -> double& {
          return v[static_cast<std::size_t>(k)];
        };
        forward = backward = x;
        for (int k = 0; k < nb; ++k) {
          at(forward, k) /= L.At(k, k);
          for (int r = k + 1; r < n; ++r)
            at(forward, r) -= L.At(r, k) * at(forward, k);
        }
        for (int k = nb - 1; k >= 0; --k) {
          for (int r = k + 1; r < n; ++r)
            at(backward, k) -= L.At(r, k) * at(backward, r);
          at(backward, k) /= L.At(k, k);
        }
        std::vector<double> y = x;
        table->forward_solve_partial(n, nb, L.a.data(), L.lda, y.data());
        for (int k = 0; k < n; ++k)
          ASSERT_NEAR(at(y, k), at(forward, k), 1e-12);
        y = x;
        table->backward_solve_partial(n, nb, L.a.data(), L.lda, y.data());
        for (int k = 0; k < n; ++k)
          ASSERT_NEAR(at(y, k), at(backward, k), 1e-12);
      }
    }
  }
}

TEST(CholeskyPartial, NamesTheFailedPivotAmongItsColumns) {
  for (const KernelTable* table : Tables()) {
    for (const int bad : {0, 5, 8, 14}) {
      Front front = Random(40, 2);
      front.At(bad, bad) = bad == 5 ? std::nan("") : -1.0;
      EXPECT_EQ(table->cholesky_partial(40, 15, front.a.data(), front.lda), bad + 1);
    }
    Front front = Random(40, 2);
    front.At(20, 20) = -1.0;  // not eliminated here, so no matter of this front
    EXPECT_EQ(table->cholesky_partial(40, 15, front.a.data(), front.lda), 0);
  }
}

}  // namespace
}  // namespace glissade::kernels
