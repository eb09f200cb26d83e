// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "window/init_two_view.h"

namespace glissade::internal {

namespace {

/// Monomials in x, y, z up to degree 3, those of degree 3 first, as exponents.
constexpr int kMonomials = 20;
constexpr int kExponents[kMonomials][3] = {{3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {1, 1, 1},
                                           {1, 0, 2}, {0, 3, 0}, {0, 2, 1}, {0, 1, 2}, {0, 0, 3},
                                           {2, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 2, 0}, {0, 1, 1},
                                           {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
/// From these on: degree at most 2, at most 1.
constexpr int kFirstOfDegree2 = 10, kFirstOfDegree1 = 16;

constexpr auto kProduct = [] {
  std::array<std::array<int, kMonomials>, kMonomials> table{};
  for (int i = 0; i < kMonomials; ++i) {
    for (int j = 0; j < kMonomials; ++j) {
      table[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = -1;
      for (int k = 0; k < kMonomials; ++k) {
        bool same = true;
        for (int e = 0; e < 3; ++e)
          same = same && kExponents[k][e] == kExponents[i][e] + kExponents[j][e];
        if (same) table[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = k;
      }
    }
  }
  return table;
}();

using Polynomial = std::array<double, kMonomials>;

/// sum += factor a b; a and b have nothing before first_a, first_b.
void AddProduct(const Polynomial& a, int first_a, const Polynomial& b, int first_b, double factor,
                Polynomial* sum) {
  for (int i = first_a; i < kMonomials; ++i) {
    for (int j = first_b; j < kMonomials; ++j) {
      const int k = kProduct[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      (*sum)[static_cast<std::size_t>(k)] +=
          factor * a[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(j)];
    }
  }
}

using PolynomialMatrix = std::array<std::array<Polynomial, 3>, 3>;

/// det E = 0 and 2 E E' E - tr(E E') E = 0: ten rows.
Eigen::Matrix<double, 10, kMonomials> Constraints(const PolynomialMatrix& E) {
  Eigen::Matrix<double, 10, kMonomials> A;
  const auto set_row = [&](int row, const Polynomial& p) {
    A.row(row) = Eigen::Map<const Eigen::Matrix<double, 1, kMonomials>>(p.data());
  };
  constexpr int k1 = kFirstOfDegree1, k2 = kFirstOfDegree2;
  PolynomialMatrix G{};  // 2 E E' - tr(E E') I
  Polynomial trace{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k)
        AddProduct(E[i][k], k1, E[j][k], k1, 2.0, &G[i][j]);
      AddProduct(E[i][j], k1, E[i][j], k1, 1.0, &trace);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t m = 0; m < trace.size(); ++m)
      G[i][i][m] -= trace[m];
  }
  int row = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      Polynomial p{};
      for (std::size_t k = 0; k < 3; ++k)
        AddProduct(G[i][k], k2, E[k][j], k1, 1.0, &p);
      set_row(row++, p);
    }
  }
  Polynomial det{};
  for (std::size_t j = 0; j < 3; ++j) {
    const std::size_t k = (j + 1) % 3, l = (j + 2) % 3;
    Polynomial minor{};
    AddProduct(E[1][k], k1, E[2][l], k1, 1.0, &minor);
    AddProduct(E[1][l], k1, E[2][k], k1, -1.0, &minor);
    AddProduct(minor, k2, E[0][j], k1, 1.0, &det);
  }
  set_row(row, det);
  return A;
}

}  // namespace

void FivePoint(const Match matches[5], std::vector<Essential>* essentials) {
  essentials->clear();
  Eigen::Matrix<double, 9, 5> Q;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d a(matches[k].a[0], matches[k].a[1], 1.0);
    const Eigen::Vector3d b(matches[k].b[0], matches[k].b[1], 1.0);
    for (int i = 0; i < 3; ++i)
      Q.block<3, 1>(3 * i, k) = b[i] * a;
  }
  const Eigen::Matrix<double, 9, 9> basis =
      Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>>(Q).householderQ();
  PolynomialMatrix E{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t m = 0; m < 4; ++m) {
        E[i][j][kFirstOfDegree1 + m] =
            basis(static_cast<Eigen::Index>(3 * i + j), static_cast<Eigen::Index>(5 + m));
      }
    }
  }
  // All of degree 3 by those below: x^3 = -B_0 (x^2, ..., 1), ...
  const Eigen::Matrix<double, 10, kMonomials> A = Constraints(E);
  const Eigen::Matrix<double, 10, 10> B = A.leftCols<10>().partialPivLu().solve(A.rightCols<10>());
  if (!B.allFinite()) return;
  // Multiplication of (x^2, xy, xz, y^2, yz, z^2, x, y, z, 1) by x.
  Eigen::Matrix<double, 10, 10> M = Eigen::Matrix<double, 10, 10>::Zero();
  M.topRows<6>() = -B.topRows<6>();
  M(6, 0) = M(7, 1) = M(8, 2) = M(9, 6) = 1.0;
  const Eigen::EigenSolver<Eigen::Matrix<double, 10, 10>> eigen(M);
  if (eigen.info() != Eigen::Success) return;
  for (int k = 0; k < 10; ++k) {
    if (std::abs(eigen.eigenvalues()[k].imag()) > 1e-10) continue;
    const Eigen::Matrix<double, 10, 1> v = eigen.eigenvectors().col(k).real();
    Eigen::Matrix<double, 9, 1> e =
        v[6] * basis.col(5) + v[7] * basis.col(6) + v[8] * basis.col(7) + v[9] * basis.col(8);
    if (!(e.norm() > 0.0) || !e.allFinite()) continue;
    e.normalize();
    Essential essential;
    Eigen::Map<Eigen::Matrix<double, 9, 1>>(essential.data()) = e;
    essentials->push_back(essential);
  }
}

}  // namespace glissade::internal
