// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/schur_complement.h"

#include <cmath>
#include <string>
#include <vector>

#include "glissade/base/index.h"
#include "glissade/base/validate.h"
#include "marginal/dense_schur.h"

namespace glissade::internal {

namespace {

using internal::Index;

Status Invalid(const std::string& what) {
  return {StatusCode::kInvalidArgument, "SchurComplement: " + what};
}

}  // namespace

Status SchurComplement(int n, const double* H, const double* b, std::span<const int> keep,
                       std::span<const int> marginalize, double relative_cut, double* S,
                       double* b_s, int* rank) {
  if (Status s = ValidateRelativeCut(relative_cut, "SchurComplement"); !s.ok()) return s;
  std::vector<int> order;
  std::vector<unsigned char> seen(Index(n), 0);
  for (const std::span<const int> list : {marginalize, keep}) {
    for (const int i : list) {
      if (i < 0 || i >= n) return Invalid("index " + std::to_string(i) + " is out of range");
      if (seen[Index(i)] != 0) return Invalid("index " + std::to_string(i) + " is given twice");
      seen[Index(i)] = 1;
      order.push_back(i);
    }
  }
  if (!AllFinite(b, n)) return {StatusCode::kNotFinite, "SchurComplement: b is not finite"};
  for (int c = 0; c < n; ++c) {
    if (!AllFinite(H + Index(c) * Index(n), n)) {
      return {StatusCode::kNotFinite, "SchurComplement: H is not finite"};
    }
    if (H[Index(c) * Index(n) + Index(c)] < 0.0) {
      return {StatusCode::kNotPositive, "SchurComplement: negative diagonal of H"};
    }
  }
  for (int c = 0; c < n; ++c) {
    for (int r = 0; r < c; ++r) {
      const double upper = H[Index(c) * Index(n) + Index(r)],
                   lower = H[Index(r) * Index(n) + Index(c)];
      const double scale =
          std::sqrt(H[Index(c) * Index(n) + Index(c)] * H[Index(r) * Index(n) + Index(r)]);
      if (std::abs(upper - lower) > 1e-9 * scale) return Invalid("H is not symmetric");
    }
  }

  // [marginalized | kept | b].
  const int m = static_cast<int>(marginalize.size()), k = static_cast<int>(keep.size());
  const int size = m + k + 1;
  std::vector<double> A(Index(size) * Index(size), 0.0);
  for (int c = 0; c < m + k; ++c) {
    for (int r = c; r < m + k; ++r) {
      A[Index(c) * Index(size) + Index(r)] =
          H[Index(order[Index(c)]) * Index(n) + Index(order[Index(r)])];
    }
    A[Index(c) * Index(size) + Index(size - 1)] = b[order[Index(c)]];
  }
  DenseScratch scratch;
  *rank = EliminateLeading(size, m, A.data(), size, relative_cut, &scratch, nullptr);
  if (*rank < 0) {
    return {StatusCode::kNotPositive,
            "SchurComplement: the marginalized block is not positive semi-definite"};
  }
  for (int c = 0; c < k; ++c) {
    for (int r = c; r < k; ++r) {
      S[Index(c) * Index(k) + Index(r)] = S[Index(r) * Index(k) + Index(c)] =
          A[Index(m + c) * Index(size) + Index(m + r)];
    }
    b_s[c] = A[Index(m + c) * Index(size) + Index(size - 1)];
  }
  return {};
}

}  // namespace glissade::internal
